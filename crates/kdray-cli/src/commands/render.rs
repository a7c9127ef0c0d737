//! `kdray render`: a picture.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::Context;
use clap::{Args, ValueEnum};
use kdray::{BuildOptions, Mesh, Tracer, Tree};
use kdray_gpu::Device;
use kdray_render::gpu::Renderer;
use kdray_render::{Camera, Picture, RenderOptions, Sky, Sun, render};
use serde::Serialize;

use crate::device::{Choice, Place, no_picture};
use crate::progress::Progress;
use crate::sizes::{PictureSize, count, parse_point};
use crate::{arguments, atomic, cancel, input, output};

#[derive(Args)]
pub(crate) struct Arguments {
    /// The mesh: a PLY, OBJ, STL, OFF, glTF or GLB file [default: a built-in scene]
    #[arg(value_name = "MESH")]
    mesh: Option<PathBuf>,
    /// The picture, a PNG file
    #[arg(short, long, value_name = "FILE", default_value = "kdray.png")]
    output: PathBuf,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "960x640")]
    size: PictureSize,
    /// How surfaces are shaded
    #[arg(long, value_enum, default_value_t)]
    shading: Shading,
    /// Samples a pixel [default: 4 for normals and cost, 8 for path, 16 for ao]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16_384))]
    spp: Option<u32>,
    /// Reflections that a light path makes at most
    #[arg(long, value_name = "N", default_value_t = 4)]
    bounces: u32,
    /// Keep the noise of few samples as it is
    #[arg(long)]
    no_denoise: bool,
    /// Triangles of the built-in scene
    #[arg(long, value_name = "N", default_value_t = 100_000, conflicts_with = "mesh")]
    triangles: usize,
    #[command(flatten)]
    view: View,
    #[command(flatten)]
    build: arguments::Build,
    /// Where the tree is built and the picture made: `cpu`, `gpu` for the best one, `auto` for a real
    /// GPU or else the CPU, or the index or a part of the name of a device in `kdray devices`. Noise is
    /// smoothed away on the CPU; the picture is the same up to roundings
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = Choice::parse)]
    device: Choice,
    #[command(flatten)]
    repair: arguments::Repair,
    #[command(flatten)]
    pub(crate) json: arguments::Json,
}

/// Where the camera is. Coordinates are those of the mesh's file.
#[derive(Args)]
pub(crate) struct View {
    /// Where the camera is [default: where all of the mesh is in view]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    eye: Option<[f64; 3]>,
    /// What it looks at [default: the middle of the mesh]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    target: Option<[f64; 3]>,
    /// Vertical field of view in degrees [default: 35]
    #[arg(long, value_name = "DEGREES", value_parser = parse_fov)]
    fov: Option<f32>,
    /// Which axis points up
    #[arg(long, value_enum, default_value_t)]
    up: Up,
    /// Where the sun is: degrees to the left of the viewer's back, and above the horizon [default: 72,40]
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = parse_sun, allow_hyphen_values = true)]
    sun: Option<[f32; 2]>,
}

#[derive(Clone, Copy, Default, ValueEnum)]
pub(crate) enum Shading {
    /// Surface directions as colours
    Normals,
    /// Ambient occlusion: how open the surroundings of a point are
    Ao,
    /// Sun and sky, reflected by matt surfaces
    #[default]
    Path,
    /// What each ray costs in the tree, as a heat map
    Cost,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum Up {
    #[default]
    Y,
    Z,
}

#[derive(Serialize)]
struct Report {
    mesh: String,
    triangles: usize,
    builder: &'static str,
    device: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    adapter: Option<String>,
    threads: usize,
    build_s: f64,
    trace_s: f64,
    rays: u64,
    hits: u64,
    image: String,
    width: u32,
    height: u32,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let cancel = cancel::flag()?;
    atomic::check_writable(&arguments.output)?;
    let (name, mesh) = match &arguments.mesh {
        Some(path) => (path.display().to_string(), input::mesh(path, &arguments.repair)?),
        None => (input::SHOWCASE.to_owned(), input::showcase(arguments.triangles)?),
    };
    let device = arguments.device.open()?;
    let device = device.as_ref();
    let (place, build_s) = build(&mesh, device, arguments, cancel)?;
    let (picture, trace_s) = trace(&mesh, &place, arguments, cancel)?;
    atomic::write(&arguments.output, |_, path| Ok(picture.save_png(path)?))?;
    let report = Report {
        mesh: name,
        triangles: mesh.triangles().len(),
        builder: arguments.build.builder.name(),
        device: if device.is_some() { "gpu" } else { "cpu" },
        adapter: device.map(|device| device.adapter().name.clone()),
        threads: arguments::resolved_threads(arguments.build.threads),
        build_s,
        trace_s,
        rays: picture.rays,
        hits: picture.hits,
        image: arguments.output.display().to_string(),
        width: picture.width,
        height: picture.height,
    };
    output::print(arguments.json.json, &report, &report.text())?;
    Ok(ExitCode::SUCCESS)
}

fn build<'a>(
    mesh: &Mesh,
    device: Option<&'a Device>,
    arguments: &Arguments,
    cancel: &AtomicBool,
) -> anyhow::Result<(Place<'a>, f64)> {
    device.map_or(Ok(()), kdray_gpu::prepare)?;
    let progress = Progress::new("building");
    let options = BuildOptions {
        builder: arguments.build.builder.builder(),
        threads: arguments.build.threads,
        progress: Some(&|fraction| progress.set(fraction)),
        cancel: Some(cancel),
        ..BuildOptions::default()
    };
    let start = Instant::now();
    let place = match device {
        None => Place::Cpu(Tree::build(mesh, &options)?),
        Some(device) => Place::Gpu(kdray_gpu::Tracer::build(device, mesh, &options)?.0),
    };
    Ok((place, start.elapsed().as_secs_f64()))
}

