//! `kdray animate`: a moving scene, whose tree is built anew for every frame.

mod build;
mod film;
mod view;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::Context;
use clap::Args;
use kdray::{Mesh, Tracer};
use kdray_mesh::Sequence;
use kdray_render::gpu::Renderer;
use kdray_render::{Camera, Picture, RenderOptions};
use serde::Serialize;

use crate::commands::render::{Shading, View};
use crate::device::{Choice, Place, no_picture};
use crate::progress::Progress;
use crate::sizes::{PictureSize, bytes, count};
use crate::{arguments, cancel, output};
use build::{Builder, Built, DeviceMemory};
use film::Film;

pub(crate) use film::parse_rate;

#[derive(Args)]
pub(crate) struct Arguments {
    /// A mesh a frame; or a mesh and a .f32 file with its vertices in every frame; or a glTF file,
    /// whose first animation plays
    #[arg(value_name = "FRAMES", required = true)]
    frames: Vec<PathBuf>,
    /// A GIF file, or a folder for a PNG file a frame
    #[arg(short, long, value_name = "FILE|FOLDER", default_value = "kdray.gif")]
    output: PathBuf,
    /// Frames a second: of the GIF, and of a glTF animation
    #[arg(long, value_name = "N", default_value_t = 12.0, value_parser = film::parse_rate)]
    rate: f64,
    /// Width and height of the pictures in pixels
    #[arg(long, value_name = "WxH", default_value = "480x320")]
    size: PictureSize,
    /// How surfaces are shaded
    #[arg(long, value_enum, default_value_t)]
    shading: Shading,
    /// Samples a pixel [default: 4 for normals and cost, 8 for path, 16 for ao]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16_384))]
    spp: Option<u32>,
    #[command(flatten)]
    view: View,
    /// Where trees are built and pictures made: `cpu`, `gpu` for the best one, `auto` for a real GPU or else the CPU,
    /// or the index or a part of the name of a device in `kdray devices`
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = Choice::parse)]
    device: Choice,
    /// Threads to use; 0 for one a core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
    #[command(flatten)]
    pub(crate) json: arguments::Json,
}

/// Reading frames and writing pictures is in none of the times.
#[derive(Serialize)]
struct Report {
    triangles: usize,
    device: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    adapter: Option<String>,
    threads: usize,
    frames: Vec<FrameReport>,
    build_s: f64,
    trace_s: f64,
    frames_per_s: f64,
    image: String,
}

#[derive(Serialize)]
struct FrameReport {
    build_s: f64,
    /// The tracer's layout on the CPU, or bringing normals and colours to the device, and the picture.
    trace_s: f64,
    frames_per_s: f64,
    /// The most memory that the build had.
    peak_bytes: u64,
    tree_bytes: u64,
    rays: u64,
    #[serde(flatten)]
    device: Option<DeviceMemory>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let cancel = cancel::flag()?;
    let film = Film::new(&arguments.output, arguments.rate)?;
    let sequence = Sequence::open(&arguments.frames, arguments.rate)?;
    let device = arguments.device.open()?;
    let threads = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build();
    let threads = threads.context("cannot start the threads")?;
    let stage = view::Stage::of(&sequence, arguments)?;
    let mut builder = Builder::new(device.as_ref(), arguments.threads, cancel)?;
    let mut renderer = device.as_ref().map(Renderer::new).transpose()?;
    let progress = Progress::new("animating");
    let mut frames = Vec::new();
    film.shoot(|film| {
        for index in 0..sequence.frames() {
            let mesh = view::mesh(&sequence, index)?;
            let (picture, report) = threads
                .install(|| {
                    frame(&mesh, &mut builder, renderer.as_mut(), &stage, arguments, cancel)
                })
                .with_context(|| format!("frame {index}"))?;
            film.add(&picture)?;
            frames.push(report);
            progress.set((index + 1) as f32 / sequence.frames() as f32);
        }
        Ok(())
    })?;
    let adapter = device.as_ref().map(|device| device.adapter().name.clone());
    let report = Report::new(frames, sequence.triangles(), adapter, arguments);
    output::print(arguments.json.json, &report, &report.text())?;
    Ok(ExitCode::SUCCESS)
}

