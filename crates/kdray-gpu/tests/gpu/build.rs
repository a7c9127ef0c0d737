//! The device gives the bytes of the exact builder.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use kdray::{BuildError, BuildOptions, Cost, Mesh, Tree};
use kdray_gpu::{Device, GpuError, Limits, Tracer, build, build_reported, prepare};
use kdray_mesh::generate;
use kdray_test::{Scene, presets, scenes, shared, vulkan};

use crate::support::{lavapipe, open, swiftshader};

fn exact(mesh: &Mesh, options: &BuildOptions) -> Tree {
    Tree::build(mesh, options).expect("the options are in range")
}

fn assert_same(device: &Device, name: &str, mesh: &Mesh, options: &BuildOptions) {
    let tree = build(device, mesh, options).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(tree.to_bytes() == exact(mesh, options).to_bytes(), "{name} differs");
}

#[test]
fn every_scene_with_few_options() {
    for Scene { name, mesh, .. } in scenes::all() {
        for (preset, options) in presets::few() {
            assert_same(lavapipe(), &format!("{name}, {preset}"), &mesh, &options);
        }
    }
}

#[test]
fn every_option_on_a_few_scenes() {
    for Scene { name, mesh, .. } in scenes::ordinary().into_iter().take(5) {
        for (preset, options) in presets::all() {
            assert_same(lavapipe(), &format!("{name}, {preset}"), &mesh, &options);
        }
    }
}

#[test]
fn every_scene_on_a_second_driver() {
    for Scene { name, mesh, .. } in scenes::all() {
        assert_same(swiftshader(), &name, &mesh, &BuildOptions::default());
    }
}

#[test]
fn real_meshes() {
    let names = [
        "happy_res4.ply",
        "self_intersect.ply",
        "bunny.ply",
        "sibenik.ply",
        "fairy_forest.ply",
        "sponza.ply",
        "conference.ply",
        "animated/exploding_dragon_substitute_f00.ply",
        "armadillo_86k.ply",
        "bunny_in_stadium.ply",
    ];
    for name in names {
        let Some(mesh) = shared::mesh(name) else { continue };
        assert_same(lavapipe(), name, &mesh, &BuildOptions::default());
    }
}

/// Takes a minute on two idle cores.
#[test]
#[ignore = "long"]
fn large_meshes() {
    for name in ["angel_substitute.ply", "dragon.ply", "happy_substitute.ply"] {
        let Some(mesh) = shared::mesh(name) else { continue };
        assert_same(lavapipe(), name, &mesh, &BuildOptions::default());
    }
}

/// Invocations and teams take turns as they like; none of it is seen in the tree.
#[test]
fn ten_builds_give_one_tree() {
    let mesh = Scene::open("soup", &scenes::soup_of_size(3000, 1, 0.1)).mesh;
    let expected = exact(&mesh, &BuildOptions::default());
    for _ in 0..10 {
        let tree = build(lavapipe(), &mesh, &BuildOptions::default()).expect("it is built");
        assert!(tree == expected);
    }
}

/// Inputs that make one list, one bucket or one leaf of everything.
/// Once too large for teams at the root, and once not.
#[test]
fn adversarial_scenes() {
    for count in [20_000, 60] {
        let same = (0..count).map(|_| [[0.0; 3], [1.0, 0.1, 0.2], [0.3, 1.0, 1.0]]);
        let place = |index: usize| index as f64 / count as f64;
        // Every plane across the fan cuts all of it, and the new bounds fall between two old ones.
        let fan = (0..count / 4).map(|index| {
            let high = place(index);
            [[0.0, 0.0, 0.0], [1.0, high, 1.0 - high], [1.0, 1.0 - 0.5 * high, 1.0]]
        });
        let stack = (0..count).map(|index| {
            let high = place(index / 100 * 100);
            [[0.0, 0.0, high], [1.0, 0.0, high], [0.0, 1.0, high]]
        });
        let soup = scenes::soup_of_size(count, 3, 0.02);
        let all = [
            Scene::open("all the same", &scenes::of_corners(same)),
            Scene::open("a fan", &scenes::of_corners(fan)),
            Scene::open("a stack", &scenes::of_corners(stack)),
            Scene::open("all in one plane", &scenes::moved(&soup, |[x, y, _]| [x, y, 1.0])),
        ];
        for Scene { name, mesh, .. } in all {
            let options = BuildOptions { max_depth: Some(12), ..BuildOptions::default() };
            assert_same(lavapipe(), &format!("{name}, {count}"), &mesh, &options);
        }
    }
}

