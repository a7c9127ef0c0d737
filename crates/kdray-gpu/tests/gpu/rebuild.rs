//! A rebuilder gives the trees of single builds, in memory that it keeps.

use std::path::Path;

use kdray::{BuildOptions, Mesh, Ray, Tree};
use kdray_gpu::{Device, Limits, Rebuilder, TraceOptions, build, prepare};
use kdray_test::rays::RayMaker;
use kdray_test::{scenes, shared, vulkan};

use crate::support::open;

/// A scene's mesh, turned about the y axis.
fn turned(mesh: &Mesh, angle: f32) -> Mesh {
    let (sin, cos) = angle.sin_cos();
    let turn = |[x, y, z]: &[f32; 3]| [cos * x + sin * z, *y, cos * z - sin * x];
    let positions: Vec<_> = mesh.positions().iter().map(turn).collect();
    Mesh::new(&positions, mesh.triangles()).expect("finite")
}

/// Builds every frame, compares it with the CPU's, and gives the bytes of the device's buffers and
/// how many were allocated by then.
fn rebuild<'a>(
    device: &Device,
    frames: impl IntoIterator<Item = &'a Mesh>,
    options: &BuildOptions,
) -> Vec<[u64; 2]> {
    let mut rebuilder = Rebuilder::new(device).expect("the kernels compile");
    let mut used = Vec::new();
    for (index, mesh) in frames.into_iter().enumerate() {
        let (tracer, report) = rebuilder.build(mesh, options).expect("it is built");
        let tree = tracer.tree(mesh).expect("the device answers");
        let fresh = Tree::build(mesh, options).expect("the options are in range");
        assert!(tree.to_bytes() == fresh.to_bytes(), "frame {index} differs");
        assert!(options.memory_budget.is_none_or(|budget| report.peak_bytes <= budget));
        used.push([device.memory().bytes(), device.memory().allocations()]);
    }
    used
}

#[test]
fn the_same_size_again_takes_no_memory_and_no_kernel() {
    // A device of its own, since its memory is counted.
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let before = device.memory().bytes();
    for scene in scenes::ordinary().into_iter().take(3) {
        let small = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
        let (mesh, small) = (scene.mesh, small.expect("finite"));
        let frames = [&mesh, &mesh, &small, &mesh, &mesh];
        let used = rebuild(&device, frames, &BuildOptions::default());
        assert!(used.iter().all(|now| *now == used[0]), "{}: {used:?}", scene.name);
        assert_eq!(device.memory().bytes(), before, "the memory goes with the rebuilder");
    }
    let compiled = device.compiled();
    let mesh = scenes::ordinary().into_iter().next().expect("there are scenes").mesh;
    rebuild(&device, [&mesh], &BuildOptions::default());
    assert_eq!(device.compiled(), compiled);
}

/// A build compiles nothing that was compiled for it before.
#[test]
fn what_is_prepared_is_what_runs() {
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    prepare(&device).expect("the kernels compile");
    let compiled = device.compiled();
    let mesh = scenes::ordinary().into_iter().next().expect("there are scenes").mesh;
    let tree = build(&device, &mesh, &BuildOptions::default()).expect("it is built");
    assert!(!tree.nodes().is_empty());
    assert_eq!(device.compiled(), compiled);
}

