//! Pictures that are made on a GPU, beside those of the CPU and the snapshots.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};

use kdray::{BuildOptions, Mesh, Tree};
use kdray_gpu::{Device, Limits, Rebuilder, Selection, Tracer};
use kdray_mesh::generate;
use kdray_render::gpu::{RenderError, Renderer};
use kdray_render::{Camera, Picture, RenderOptions, Shading, Sky};
use kdray_test::vulkan;

use crate::support::{assert_alike, on_cpu, small, snapshot};

fn open(name: &str) -> Device {
    vulkan::set_up();
    let name = vulkan::override_name().unwrap_or_else(|| name.to_owned());
    let selection: Selection = name.parse().expect("every word is a selection");
    Device::open(&selection, &Limits::PORTABLE).unwrap_or_else(|error| panic!("{error}"))
}

fn lavapipe() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| open(vulkan::LAVAPIPE))
}

/// Renders as `on_cpu` does, over a tree of the CPU's.
fn on(device: &Device, mesh: &Mesh, options: &RenderOptions) -> Result<Picture, RenderError> {
    let tracer = Tracer::new(device, mesh, &tree(mesh))?;
    picture_of(&mut Renderer::new(device)?, &tracer, mesh, options)
}

fn tree(mesh: &Mesh) -> Tree {
    Tree::build(mesh, &BuildOptions::default()).expect("nothing limits the build")
}

fn picture_of<'a>(
    renderer: &mut Renderer<'a>,
    tracer: &Tracer<'a>,
    mesh: &Mesh,
    options: &RenderOptions,
) -> Result<Picture, RenderError> {
    let camera = Camera::framing_mesh(mesh, Camera::Y_UP, options.aspect());
    renderer.render(tracer, mesh, &camera, options)
}

#[test]
fn pictures_are_those_of_the_cpu_and_of_the_snapshots() {
    let mesh = generate::showcase(3000).mesh().expect("finite");
    for shading in [Shading::Normals, Shading::Ao, Shading::Path] {
        let picture = on(lavapipe(), &mesh, &small(shading)).expect("nothing fails");
        assert_alike(&picture, &on_cpu(&mesh, &small(shading)), &format!("{shading:?}"));
        snapshot(&picture, &format!("{shading:?}").to_lowercase());
    }
}

/// Few samples and their noise, from a low sun, without anything that is smoothed away.
#[test]
fn single_samples_with_many_bounces_are_those_of_the_cpu() {
    let sky = Sky::default();
    let sun = sky.sun.map(|sun| kdray_render::Sun { elevation: 8.0, radius: 6.0, ..sun });
    for (samples, bounces, ground) in [(1, 0, true), (2, 3, false), (1, 20, true)] {
        let options = RenderOptions {
            samples: Some(samples),
            bounces,
            ground,
            sky: Sky { sun, ..sky },
            denoise: false,
            exposure: Some(1.0),
            ..small(Shading::Path)
        };
        for loaded in [generate::showcase(3000), generate::torus_knot([2, 3], 200, 24)] {
            let mesh = loaded.mesh().expect("finite");
            let picture = on(lavapipe(), &mesh, &options).expect("nothing fails");
            let name = format!("{samples} samples, {bounces} bounces");
            assert_alike(&picture, &on_cpu(&mesh, &options), &name);
        }
    }
}

/// A white thing in a white world cannot be seen: no light is lost or made.
#[test]
fn white_surfaces_under_a_constant_sky_have_its_colour() {
    let options = RenderOptions {
        sky: Sky::constant([0.5; 3]),
        albedo: Some([1.0; 3]),
        ground: false,
        bounces: 200,
        exposure: Some(1.0),
        ..small(Shading::Path)
    };
    let mesh = generate::torus_knot([2, 3], 200, 24).mesh().expect("finite");
    let picture = on(lavapipe(), &mesh, &options).expect("nothing fails");
    assert!(picture.hits > 10_000, "{}", picture.hits);
    for pixel in &picture.pixels {
        assert!(pixel.iter().all(|channel| channel.abs_diff(188) <= 1), "{pixel:?}");
    }
}

#[test]
fn another_driver_makes_the_same_pictures() {
    let mesh = generate::torus_knot([2, 3], 60, 10).mesh().expect("finite");
    let device = open(vulkan::SWIFTSHADER);
    for shading in [Shading::Normals, Shading::Ao, Shading::Path] {
        let options = RenderOptions { width: 48, height: 36, samples: Some(2), ..small(shading) };
        let picture = on(&device, &mesh, &options).expect("nothing fails");
        assert_alike(&picture, &on_cpu(&mesh, &options), &format!("{shading:?}"));
    }
}

