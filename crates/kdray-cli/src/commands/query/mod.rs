//! `kdray query`: rays or points from a file, answers into a file.

mod answers;
mod ask;
pub(crate) mod profile;

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use clap::{Args, ValueEnum};
use kdray::{BatchOptions, BuildOptions, Mesh, Sign, Tracer, Tree, Winding};
use kdray_gpu::{Device, TraceOptions};
use serde::Serialize;

use crate::device::Choice;
use crate::progress::Progress;
use crate::sizes::count;
use crate::topology::Topology;
use crate::{arguments, atomic, cancel, input, npy, output};
use answers::Answers;
use profile::Profile;

#[derive(Args)]
#[command(after_help = ARRAYS)]
pub(crate) struct Arguments {
    #[command(flatten)]
    mesh: arguments::Mesh,
    #[command(flatten)]
    queries: Queries,
    /// What is asked [default: closest, or closest-point]
    #[arg(long, value_enum)]
    kind: Option<Kind>,
    /// Where to write the answers, as a .npz file [default: nowhere, they are only timed]
    #[arg(short, long, value_name = "OUT.npz")]
    output: Option<PathBuf>,
    /// How inside is told from outside [default: parity if every edge has two triangles, or winding]
    #[arg(long, value_enum)]
    sign: Option<SignKind>,
    /// The distance up to which triangles are `within`, and closest points are looked for
    #[arg(long, value_name = "R", value_parser = radius)]
    radius: Option<f64>,
    /// Where rays are traced: `cpu`, `gpu` for the best one, `auto` for a real GPU or else the CPU, or
    /// the index or a part of the name of a device in `kdray devices`
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = Choice::parse)]
    device: Choice,
    /// Threads to use; 0 for one a core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
    /// How often the queries are asked, for their time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = arguments::at_least_one)]
    repeat: usize,
    /// Ask queries that are near each other one after the other, whatever their order
    #[arg(long)]
    reorder: bool,
    /// Say what closest hits take on a GPU, beside the CPU: rates, and what a ray visits and tests
    #[arg(long)]
    profile: bool,
    #[command(flatten)]
    pub(crate) json: arguments::Json,
}

const ARRAYS: &str = "\
Files are .npy files of float32 or float64. The arrays of OUT.npz, of n queries:
  closest          t (inf: no hit), triangle (4294967295: none), u, v
  any              hit
  all              offsets (n + 1); t, triangle, u, v of the hits of query i, in order, are at
                   offsets[i]..offsets[i + 1]
  count            count
  contains         inside
  closest-point    point (n, 3), distance (inf: none), triangle, u, v
  signed-distance  distance, negative inside
  within           offsets (n + 1); triangle at offsets[i]..offsets[i + 1], ascending";

/// Where the queries are.
#[derive(Args)]
#[group(required = true, multiple = false)]
struct Queries {
    /// Rays: (n, 6) origins and directions, or (n, 8) with t_min and t_max
    #[arg(long, value_name = "FILE.npy")]
    rays: Option<PathBuf>,
    /// Points: (n, 3)
    #[arg(long, value_name = "FILE.npy")]
    points: Option<PathBuf>,
}

/// What can be asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    /// Rays: the first hit
    Closest,
    /// Rays: whether anything is hit
    Any,
    /// Rays: all hits, in order
    All,
    /// Rays: how many hits
    Count,
    /// Points: whether they are inside
    Contains,
    /// Points: the point of the surface closest to them
    ClosestPoint,
    /// Points: the distance from the surface, negative inside
    SignedDistance,
    /// Points: the triangles within --radius of them
    Within,
}

impl Kind {
    fn is_of_rays(self) -> bool {
        matches!(self, Self::Closest | Self::Any | Self::All | Self::Count)
    }

    fn needs_sign(self) -> bool {
        matches!(self, Self::Contains | Self::SignedDistance)
    }
}

/// How inside is told from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SignKind {
    /// An odd number of crossings is inside: for closed meshes
    Parity,
    /// Where the mesh winds around more than half a time: for others
    Winding,
}

