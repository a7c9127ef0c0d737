//! Measures kdray beside other ray-tracing libraries on identical rays.
//!
//! `kdray-bench run` reads a definition, measures, and writes a record; `kdray-bench table`
//! prints a record as Markdown; `kdray-bench scaling` times builds against size.

mod definition;
mod engine;
mod engines;
mod machine;
mod memory;
mod rays;
mod record;
mod run;
mod scaling;
mod scene;
mod table;
mod trace;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, ensure};
use clap::{Args, Parser, Subcommand};

use crate::definition::{Definition, Library};
use crate::record::{Machine, Measured, Record};
use crate::run::Setting;
use crate::table::Clock;

#[global_allocator]
static ALLOCATOR: memory::Counting = memory::Counting;

/// Measures kdray beside Embree, obvhs and kdtree-ray on identical rays.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measures what a definition names, prints the tables and writes a record
    Run(RunArguments),
    /// Prints a record as Markdown tables
    Table {
        /// A file made by `run` or `scaling`
        record: PathBuf,
        /// By CPU seconds, the better measure where other programs were running
        #[arg(long)]
        cpu: bool,
    },
    /// Times kdray's build of the generated scene at doubling sizes
    Scaling(ScalingArguments),
}

#[derive(Args)]
struct RunArguments {
    /// The TOML file that names scenes, engines and passes
    #[arg(long, value_name = "FILE")]
    definition: PathBuf,
    /// The folder that holds the definition's mesh files
    #[arg(long, value_name = "DIR")]
    meshes: Option<PathBuf>,
    /// Numbers of threads to build and trace with
    #[arg(long, value_name = "N,..", value_delimiter = ',', default_value = "1")]
    threads: Vec<usize>,
    /// Embree 4's shared library; bench/get-embree fetches it [default: $KDRAY_EMBREE]
    #[arg(long, value_name = "PATH")]
    embree: Option<PathBuf>,
    /// Only these scenes of the definition
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    scenes: Vec<String>,
    /// Only these engines of the definition
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    engines: Vec<String>,
    /// So many timed passes, instead of the definition's numbers
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    passes: Option<u16>,
    /// Goes on without engines and meshes that are not there
    #[arg(long)]
    allow_missing: bool,
    /// Where the record goes
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Args)]
struct ScalingArguments {
    /// The first number of triangles
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    from: usize,
    /// The greatest number of triangles
    #[arg(long, value_name = "N", default_value_t = 1_600_000)]
    to: usize,
    /// Threads to build with
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Where the record goes
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

fn main() -> ExitCode {
    match carry_out(&Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn carry_out(command: &Command) -> Result<()> {
    match command {
        Command::Run(arguments) => run(arguments),
        Command::Table { record, cpu } => {
            let clock = if *cpu { Clock::Cpu } else { Clock::Wall };
            print!("{}", table::markdown(&Record::load(record)?, clock));
            Ok(())
        }
        Command::Scaling(arguments) => scaling(arguments),
    }
}

fn run(arguments: &RunArguments) -> Result<()> {
    let mut threads = arguments.threads.clone();
    threads.sort_unstable();
    threads.dedup();
    ensure!(!threads.contains(&0), "--threads: at least 1");
    let machine = machine::machine();
    let mut definition = Definition::load(&arguments.definition)?;
    definition.select(&arguments.scenes, &arguments.engines)?;
    if let Some(passes) = arguments.passes {
        definition.build_passes = passes.into();
        definition.trace_passes = passes.into();
    }
    let variable = std::env::var_os("KDRAY_EMBREE").filter(|path| !path.is_empty());
    let embree = arguments.embree.clone().or(variable.map(PathBuf::from));
    let setting = Setting {
        meshes: arguments.meshes.as_deref(),
        embree: embree.as_deref(),
        threads: &threads,
        allow_missing: arguments.allow_missing,
    };
    let comparison = run::run(&definition, &setting)?;
    let uses_embree = definition.engines.iter().any(|e| matches!(e.library, Library::Embree(_)));
    let library = embree.as_deref().filter(|_| uses_embree);
    let record =
        finish(machine, library, Measured::Engines(comparison), arguments.output.as_deref())?;
    print!("{}", table::markdown(&record, Clock::Wall));
    Ok(())
}

fn scaling(arguments: &ScalingArguments) -> Result<()> {
    let ScalingArguments { from, to, threads, .. } = *arguments;
    ensure!(0 < from && from <= to, "--from must be at least 1 and at most --to");
    let machine = machine::machine();
    print!("{}", table::SIZE_HEAD);
    let sizes = scaling::run(from, to, threads, |size| print!("{}", table::size_row(size)))?;
    finish(machine, None, Measured::Scaling(sizes), arguments.output.as_deref())?;
    Ok(())
}

/// Makes the record and writes it where asked.
fn finish(
    machine: Machine,
    embree: Option<&Path>,
    measured: Measured,
    output: Option<&Path>,
) -> Result<Record> {
    let record = machine::record(machine, embree, measured)?;
    if let Some(path) = output {
        record.save(path)?;
    }
    Ok(record)
}