fn frame<'a>(
    mesh: &Mesh,
    builder: &mut Builder<'a>,
    renderer: Option<&mut Renderer<'a>>,
    stage: &view::Stage,
    arguments: &Arguments,
    cancel: &AtomicBool,
) -> anyhow::Result<(Picture, FrameReport)> {
    let Built { place, build_s, peak_bytes, tree_bytes } = builder.build(mesh)?;
    let options = RenderOptions {
        width: arguments.size.width,
        height: arguments.size.height,
        shading: arguments.shading.shading(),
        samples: arguments.spp,
        sky: arguments.view.sky(),
        cancel: Some(cancel),
        ..RenderOptions::default()
    };
    let start = Instant::now();
    let picture = picture(mesh, &place, renderer, (&stage.camera(mesh), &options))?;
    let trace_s = start.elapsed().as_secs_f64();
    let report = FrameReport {
        build_s,
        trace_s,
        frames_per_s: 1.0 / (build_s + trace_s).max(1e-9),
        peak_bytes,
        tree_bytes,
        rays: picture.rays,
        device: builder.device_memory(),
    };
    Ok((picture, report))
}

/// A picture of the mesh, made where its tree is; but what rays cost is asked of the tracer on the CPU.
fn picture<'a>(
    mesh: &Mesh,
    place: &Place<'a>,
    renderer: Option<&mut Renderer<'a>>,
    (camera, options): (&Camera, &RenderOptions),
) -> anyhow::Result<Picture> {
    let renderer = renderer.filter(|_| options.shading != kdray_render::Shading::Cost);
    let read;
    let tree = match (place, renderer) {
        (Place::Gpu(tracer), Some(renderer)) => {
            return renderer.render(tracer, mesh, camera, options).map_err(no_picture);
        }
        (Place::Gpu(tracer), None) => {
            read = tracer.tree(mesh)?;
            &read
        }
        (Place::Cpu(tree), _) => tree,
    };
    Ok(kdray_render::render(&Tracer::new(mesh, tree), mesh, camera, options)?)
}

impl Report {
    fn new(
        frames: Vec<FrameReport>,
        triangles: usize,
        adapter: Option<String>,
        arguments: &Arguments,
    ) -> Self {
        let build_s = frames.iter().map(|frame| frame.build_s).sum::<f64>();
        let trace_s = frames.iter().map(|frame| frame.trace_s).sum::<f64>();
        Self {
            triangles,
            device: if adapter.is_some() { "gpu" } else { "cpu" },
            adapter,
            threads: arguments::resolved_threads(arguments.threads),
            frames_per_s: frames.len() as f64 / (build_s + trace_s).max(1e-9),
            frames,
            build_s,
            trace_s,
            image: arguments.output.display().to_string(),
        }
    }

    fn text(&self) -> String {
        let mut text = String::from("frame   build ms   trace ms   frames/s   peak memory\n");
        for (index, frame) in self.frames.iter().enumerate() {
            let [build, trace] = [frame.build_s, frame.trace_s].map(|seconds| 1e3 * seconds);
            let (speed, peak) = (frame.frames_per_s, bytes(frame.peak_bytes));
            let _ = writeln!(text, "{index:5}{build:11.1}{trace:11.1}{speed:11.2}   {peak:>11}");
        }
        let [build, trace] = [self.build_s, self.trace_s].map(|seconds| 1e3 * seconds);
        let _ = writeln!(text, "  all{build:11.1}{trace:11.1}{:11.2}", self.frames_per_s);
        let place = self.adapter.as_deref().unwrap_or("the CPU");
        let triangles = count(self.triangles);
        let _ = writeln!(text, "{}: {triangles} triangles, on {place}", self.image);
        text
    }
}