/// The times that `--json` prints.
#[derive(Serialize)]
struct Report {
    queries: usize,
    /// Tree, tracer, and winding numbers if they are needed.
    build_s: f64,
    /// The best time of the queries alone.
    query_s: f64,
    query_s_median: f64,
    simd: &'static str,
    /// The GPU that was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    adapter: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    profile: Option<Profile>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let cancel = cancel::flag()?;
    let kind = arguments.checked_kind()?;
    if let Some(target) = &arguments.output {
        atomic::check_writable(target)?;
    }
    let mesh = input::mesh(&arguments.mesh.path, &arguments.mesh.repair)?;
    let frame = mesh.frame();
    let queries = match (&arguments.queries.rays, &arguments.queries.points) {
        (Some(path), _) => ask::Queries::Rays(npy::rays(path, &frame)?),
        (None, Some(path)) => ask::Queries::Points(npy::points(path, &frame)?),
        (None, None) => anyhow::bail!("there are neither rays nor points"),
    };
    let device = arguments.device.open()?;
    let start = Instant::now();
    let winding = arguments.winding(kind, &mesh);
    let winding_s = start.elapsed().as_secs_f64();
    let sign = winding.as_ref().map_or(Sign::Parity, Sign::Winding);
    let question = ask::Question { kind, sign, radius: arguments.radius, frame };
    let asked = match &device {
        None => ask_cpu(&mesh, &question, &queries, arguments, cancel)?,
        Some(device) => ask_gpu(device, &mesh, &question, &queries, arguments, cancel)?,
    };
    let Asked { answers, seconds, build_s, profile } = asked;
    if let Some(target) = &arguments.output {
        atomic::write(target, |file, _| answers.write(&frame, file))?;
    }
    let report = Report {
        queries: queries.len(),
        build_s: build_s + winding_s,
        query_s: seconds[0],
        query_s_median: seconds[seconds.len() / 2],
        simd: Tracer::simd(),
        adapter: device.map(|device| device.adapter().name.clone()),
        profile,
    };
    output::print(arguments.json.json, &report, &report.text())?;
    Ok(ExitCode::SUCCESS)
}

/// The answers, what it took to be ready, and the times it took to get them, the shortest first.
struct Asked {
    answers: Answers,
    build_s: f64,
    seconds: Vec<f64>,
    profile: Option<Profile>,
}

fn build_options<'a>(
    arguments: &Arguments,
    report: &'a (dyn Fn(f32) + Sync),
    cancel: &'a AtomicBool,
) -> BuildOptions<'a> {
    BuildOptions {
        threads: arguments.threads,
        progress: Some(report),
        cancel: Some(cancel),
        ..BuildOptions::default()
    }
}

fn ask_cpu(
    mesh: &Mesh,
    question: &ask::Question,
    queries: &ask::Queries,
    arguments: &Arguments,
    cancel: &AtomicBool,
) -> anyhow::Result<Asked> {
    let (start, progress) = (Instant::now(), Progress::new("building"));
    let report = |fraction| progress.set(fraction);
    let tree = Tree::build(mesh, &build_options(arguments, &report, cancel))?;
    let tracer = Tracer::new(mesh, &tree);
    let build_s = start.elapsed().as_secs_f64();
    let progress = Progress::new("asking");
    let report = |fraction| progress.set(fraction);
    let batch = tracer.batch(BatchOptions {
        threads: arguments::resolved_threads(arguments.threads),
        reorder: arguments.reorder,
        progress: Some(&report),
        cancel: Some(cancel),
        ..BatchOptions::default()
    })?;
    let (answers, seconds) = repeated(arguments.repeat, || question.ask(&batch, queries))?;
    Ok(Asked { answers, build_s, seconds, profile: None })
}

