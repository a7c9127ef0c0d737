//! All builders, on any number of threads, give the same bytes.

use kdray::{BuildOptions, Builder, Mesh, Tree};
use kdray_mesh::generate::torus_knot;
use kdray_test::{Scene, presets, scenes, shared};
use proptest::prelude::*;

/// The naive builder is quadratic: beyond this many triangles it sits out.
const NAIVE: usize = 1500;

fn bytes(mesh: &Mesh, builder: Builder, options: &BuildOptions) -> Vec<u8> {
    let options = BuildOptions { builder, ..options.clone() };
    Tree::build(mesh, &options).expect("the options are in range").to_bytes()
}

fn assert_builders_agree(name: &str, mesh: &Mesh, options: &BuildOptions) {
    let exact = bytes(mesh, Builder::Exact, options);
    assert!(exact == bytes(mesh, Builder::Resort, options), "resort differs: {name}");
    if mesh.triangles().len() <= NAIVE {
        assert!(exact == bytes(mesh, Builder::Naive, options), "naive differs: {name}");
    }
}

#[test]
fn every_scene_with_every_options() {
    for Scene { name, mesh, .. } in scenes::all() {
        for (preset, options) in presets::all() {
            assert_builders_agree(&format!("{name}, {preset}"), &mesh, &options);
        }
    }
}

fn assert_threads_agree(name: &str, mesh: &Mesh, options: &BuildOptions) {
    let on = |threads| bytes(mesh, Builder::Exact, &BuildOptions { threads, ..options.clone() });
    let alone = on(1);
    for threads in [2, 5] {
        assert!(alone == on(threads), "{threads} threads differ: {name}");
    }
}

/// Larger than the subtrees that one thread finishes alone.
#[test]
fn threads_on_large_scenes() {
    let large = [
        Scene::open("knot", &torus_knot([2, 3], 2500, 12)),
        Scene::open("soup", &scenes::soup_of_size(40_000, 1, 0.05)),
        Scene::open("lattice soup", &scenes::lattice_soup(20_000, 2, 6)),
        Scene::open(
            "all in one plane",
            &scenes::moved(&scenes::soup_of_size(40_000, 3, 0.02), |[x, y, _]| [x, y, 1.0]),
        ),
        Scene::open(
            "all the same",
            &scenes::of_corners((0..30_000).map(|_| [[0.0; 3], [1.0, 0.1, 0.2], [0.3, 1.0, 1.0]])),
        ),
        Scene::open("city", &scenes::city(60)),
    ];
    let options = BuildOptions::default();
    for Scene { name, mesh, .. } in large {
        assert_threads_agree(&name, &mesh, &options);
        assert_threads_agree(&name, &mesh, &BuildOptions { clip: false, ..options.clone() });
    }
}

#[test]
fn real_meshes() {
    for name in ["bunny.ply", "sponza.ply", "conference.ply"] {
        let Some(mesh) = shared::mesh(name) else { continue };
        let options = BuildOptions { threads: 1, ..BuildOptions::default() };
        let exact = bytes(&mesh, Builder::Exact, &options);
        let resort = bytes(&mesh, Builder::Resort, &options);
        assert!(exact == resort, "resort differs: {name}");
        let threaded = bytes(&mesh, Builder::Exact, &BuildOptions { threads: 5, ..options });
        assert!(exact == threaded, "5 threads differ: {name}");
    }
}

/// Coordinates of one of three kinds: anything, a coarse lattice, or few values close together.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        -1.0_f32..1.0,
        (-3_i8..=3).prop_map(f32::from),
        (0_u32..3).prop_map(|ulps| f32::from_bits(1.0_f32.to_bits() + ulps)),
    ]
}

fn soup() -> impl Strategy<Value = Mesh> {
    let point = prop::array::uniform3(coordinate());
    prop::collection::vec(prop::array::uniform3(point), 0..40).prop_map(|corners| {
        let positions: Vec<[f32; 3]> = corners.as_flattened().to_vec();
        let triangles: Vec<[u32; 3]> = (0..corners.len() as u32)
            .map(|index| [3 * index, 3 * index + 1, 3 * index + 2])
            .collect();
        Mesh::new(&positions, &triangles).expect("all is finite and in range")
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn any_soup(mesh in soup()) {
        for (preset, options) in presets::all() {
            assert_builders_agree(preset, &mesh, &options);
        }
    }
}
