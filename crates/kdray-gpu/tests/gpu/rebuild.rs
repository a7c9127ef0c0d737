//! A rebuilder gives the trees of single builds, in memory that it keeps.

use std::path::Path;

use kdray::{BuildOptions, Mesh, Tree};
use kdray_gpu::{Device, Limits, Rebuilder, build, prepare};
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
        let (tree, report) = rebuilder.build(mesh, options).expect("it is built");
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

#[test]
fn a_turning_scene_comes_to_an_end_of_allocating() {
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let mesh = scenes::ordinary().into_iter().last().expect("there are scenes").mesh;
    let frames: Vec<Mesh> = (0..6).map(|step| turned(&mesh, 0.2 * step as f32)).collect();
    let rounds = frames.iter().cycle().take(3 * frames.len());
    let used = rebuild(&device, rounds, &BuildOptions::default());
    assert!(used[12..].iter().all(|now| *now == used[12]), "{used:?}");
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

/// Every frame has the tree of a fresh build; no kernel is compiled after the first, and buffers are
/// allocated only for trees that are larger than all before.
fn check_sequence(frames: &[Mesh]) {
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let options = BuildOptions::default();
    let used = rebuild(&device, &frames[..1], &options);
    let compiled = device.compiled();
    let used = [used, rebuild(&device, frames, &options)].concat();
    println!("bytes and allocations: {used:?}");
    assert_eq!(device.compiled(), compiled);
    let (first, last) = (used[1], used[used.len() - 1]);
    assert!(last[0] <= first[0] + first[0] / 10, "{used:?}");
    assert!(last[1] <= first[1] + 8, "{used:?}");
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

/// Takes a minute on two idle cores.
#[test]
#[ignore = "long"]
fn a_dragon_explodes() {
    let base = "animated/exploding_dragon_substitute_f00.ply";
    let frames = frames(base, "animated/exploding_dragon_substitute_16frames.f32");
    frames.into_iter().for_each(|frames| check_sequence(&frames));
}
