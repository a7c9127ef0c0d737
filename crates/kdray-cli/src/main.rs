//! The `kdray` command: builds exact-SAH kd-trees, looks at them, and traces rays through them.
//!
//! Human text goes to standard output, progress and complaints to standard error. With `--json`
//! standard output holds exactly one JSON object.

mod arguments;
mod atomic;
mod cancel;
mod commands;
mod failure;
mod input;
mod output;
mod progress;
mod sizes;
mod topology;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::commands::{bench, build, info, render, validate};

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
    /// Build the kd-tree of a mesh, and save it
    Build(build::Arguments),
    /// Describe a tree file or a mesh
    Info(info::Arguments),
    /// Prove that a tree file is a kd-tree of a mesh
    Validate(validate::Arguments),
    /// Measure building and tracing on this machine
    Bench(bench::Arguments),
}

fn main() -> ExitCode {
    let (result, json) = match Cli::parse().command {
        Command::Render(arguments) => (render::run(&arguments), arguments.json.json),
        Command::Build(arguments) => (build::run(&arguments), arguments.json.json),
        Command::Info(arguments) => (info::run(&arguments), arguments.json.json),
        Command::Validate(arguments) => (validate::run(&arguments), arguments.json.json),
        Command::Bench(arguments) => (bench::run(&arguments), arguments.json.json),
    };
    result.unwrap_or_else(|error| failure::report(&error, json))
}