#[test]
fn one_triangle_and_none() {
    let one = [[[0.0; 3], [1.0, 0.1, 0.2], [0.3, 1.0, 1.0]]];
    for count in 0..=1 {
        let scene = Scene::open("few", &scenes::of_corners(one.into_iter().take(count)));
        assert_eq!(scene.mesh.triangles().len(), count);
        assert_same(lavapipe(), "few", &scene.mesh, &BuildOptions::default());
    }
}

#[test]
fn batches_give_the_same_tree_in_less_memory() {
    let mesh = Scene::open("soup", &scenes::soup_of_size(20_000, 1, 0.05)).mesh;
    let run = |memory_budget| {
        let options = BuildOptions { memory_budget, ..BuildOptions::default() };
        build_reported(lavapipe(), &mesh, &options, false).expect("the budget is enough")
    };
    let (tree, roomy) = run(Some(1 << 30));
    assert!(tree == exact(&mesh, &BuildOptions::default()));
    // Bytes a triangle, of which the mesh has 48: with levels in batches, and with nodes that have no
    // room for the events of all axes either.
    for budget in [200, 130].map(|bytes| bytes * 20_000) {
        assert!(budget < roomy.peak_bytes);
        let (same_tree, tight) = run(Some(budget));
        assert!(tree == same_tree);
        assert!(tight.peak_bytes <= budget);
        assert!(tight.levels.len() > roomy.levels.len(), "some levels were built in batches");
    }
}

/// What a build says that it had is what the device's buffers took, those that wait for work to be
/// done included.
#[test]
fn the_peak_is_that_of_the_device() {
    // A device of its own, since its memory is counted.
    let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    // What is tried of a device before its kernels are compiled takes memory too.
    prepare(&device).expect("the kernels compile");
    let mesh = Scene::open("soup", &scenes::soup_of_size(20_000, 1, 0.05)).mesh;
    for memory_budget in [None, Some(200 * 20_000)] {
        let before = device.memory().bytes();
        device.memory().reset_peak();
        let options = BuildOptions { memory_budget, ..BuildOptions::default() };
        let (_, report) = build_reported(&device, &mesh, &options, false).expect("it is built");
        let peak = device.memory().peak_bytes() - before;
        // A few words for sums of sums may come while nothing else is asked for.
        assert!(peak <= report.peak_bytes + report.peak_bytes / 64, "{peak}: {report:?}");
        assert!(report.peak_bytes <= peak, "{peak}: {report:?}");
        assert_eq!(device.memory().bytes(), before);
    }
}

/// Opens lavapipe as a device that binds no more than so many bytes.
fn binding(binding_bytes: u64) -> Device {
    open(vulkan::LAVAPIPE, &Limits { binding_bytes, ..Limits::PORTABLE })
}

/// A device that binds little cuts levels to what it may bind.
#[test]
fn small_bindings_make_batches() {
    let mesh = Scene::open("soup", &scenes::soup_of_size(20_000, 1, 0.02)).mesh;
    let options = BuildOptions::default();
    let built = build_reported(&binding(1 << 20), &mesh, &options, false);
    let (tree, report) = built.expect("it fits");
    assert!(tree == exact(&mesh, &options));
    assert_eq!(report.levels[1].nodes, 1, "the root's halves are built one after the other");
    assert_eq!(report.crown, 0);
}

/// Where mesh or lists of the root are larger than that, the device builds what is below the nodes
/// near the root.
#[test]
fn meshes_larger_than_a_binding() {
    let device = binding(1 << 20);
    let soup = scenes::soup_of_size(100_000, 1, 0.02);
    for (name, max_depth) in [("soup", None), ("shallow soup", Some(2))] {
        let mesh = Scene::open(name, &soup).mesh;
        let seen = Mutex::new(Vec::new());
        let progress = |part| seen.lock().expect("no thread panics").push(part);
        let options =
            BuildOptions { max_depth, progress: Some(&progress), ..BuildOptions::default() };
        let (tree, report) = build_reported(&device, &mesh, &options, true).expect("it is built");
        assert!(tree == exact(&mesh, &options), "{name}");
        assert!(report.crown > 2, "{name}: {report:?}");
        assert_eq!(report.tree_bytes, tree.size_bytes() as u64);
        let levels = report.levels.iter().map(|level| level.depth);
        assert!(levels.min() >= Some(1), "{name}");
        let seen = std::mem::take(&mut *seen.lock().expect("no thread panics"));
        assert!(seen.iter().all(|part| (0.0..=1.0).contains(part)), "{seen:?}");
        assert_eq!(seen.last(), Some(&1.0));
    }
}