/// Memory is kept from picture to picture, also where a scene or picture is smaller in between. Trees
/// are built on the device and stay there: what goes up is mesh, looks and parameters.
#[test]
fn a_renderer_keeps_its_memory_and_nothing_else() {
    let device = open(vulkan::LAVAPIPE);
    let mut rebuilder = Rebuilder::new(&device).expect("the kernels compile");
    let mut renderer = Renderer::new(&device).expect("the kernels compile");
    let meshes = [generate::sphere(4), generate::cube(), generate::sphere(4)];
    let mut taken = Vec::new();
    for (mesh, width) in meshes.map(|mesh| mesh.mesh().expect("finite")).iter().zip([90, 40, 90]) {
        let options = RenderOptions { width, samples: Some(3), ..small(Shading::Path) };
        let (tracer, _) = rebuilder.build(mesh, &BuildOptions::default()).expect("it fits");
        let picture = picture_of(&mut renderer, &tracer, mesh, &options).expect("nothing fails");
        assert_alike(&picture, &on_cpu(mesh, &options), "after another one");
        // The very picture of a tree that was brought there.
        assert_eq!(picture.pixels, on(lavapipe(), mesh, &options).expect("nothing fails").pixels);
        let memory = device.memory();
        taken.push((memory.bytes(), memory.allocations(), device.compiled()));
    }
    assert_eq!(taken[0], taken[1]);
    assert_eq!(taken[0], taken[2]);
}

/// More pixels than a part of the film has, and more samples than a wave.
#[test]
fn large_pictures_are_seamless() {
    let mesh = generate::cube().mesh().expect("finite");
    let options = RenderOptions {
        width: 1040,
        height: 1024,
        samples: Some(1),
        ..RenderOptions { shading: Shading::Normals, ..RenderOptions::default() }
    };
    let picture = on(lavapipe(), &mesh, &options).expect("nothing fails");
    assert_alike(&picture, &on_cpu(&mesh, &options), "over a million pixels");
}

#[test]
fn a_picture_can_be_looked_at_while_it_is_made() {
    let mesh = generate::showcase(3000).mesh().expect("finite");
    let tracer = Tracer::new(lavapipe(), &mesh, &tree(&mesh)).expect("it fits");
    // A wave has room for nine samples of each pixel.
    let options = RenderOptions {
        width: 128,
        height: 112,
        samples: Some(20),
        denoise: false,
        exposure: Some(1.0),
        ..small(Shading::Path)
    };
    let camera = Camera::framing_mesh(&mesh, Camera::Y_UP, options.aspect());
    let mut renderer = Renderer::new(lavapipe()).expect("the kernels compile");
    let mut exposure = renderer.begin(&tracer, &mesh, &camera, &options).expect("it fits");
    let mut pictures = Vec::new();
    while exposure.advance().expect("nothing fails") {
        pictures.push(exposure.picture().expect("nothing fails"));
    }
    let last = exposure.picture().expect("nothing fails");
    assert_alike(&last, &on_cpu(&mesh, &options), "the last one");
    let noise = |picture: &Picture| {
        let pairs = picture.pixels.iter().zip(&last.pixels);
        let all: u64 = pairs.map(|(a, b)| u64::from(a[1].abs_diff(b[1]))).sum();
        all as f64 / picture.pixels.len() as f64
    };
    let noises: Vec<f64> = pictures.iter().map(noise).collect();
    assert_eq!(noises.len(), 2);
    assert!(noises[1] < noises[0] && noises[0] < 9.0 && noises[1] > 0.0, "{noises:?}");
}

#[test]
fn a_mesh_without_triangles_is_a_picture_of_the_sky() {
    let empty = Mesh::new(&[], &[]).expect("nothing is wrong with it");
    for shading in [Shading::Normals, Shading::Ao, Shading::Path] {
        let picture = on(lavapipe(), &empty, &small(shading)).expect("nothing fails");
        assert_alike(&picture, &on_cpu(&empty, &small(shading)), "the sky");
        let nothing = RenderOptions { width: 0, ..small(shading) };
        assert!(on(lavapipe(), &empty, &nothing).expect("nothing fails").pixels.is_empty());
    }
}

#[test]
fn pictures_can_be_watched_and_cancelled() {
    let mesh = generate::cube().mesh().expect("finite");
    let seen = Mutex::new(Vec::new());
    let cancel = AtomicBool::new(false);
    let watch = |fraction| seen.lock().expect("no panic").push(fraction);
    let options = RenderOptions {
        progress: Some(&watch),
        cancel: Some(&cancel),
        samples: Some(64),
        ..small(Shading::Ao)
    };
    on(lavapipe(), &mesh, &options).expect("not cancelled");
    let fractions = seen.lock().expect("no panic").clone();
    assert!(fractions.len() > 2 && fractions.is_sorted(), "{fractions:?}");
    assert_eq!(fractions.last(), Some(&1.0));
    // In the middle.
    let stop = |_| cancel.store(true, Ordering::Relaxed);
    let options = RenderOptions { progress: Some(&stop), ..options };
    let picture = on(lavapipe(), &mesh, &options);
    assert!(matches!(picture, Err(RenderError::Cancelled(_))), "{picture:?}");
    let picture = on(lavapipe(), &mesh, &small(Shading::Cost));
    assert!(matches!(picture, Err(RenderError::Cost)), "{picture:?}");
}