fn ask_gpu(
    device: &Device,
    mesh: &Mesh,
    question: &ask::Question,
    queries: &ask::Queries,
    arguments: &Arguments,
    cancel: &AtomicBool,
) -> anyhow::Result<Asked> {
    kdray_gpu::prepare(device)?;
    let (start, progress) = (Instant::now(), Progress::new("building"));
    let report = |fraction| progress.set(fraction);
    let options = build_options(arguments, &report, cancel);
    let (tracer, _) = kdray_gpu::Tracer::build(device, mesh, &options)?;
    let build_s = start.elapsed().as_secs_f64();
    tracer.prepare()?;
    let progress = Progress::new("asking");
    let report = |fraction| progress.set(fraction);
    let batch = tracer.batch(TraceOptions {
        progress: Some(&report),
        cancel: Some(cancel),
        ..TraceOptions::default()
    });
    let (answers, seconds) = repeated(arguments.repeat, || question.ask_gpu(&batch, queries))?;
    let profile = match queries {
        ask::Queries::Rays(rays) if arguments.profile => {
            let threads = arguments::resolved_threads(arguments.threads);
            Some(Profile::of(&batch, (mesh, &tracer.tree(mesh)?), rays, (seconds[0], threads))?)
        }
        _ => None,
    };
    Ok(Asked { answers, build_s, seconds, profile })
}

/// The last answers, and the times of all, the shortest first.
fn repeated(
    count: usize,
    ask: impl Fn() -> anyhow::Result<Answers>,
) -> anyhow::Result<(Answers, Vec<f64>)> {
    let timed = || {
        let start = Instant::now();
        let answers = ask()?;
        anyhow::Ok((answers, start.elapsed().as_secs_f64()))
    };
    let (mut answers, first) = timed()?;
    let mut seconds = vec![first];
    for _ in 1..count {
        let again = timed()?;
        answers = again.0;
        seconds.push(again.1);
    }
    seconds.sort_by(f64::total_cmp);
    Ok((answers, seconds))
}

/// A distance that is not negative.
fn radius(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(radius) if radius >= 0.0 => Ok(radius),
        _ => Err("a distance is a number that is not negative".into()),
    }
}

impl Arguments {
    fn checked_kind(&self) -> anyhow::Result<Kind> {
        let has_rays = self.queries.rays.is_some();
        let default = if has_rays { Kind::Closest } else { Kind::ClosestPoint };
        let kind = self.kind.unwrap_or(default);
        let (given, wanted) = if has_rays { ("rays", "--points") } else { ("points", "--rays") };
        anyhow::ensure!(
            kind.is_of_rays() == has_rays,
            "{kind:?} is not asked of {given}: it needs {wanted}"
        );
        anyhow::ensure!(
            has_rays || self.device == Choice::Cpu,
            "only rays can be asked on a GPU: points want --device cpu"
        );
        anyhow::ensure!(
            !self.profile || (kind == Kind::Closest && self.device != Choice::Cpu),
            "--profile is of closest hits on a GPU: give --device gpu and --kind closest"
        );
        anyhow::ensure!(kind != Kind::Within || self.radius.is_some(), "within needs --radius");
        Ok(kind)
    }

    /// Winding numbers, if the sign needs them.
    fn winding(&self, kind: Kind, mesh: &Mesh) -> Option<Winding> {
        let by_itself = || match Topology::of(mesh).closed {
            true => SignKind::Parity,
            false => SignKind::Winding,
        };
        let wanted = kind.needs_sign() && self.sign.unwrap_or_else(by_itself) == SignKind::Winding;
        wanted.then(|| Winding::new(mesh))
    }
}

impl Report {
    fn text(&self) -> String {
        let rate = self.queries as f64 / self.query_s.max(1e-9) * 1e-6;
        let table = output::table(&[
            ("queries", count(self.queries)),
            ("build", format!("{:.3} s", self.build_s)),
            ("queries", format!("{:.4} s, {rate:.3} million a second", self.query_s)),
            match &self.adapter {
                None => ("SIMD", self.simd.to_owned()),
                Some(adapter) => ("GPU", adapter.clone()),
            },
        ]);
        let profile = self.profile.as_ref().map(Profile::text);
        table + &profile.map_or_else(String::new, |profile| format!("\n{profile}"))
    }
}
