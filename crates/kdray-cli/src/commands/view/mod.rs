//! `kdray view`: a mesh and its tree, in a window or in a picture.

#[cfg(feature = "window")]
mod window;

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::{Context, ensure};
use clap::Args;
use kdray::{BuildOptions, Mesh, Tree};
use kdray_mesh::Sequence;
use kdray_render::{Camera, RenderOptions};
use kdray_view::{DEEPEST, Look, Orbit, Scene};
use serde::Serialize;

use crate::commands::render::{Shading, View};
use crate::sizes::{PictureSize, count};
use crate::{arguments, atomic, cancel, output};

#[derive(Args)]
pub(crate) struct Arguments {
    /// A mesh, or frames as `kdray animate` takes them
    #[arg(value_name = "MESH|FRAMES", required = true)]
    frames: Vec<PathBuf>,
    /// Open no window, and write a picture
    #[arg(long)]
    headless: bool,
    /// The picture, a PNG file
    #[arg(short, long, value_name = "FILE", default_value = "view.png", requires = "headless")]
    output: PathBuf,
    /// The frame that is shown first, or alone
    #[arg(long, value_name = "N", default_value_t = 0)]
    frame: usize,
    /// Frames a second of a glTF animation
    #[arg(long, value_name = "N", default_value_t = 12.0, value_parser = crate::commands::animate::parse_rate)]
    rate: f64,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "960x640")]
    size: PictureSize,
    /// How surfaces are shaded
    #[arg(long, value_enum, default_value_t = Shading::Normals)]
    shading: Shading,
    /// Samples a pixel of the picture [default: 4 for normals and cost, 8 for path, 16 for ao]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16_384))]
    spp: Option<u32>,
    /// Draw the cells of the tree down to this depth
    #[arg(long, value_name = "DEPTH", value_parser = clap::value_parser!(u32).range(0..=i64::from(DEEPEST)))]
    cells: Option<u32>,
    /// Write nothing on the picture
    #[arg(long)]
    no_statistics: bool,
    #[command(flatten)]
    view: View,
    /// Threads to use; 0 for one a core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
    #[command(flatten)]
    pub(crate) json: arguments::Json,
}

#[derive(Serialize)]
struct Report {
    triangles: usize,
    frames: usize,
    frame: usize,
    rays: u64,
    image: String,
    width: u32,
    height: u32,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let cancel = cancel::flag()?;
    if arguments.headless {
        atomic::check_writable(&arguments.output)?;
    }
    let sequence = Sequence::open(&arguments.frames, arguments.rate)?;
    let (frame, frames) = (arguments.frame, sequence.frames());
    ensure!(frame < frames, "--frame is {frame}, but there are {frames} frames, from 0 on");
    let mesh = mesh(&sequence, frame)?;
    let look = look(&mesh, arguments);
    if arguments.headless {
        return picture(mesh, &look, frames, arguments, cancel);
    }
    #[cfg(feature = "window")]
    return window::open(sequence, look, arguments);
    #[cfg(not(feature = "window"))]
    anyhow::bail!(
        "this kdray was built without windows: build it with `--features window`, or give --headless"
    )
}

/// The mesh of a frame.
fn mesh(sequence: &Sequence, frame: usize) -> anyhow::Result<Mesh> {
    sequence.frame(frame)?.mesh().with_context(|| format!("frame {frame}"))
}

/// The mesh with its tree.
fn scene(mesh: Mesh, threads: usize, cancel: &AtomicBool) -> anyhow::Result<Scene> {
    let options = BuildOptions { threads, cancel: Some(cancel), ..BuildOptions::default() };
    let start = Instant::now();
    let tree = Tree::build(&mesh, &options)?;
    let build_s = start.elapsed().as_secs_f64();
    Ok(Scene::new(mesh, tree, build_s))
}

fn look(mesh: &Mesh, arguments: &Arguments) -> Look {
    let aspect = arguments.size.width as f32 / arguments.size.height as f32;
    let framing = |up| Camera::framing_mesh(mesh, up, aspect);
    Look {
        orbit: Orbit::new(&arguments.view.camera_over(mesh, framing)),
        shading: arguments.shading.shading(),
        cells: arguments.cells,
        statistics: !arguments.no_statistics,
    }
}

fn picture(
    mesh: Mesh,
    look: &Look,
    frames: usize,
    arguments: &Arguments,
    cancel: &AtomicBool,
) -> anyhow::Result<ExitCode> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build();
    let threads = threads.context("cannot start the threads")?;
    let scene = scene(mesh, arguments.threads, cancel)?;
    let options = RenderOptions {
        width: arguments.size.width,
        height: arguments.size.height,
        samples: arguments.spp,
        sky: arguments.view.sky(),
        cancel: Some(cancel),
        ..RenderOptions::default()
    };
    let picture = threads.install(|| scene.picture(look, &options))?;
    atomic::write(&arguments.output, |_, path| Ok(picture.save_png(path)?))?;
    let report = Report {
        triangles: scene.mesh().triangles().len(),
        frames,
        frame: arguments.frame,
        rays: picture.rays,
        image: arguments.output.display().to_string(),
        width: picture.width,
        height: picture.height,
    };
    let triangles = count(report.triangles);
    let text = format!(
        "frame {} of {frames}: {triangles} triangles\n{} ({} x {})\n",
        report.frame, report.image, report.width, report.height
    );
    output::print(arguments.json.json, &report, &text)?;
    Ok(ExitCode::SUCCESS)
}
