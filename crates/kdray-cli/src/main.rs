//! The `kdray` command: builds exact-SAH kd-trees, looks at them, and traces rays through them.
//!
//! Human text goes to standard output, progress and complaints to standard error. With `--json`
//! standard output holds exactly one JSON object.

mod arguments;
mod atomic;
mod cancel;
mod commands;
mod device;
mod failure;
mod input;
mod npy;
mod output;
mod progress;
mod sizes;
mod topology;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::commands::{animate, bench, build, devices, info, query, render, validate, view};

/// Exact-SAH kd-trees over triangles: build them, check them, trace rays through them.
#[derive(Parser)]
#[command(
    name = "kdray",
    version,
    after_help = "Meshes are PLY, OBJ, STL, OFF, glTF or GLB files.
Exit status: 0 success, 1 failure, 2 wrong usage, 130 cancelled."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make a picture of a mesh, or of a built-in scene
    Render(render::Arguments),
    /// Make a film of a scene that moves, with a new tree for every frame
    Animate(animate::Arguments),
    /// Look at a mesh and the cells of its tree
    View(view::Arguments),
    /// Build the kd-tree of a mesh, and save it
    Build(build::Arguments),
    /// Describe a tree file or a mesh
    Info(info::Arguments),
    /// Prove that a tree file is a kd-tree of a mesh
    Validate(validate::Arguments),
    /// Ask about rays or points in a file
    Query(query::Arguments),
    /// Measure building and tracing on this machine
    Bench(bench::Arguments),
    /// List what this machine can build on
    Devices(devices::Arguments),
}

fn main() -> ExitCode {
    let (result, json) = match Cli::parse().command {
        Command::Render(arguments) => (render::run(&arguments), arguments.json.json),
        Command::Animate(arguments) => (animate::run(&arguments), arguments.json.json),
        Command::View(arguments) => (view::run(&arguments), arguments.json.json),
        Command::Build(arguments) => (build::run(&arguments), arguments.json.json),
        Command::Info(arguments) => (info::run(&arguments), arguments.json.json),
        Command::Validate(arguments) => (validate::run(&arguments), arguments.json.json),
        Command::Query(arguments) => (query::run(&arguments), arguments.json.json),
        Command::Bench(arguments) => (bench::run(&arguments), arguments.prints_json()),
        Command::Devices(arguments) => (devices::run(&arguments), arguments.json.json),
    };
    result.unwrap_or_else(|error| failure::report(&error, json))
}
