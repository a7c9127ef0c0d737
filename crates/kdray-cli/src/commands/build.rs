//! `kdray build`: a tree, and what it is like.

pub(crate) mod device;
pub(crate) mod profile;

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use clap::Args;
use kdray::{BuildOptions, Cost, Mesh, Tree};
use serde::Serialize;

use crate::commands::info::TreeFigures;
use crate::device::Choice;
use crate::progress::Progress;
use crate::sizes::{bytes, count, parse_bytes};
use crate::{arguments, atomic, cancel, input, output};
use device::GpuFigures;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    mesh: arguments::Mesh,
    /// Where to save the tree [default: nowhere, only its figures are printed]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    build: arguments::Build,
    #[command(flatten)]
    prices: Prices,
    /// Depth at which every node is a leaf, at most 255 [default: 8 + 1.3 log2 of the triangles]
    #[arg(long, value_name = "D")]
    max_depth: Option<u32>,
    /// Nodes with at most this many triangles are leaves; 0 leaves that to the prices
    #[arg(long, value_name = "L", default_value_t = 0)]
    max_leaf: u32,
    /// Where to build: `cpu`, `gpu` for the best one, `auto` for a real GPU or else the CPU, or the index
    /// or a part of the name of a device in `kdray devices`
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = Choice::parse)]
    device: Choice,
    #[command(flatten)]
    profile: profile::ProfileArguments,
    /// Cut the boxes of straddling triangles instead of the triangles: a worse tree, sooner
    #[arg(long)]
    no_clip: bool,
    /// Bytes the build may allocate, such as 64M or 1.5GiB [default: no limit]
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    memory_budget: Option<u64>,
    #[command(flatten)]
    pub(crate) json: arguments::Json,
}

/// What a ray is thought to pay.
#[derive(Args)]
struct Prices {
    /// Price of visiting an inner node
    #[arg(long, value_name = "X", default_value_t = Cost::default().traversal)]
    cost_traversal: f32,
    /// Price of testing a triangle
    #[arg(long, value_name = "Y", default_value_t = Cost::default().intersect)]
    cost_intersect: f32,
    /// Fraction by which a plane is cheaper that cuts off empty space
    #[arg(long, value_name = "Z", default_value_t = Cost::default().empty_bonus)]
    empty_bonus: f32,
}

/// A tree, and what it took.
pub(crate) struct Built {
    pub(crate) tree: Tree,
    pub(crate) build_s: f64,
    peak_bytes: u64,
    pub(crate) gpu: Option<GpuFigures>,
}

#[derive(Serialize)]
struct Report {
    mesh: String,
    builder: &'static str,
    device: &'static str,
    #[serde(flatten)]
    gpu: Option<GpuFigures>,
    threads: usize,
    build_s: f64,
    peak_bytes: u64,
    #[serde(flatten)]
    tree: TreeFigures,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let cancel = cancel::flag()?;
    if let Some(target) = &arguments.output {
        atomic::check_writable(target)?;
    }
    let mesh = input::mesh(&arguments.mesh.path, &arguments.mesh.repair)?;
    let Built { tree, build_s, peak_bytes, gpu } = build(&mesh, arguments, cancel)?;
    if let Some(target) = &arguments.output {
        atomic::write(target, |file, _| Ok(file.write_all(&tree.to_bytes())?))?;
    }
    let report = Report {
        mesh: arguments.mesh.path.display().to_string(),
        builder: arguments.build.builder.name(),
        device: if gpu.is_some() { "gpu" } else { "cpu" },
        gpu,
        threads: arguments::resolved_threads(arguments.build.threads),
        build_s,
        peak_bytes,
        tree: TreeFigures::of(&tree),
        file: arguments.output.as_ref().map(|path| path.display().to_string()),
    };
    output::print(arguments.json.json, &report, &report.text())?;
    Ok(ExitCode::SUCCESS)
}

fn build(mesh: &Mesh, arguments: &Arguments, cancel: &AtomicBool) -> anyhow::Result<Built> {
    let device = arguments.device.open()?;
    arguments.profile.check(device.is_some())?;
    let progress = Progress::new("building");
    let options = BuildOptions {
        builder: arguments.build.builder.builder(),
        cost: Cost {
            traversal: arguments.prices.cost_traversal,
            intersect: arguments.prices.cost_intersect,
            empty_bonus: arguments.prices.empty_bonus,
        },
        max_depth: arguments.max_depth,
        max_leaf: arguments.max_leaf,
        clip: !arguments.no_clip,
        threads: arguments.build.threads,
        memory_budget: arguments.memory_budget,
        progress: Some(&|fraction| progress.set(fraction)),
        cancel: Some(cancel),
    };
    let Some(device) = device else {
        let start = Instant::now();
        let (tree, report) = Tree::build_reported(mesh, &options)?;
        let (build_s, peak_bytes) = (start.elapsed().as_secs_f64(), report.peak_bytes);
        return Ok(Built { tree, build_s, peak_bytes, gpu: None });
    };
    device::build(&device, mesh, &options, &arguments.profile)
}

impl Report {
    fn text(&self) -> String {
        let triangles = count(self.tree.triangles);
        let mut rows = vec![
            ("mesh", format!("{}, {triangles} triangles", self.mesh)),
            ("build", format!("{:.3} s, {}, {}", self.build_s, self.builder, self.place())),
            ("peak memory", bytes(self.peak_bytes)),
        ];
        if let Some(gpu) = self.gpu.as_ref().filter(|gpu| gpu.crown > 0) {
            let nodes = count(gpu.crown);
            rows.push(("by the CPU", format!("{nodes} nodes that the device cannot bind")));
        }
        rows.extend(self.tree.rows());
        rows.extend(self.file.iter().map(|file| ("saved", file.clone())));
        let profile = self.gpu.as_ref().and_then(|gpu| gpu.profile.as_ref());
        output::table(&rows) + &profile.map_or_else(String::new, |profile| profile.text())
    }

    /// On what it was built.
    fn place(&self) -> String {
        match &self.gpu {
            Some(gpu) => format!("{}, {}", gpu.adapter, gpu.driver),
            None => format!("{} threads", self.threads),
        }
    }
}
