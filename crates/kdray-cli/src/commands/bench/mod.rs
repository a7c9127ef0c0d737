//! `kdray bench`: what this machine makes of it.

mod measure;
pub(crate) mod paper;
mod rays;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Subcommand};
use kdray::Mesh;
use serde::Serialize;

use crate::sizes::{bytes, count};
use crate::{arguments, cancel, input, output};
use measure::Measurement;

#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    special: Option<Special>,
    /// The meshes [default: the built-in scene]
    #[arg(value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// Numbers of threads to measure, such as 1,2; 0 for one a core
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_value = "1,0")]
    threads: Vec<usize>,
    /// How often everything is measured; the best pass counts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = arguments::at_least_one)]
    passes: usize,
    /// Triangles of the built-in scene
    #[arg(long, value_name = "N", default_value_t = 100_000, conflicts_with = "meshes")]
    triangles: usize,
    #[command(flatten)]
    repair: arguments::Repair,
    #[command(flatten)]
    json: arguments::Json,
}

#[derive(Subcommand)]
enum Special {
    /// Measure the paper's eight scenes, and write a report beside its tables and figures
    Paper(paper::Arguments),
}

impl Arguments {
    /// Whether standard output is for JSON.
    pub(crate) fn prints_json(&self) -> bool {
        match &self.special {
            Some(Special::Paper(arguments)) => arguments.prints_json(),
            None => self.json.json,
        }
    }
}

#[derive(Serialize)]
struct Report {
    device: &'static str,
    passes: usize,
    results: Vec<Result>,
}

#[derive(Serialize)]
struct Result {
    mesh: String,
    triangles: usize,
    #[serde(flatten)]
    measurement: Measurement,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    if let Some(Special::Paper(arguments)) = &arguments.special {
        return paper::run(arguments);
    }
    let cancel = cancel::flag()?;
    let mut results = Vec::new();
    let mut measure = |name: String, mesh: &Mesh| {
        for threads in distinct(&arguments.threads) {
            let measurement = Measurement::take(mesh, threads, arguments.passes, cancel)?;
            let triangles = mesh.triangles().len();
            results.push(Result { mesh: name.clone(), triangles, measurement });
        }
        anyhow::Ok(())
    };
    if arguments.meshes.is_empty() {
        measure(input::SHOWCASE.into(), &input::showcase(arguments.triangles)?)?;
    }
    for path in &arguments.meshes {
        measure(path.display().to_string(), &input::mesh(path, &arguments.repair)?)?;
    }
    let report = Report { device: "cpu", passes: arguments.passes, results };
    output::print(arguments.json.json, &report, &report.text())?;
    Ok(ExitCode::SUCCESS)
}

/// The numbers of threads that are meant, each once.
fn distinct(threads: &[usize]) -> Vec<usize> {
    let mut resolved: Vec<usize> =
        threads.iter().map(|threads| arguments::resolved_threads(*threads)).collect();
    resolved.sort_unstable();
    resolved.dedup();
    resolved
}

impl Report {
    fn text(&self) -> String {
        let mut text = format!(
            "{:24} {:>10} {:>7} {:>9} {:>9} {:>10} {:>10} {:>9} {:>9} {:>9}\n",
            "", "", "", "build s", "", "peak", "tree", "Mray/s", "", ""
        );
        let _ = writeln!(
            text,
            "{:24} {:>10} {:>7} {:>9} {:>9} {:>10} {:>10} {:>9} {:>9} {:>9}",
            "mesh",
            "triangles",
            "threads",
            "best",
            "median",
            "memory",
            "size",
            "primary",
            "bounce",
            "shadow"
        );
        for Result { mesh, triangles, measurement: m } in &self.results {
            let name = Path::new(mesh).file_name().unwrap_or(mesh.as_ref()).to_string_lossy();
            let [primary, bounce, shadow] = [m.primary, m.bounce, m.shadow].map(speed);
            let (peak, tree) = (bytes(m.peak_bytes), bytes(m.tree_bytes as u64));
            let _ = writeln!(
                text,
                "{name:24} {:>10} {:>7} {:>9.4} {:>9.4} {peak:>10} {tree:>10} {primary:>9} {bounce:>9} {shadow:>9}",
                count(*triangles),
                m.threads,
                m.build_best_s,
                m.build_median_s
            );
        }
        text
    }
}

/// A speed, if there was anything to measure.
fn speed(mrays_per_s: Option<f64>) -> String {
    mrays_per_s.map_or_else(|| "-".into(), |speed| format!("{speed:.2}"))
}