fn trace(
    mesh: &Mesh,
    place: &Place,
    arguments: &Arguments,
    cancel: &AtomicBool,
) -> anyhow::Result<(Picture, f64)> {
    let progress = Progress::new("tracing");
    let show = |fraction| progress.set(fraction);
    let options = RenderOptions {
        width: arguments.size.width,
        height: arguments.size.height,
        shading: arguments.shading.shading(),
        samples: arguments.spp,
        bounces: arguments.bounces,
        sky: arguments.view.sky(),
        denoise: !arguments.no_denoise,
        progress: Some(&show),
        cancel: Some(cancel),
        ..RenderOptions::default()
    };
    let camera = arguments.view.camera(mesh, options.aspect());
    let threads = rayon::ThreadPoolBuilder::new().num_threads(arguments.build.threads).build();
    let threads = threads.context("cannot start the threads")?;
    match place {
        Place::Cpu(tree) => {
            let tracer = Tracer::new(mesh, tree);
            let start = Instant::now();
            let picture = threads.install(|| render(&tracer, mesh, &camera, &options))?;
            Ok((picture, start.elapsed().as_secs_f64()))
        }
        Place::Gpu(tracer) => {
            let mut renderer = Renderer::new(tracer.device())?;
            let start = Instant::now();
            let picture = threads.install(|| renderer.render(tracer, mesh, &camera, &options));
            Ok((picture.map_err(no_picture)?, start.elapsed().as_secs_f64()))
        }
    }
}

impl View {
    fn camera(&self, mesh: &Mesh, aspect: f32) -> Camera {
        self.camera_over(mesh, |up| Camera::framing_mesh(mesh, up, aspect))
    }

    /// A camera in the coordinates of `mesh`; what nobody asked for is as in `framing`, which gets
    /// the direction that is up.
    pub(crate) fn camera_over(
        &self,
        mesh: &Mesh,
        framing: impl FnOnce([f32; 3]) -> Camera,
    ) -> Camera {
        let up = match self.up {
            Up::Y => Camera::Y_UP,
            Up::Z => Camera::Z_UP,
        };
        let framing = framing(up);
        let local = |point: [f64; 3]| mesh.frame().local_point(point);
        Camera {
            eye: self.eye.map_or(framing.eye, local),
            target: self.target.map_or(framing.target, local),
            up,
            fov: self.fov.unwrap_or(framing.fov),
        }
    }

    pub(crate) fn sky(&self) -> Sky {
        let sky = Sky::default();
        let moved = |sun| match self.sun {
            Some([azimuth, elevation]) => Sun { azimuth, elevation, ..sun },
            None => sun,
        };
        Sky { sun: sky.sun.map(moved), ..sky }
    }
}

fn parse_fov(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(degrees) if (1.0..=170.0).contains(&degrees) => Ok(degrees),
        _ => Err("not a number of degrees in 1..=170".into()),
    }
}

fn parse_sun(text: &str) -> Result<[f32; 2], String> {
    let angles = text.split_once(',').map(|(a, b)| (a.trim().parse(), b.trim().parse()));
    match angles {
        Some((Ok(azimuth), Ok(elevation))) if f32::is_finite(azimuth + elevation) => {
            Ok([azimuth, elevation])
        }
        _ => Err("not two angles of the form 72,40".into()),
    }
}

impl Shading {
    pub(crate) fn shading(self) -> kdray_render::Shading {
        match self {
            Self::Normals => kdray_render::Shading::Normals,
            Self::Ao => kdray_render::Shading::Ao,
            Self::Path => kdray_render::Shading::Path,
            Self::Cost => kdray_render::Shading::Cost,
        }
    }
}

impl Report {
    fn text(&self) -> String {
        let mut text = String::new();
        let triangles = count(self.triangles);
        let _ = writeln!(
            text,
            "{}: {triangles} triangles, tree built in {:.3} s",
            self.mesh, self.build_s
        );
        let speed = self.rays as f64 / self.trace_s.max(1e-9) / 1e6;
        let rays = count(self.rays as usize);
        let _ = writeln!(
            text,
            "{rays} rays in {:.2} s, shading included: {speed:.2} million a second",
            self.trace_s
        );
        let _ = writeln!(text, "{} ({} x {})", self.image, self.width, self.height);
        text
    }
}