/// A tree that is to stay needs all of its mesh on the device.
#[test]
fn a_mesh_that_cannot_stay_is_a_clear_error() {
    let mesh = Scene::open("soup", &scenes::soup_of_size(100_000, 1, 0.02)).mesh;
    let device = binding(1 << 20);
    let built = Tracer::build(&device, &mesh, &BuildOptions::default());
    let Some(GpuError::Limit { limit: "binding_bytes", asked, offered, .. }) = built.err() else {
        panic!("the mesh cannot stay")
    };
    assert_eq!((asked, offered), (3 * 12 * 100_000, 1 << 20));
}

/// Where planes cost next to nothing, a part's references grow beyond a binding, and smaller parts are
/// tried.
#[test]
fn parts_that_grow_are_cut_again() {
    let mesh = Scene::open("soup", &scenes::soup_of_size(30_000, 1, 0.4)).mesh;
    let cost = Cost { traversal: 0.01, ..Cost::default() };
    let options = BuildOptions { cost, max_depth: Some(16), ..BuildOptions::default() };
    let device = binding(1 << 20);
    let (tree, report) = build_reported(&device, &mesh, &options, false).expect("it is built");
    assert!(tree == exact(&mesh, &options));
    // One plane would do for the mesh; that the parts grew takes more.
    println!("{} nodes by the CPU, {} references", report.crown, tree.references().len());
    assert!(report.crown > 6, "{}", report.crown);
}

/// Takes minutes on two cores, and 3.4 GB.
#[test]
#[ignore = "long"]
fn twenty_million_triangles_under_a_small_budget() {
    let mesh = Scene::open("knot", &generate::torus_knot([2, 3], 40_000, 250)).mesh;
    let budget = 20 * mesh.triangles().len() as u64;
    let options = BuildOptions { memory_budget: Some(budget), ..BuildOptions::default() };
    let (tree, report) = build_reported(lavapipe(), &mesh, &options, false).expect("it is built");
    println!("{} nodes by the CPU, peak {}", report.crown, report.peak_bytes);
    assert!(report.peak_bytes <= budget);
    assert!(tree == exact(&mesh, &BuildOptions::default()));
}

#[test]
fn a_budget_that_cannot_hold_names_the_stage() {
    let mesh = Scene::open("soup", &scenes::soup_of_size(5000, 1, 0.05)).mesh;
    let options = BuildOptions { memory_budget: Some(200_000), ..BuildOptions::default() };
    let error = build(lavapipe(), &mesh, &options).unwrap_err();
    let GpuError::Build(BuildError::MemoryBudget { stage, needed, budget }) = error else {
        panic!("{error}")
    };
    assert_eq!((stage, budget), ("events", 200_000));
    assert!(needed > budget);
}

#[test]
fn builds_can_be_cancelled_and_options_refused() {
    let mesh = Scene::open("soup", &scenes::soup_of_size(100, 1, 0.5)).mesh;
    let cancel = AtomicBool::new(true);
    let cancelled = BuildOptions { cancel: Some(&cancel), ..BuildOptions::default() };
    let refused = BuildOptions { max_depth: Some(999), ..BuildOptions::default() };
    let error = build(lavapipe(), &mesh, &cancelled).unwrap_err();
    assert_eq!(error, GpuError::Build(BuildError::Cancelled));
    let error = build(lavapipe(), &mesh, &refused).unwrap_err();
    assert!(matches!(error, GpuError::Build(BuildError::Option { .. })), "{error}");
}

#[test]
fn reports_count_what_the_build_did() {
    let mesh = Scene::open("soup", &scenes::soup_of_size(2000, 1, 0.2)).mesh;
    let options = BuildOptions::default();
    let (tree, report) = build_reported(lavapipe(), &mesh, &options, true).expect("it is built");
    assert_eq!(tree, exact(&mesh, &options));
    assert_eq!(report.tree_bytes, tree.size_bytes() as u64);
    // One for each level, and one for the size of the tree.
    assert_eq!(report.readbacks as usize, report.levels.len() + 1);
    assert_eq!(report.levels[0].nodes, 1);
    let finished: u64 = report.levels.iter().map(|level| u64::from(level.finished)).sum();
    assert!(finished > 2000, "most references come to their leaves in small subtrees");
    assert_eq!(report.levels[0].references, 2000);
    let profile = report.profile.expect("it was asked for");
    let total = profile.total();
    assert!(total.moved.read > 100 * 2000 && total.seconds > 0.0, "{total:?}");
    for level in &report.levels {
        let of_level = profile.stages.iter().filter(|stage| {
            stage.level == level.depth && !["events", "pack"].contains(&stage.name)
        });
        let dispatches = of_level.map(|stage| stage.dispatches).sum::<u64>();
        assert!((1..=40).contains(&dispatches), "{dispatches} on level {}", level.depth);
    }
}
