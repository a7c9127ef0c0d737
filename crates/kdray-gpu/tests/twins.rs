//! The kernels' twins give the bytes of the exact builder.

use kdray::{BuildOptions, Mesh, Tree};
use kdray_gpu::build_with_twins;
use kdray_test::{Scene, presets, scenes, shared};

fn assert_same(name: &str, mesh: &Mesh, options: &BuildOptions) {
    let exact = Tree::build(mesh, options).expect("the options are in range");
    for with_teams in [false, true] {
        let tree = build_with_twins(mesh, options, with_teams).expect("the options are in range");
        assert!(tree.to_bytes() == exact.to_bytes(), "the twins differ: {name}, {with_teams}");
    }
}

#[test]
fn every_scene_with_every_options() {
    for Scene { name, mesh, .. } in scenes::all() {
        for (preset, options) in presets::all() {
            assert_same(&format!("{name}, {preset}"), &mesh, &options);
        }
    }
}

#[test]
fn real_meshes() {
    for name in ["happy_res4.ply", "self_intersect.ply", "bunny.ply"] {
        let Some(mesh) = shared::mesh(name) else { continue };
        assert_same(name, &mesh, &BuildOptions::default());
    }
}