/// A tree that stays takes the transfers of a build but for itself, and is not built over while
/// somebody has it.
#[test]
fn trees_stay_on_the_device_as_long_as_somebody_has_them() {
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let mut rebuilder = Rebuilder::new(&device).expect("the kernels compile");
    let mesh = scenes::ordinary().into_iter().last().expect("there are scenes").mesh;
    let meshes = [0.0, 0.5, 1.0].map(|angle| turned(&mesh, angle));
    let tracers = meshes.each_ref().map(|mesh| {
        let before = traffic(&device);
        let tree = build(&device, mesh, &BuildOptions::default()).expect("it fits");
        let between = traffic(&device);
        let (tracer, _) = rebuilder.build(mesh, &BuildOptions::default()).expect("it fits");
        let after = traffic(&device);
        let [brought, read] = [0, 1].map(|way| after[way] - between[way]);
        assert_eq!(brought, between[0] - before[0]);
        assert_eq!(read, between[1] - before[1] - tree.size_bytes() as u64);
        tracer
    });
    for (tracer, mesh) in tracers.iter().zip(&meshes) {
        let fresh = Tree::build(mesh, &BuildOptions::default()).expect("nothing limits it");
        let tree = tracer.tree(mesh).expect("the device answers");
        assert!(tree.to_bytes() == fresh.to_bytes(), "it was built over");
        let mut maker = RayMaker::new(mesh, &fresh, 79);
        let rays: Vec<Ray> = (0..500).map(|_| maker.any()).collect();
        let (mut hits, mut expected) = (vec![None; rays.len()], vec![None; rays.len()]);
        tracer.batch(TraceOptions::default()).closest_hits(&rays, &mut hits).expect("it answers");
        kdray::Tracer::new(mesh, &fresh).closest_hits(&rays, &mut expected);
        assert_eq!(hits, expected);
    }
    let [bytes, allocations] = [device.memory().bytes(), device.memory().allocations()];
    drop(tracers);
    rebuilder.build(&mesh, &BuildOptions::default()).expect("it fits");
    assert_eq!([bytes, allocations], [device.memory().bytes(), device.memory().allocations()]);
}

/// Bytes that went to the device so far, and that came back.
fn traffic(device: &Device) -> [u64; 2] {
    [device.traffic().up_bytes(), device.traffic().down_bytes()]
}

#[test]
fn a_turning_scene_comes_to_an_end_of_allocating() {
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let mesh = scenes::ordinary().into_iter().last().expect("there are scenes").mesh;
    let frames: Vec<Mesh> = (0..6).map(|step| turned(&mesh, 0.2 * step as f32)).collect();
    let rounds = frames.iter().cycle().take(3 * frames.len());
    let used = rebuild(&device, rounds, &BuildOptions::default());
    let again = &used[frames.len() - 1..];
    assert!(again.iter().all(|now| *now == again[0]), "{used:?}");
}

#[test]
fn a_budget_holds_with_the_memory_that_is_kept() {
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let mesh = scenes::ordinary().into_iter().last().expect("there are scenes").mesh;
    let small = scenes::ordinary().into_iter().next().expect("there are scenes").mesh;
    let options = BuildOptions { memory_budget: Some(32 << 20), ..BuildOptions::default() };
    rebuild(&device, [&small, &mesh, &small, &mesh], &options);
}

/// The frames of a mesh whose positions in each are in a file; `None` if it is not there.
fn frames(base: &str, positions: &str) -> Option<Vec<Mesh>> {
    let base = shared::mesh(base)?;
    let path = Path::new(shared::FOLDER).join(positions);
    let bytes = std::fs::read(path).expect("the frames are beside the base");
    let floats = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let floats: Vec<f32> = floats.collect();
    let frames = floats.as_chunks::<3>().0.chunks(base.positions().len());
    Some(frames.map(|frame| Mesh::new(frame, base.triangles()).expect("finite")).collect())
}

/// Every frame has the tree of a fresh build; no kernel is compiled and no memory allocated after the
/// first, also when the frames come again.
fn check_sequence(frames: &[Mesh]) {
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let options = BuildOptions::default();
    rebuild(&device, &frames[..1], &options);
    let compiled = device.compiled();
    let used = rebuild(&device, frames.iter().chain(frames), &options);
    println!("bytes and allocations: {used:?}");
    assert_eq!(device.compiled(), compiled);
    assert!(used.iter().all(|now| *now == used[0]), "{used:?}");
}

#[test]
fn a_character_runs() {
    let Some(frames) = frames("animated/soldier_f00.ply", "animated/soldier_24frames.f32") else {
        return;
    };
    assert_eq!(frames.len(), 24);
    check_sequence(&frames);
}

#[test]
fn a_cloth_falls() {
    let files = [92, 93].map(|frame| format!("animated/cloth_ball_f{frame}.ply"));
    let frames: Option<Vec<Mesh>> = files.iter().map(|file| shared::mesh(file)).collect();
    frames.into_iter().for_each(|frames| check_sequence(&frames));
}

/// Takes minutes on two cores.
#[test]
#[ignore = "long"]
fn a_dragon_explodes() {
    let base = "animated/exploding_dragon_substitute_f00.ply";
    let frames = frames(base, "animated/exploding_dragon_substitute_16frames.f32");
    frames.into_iter().for_each(|frames| check_sequence(&frames));
}
