//! Trees have the planes and leaves that their definition says.

use kdray::{BuildOptions, Tree};
use kdray_mesh::generate::{soup, sphere, torus_knot};
use kdray_test::{Scene, definition, presets, scenes};

#[test]
fn every_plane_of_unclipped_trees() {
    for Scene { name, mesh, .. } in scenes::all() {
        for (preset, options) in presets::all() {
            let options = BuildOptions { clip: false, ..options };
            let tree = Tree::build(&mesh, &options).expect("the options are in range");
            let verdict = definition::check(&mesh, &tree, &options);
            assert_eq!(verdict, Ok(()), "{name}, {preset}");
        }
    }
}

#[test]
fn a_tree_of_other_prices_is_told_apart() {
    let mesh = sphere(2).mesh().expect("generated meshes are sound");
    let options = BuildOptions { clip: false, ..BuildOptions::default() };
    let tree = Tree::build(&mesh, &options).expect("the options are in range");
    let mut other = options;
    other.cost.traversal *= 1.5;
    assert!(definition::check(&mesh, &tree, &other).is_err());
}

#[test]
fn planes_of_clipped_trees_can_be_the_cheapest() {
    let generated = [
        ("sphere", sphere(2)),
        ("knot", torus_knot([2, 3], 40, 5)),
        ("soup", soup(300, 9)),
        ("dense soup", scenes::soup_of_size(100, 8, 1.0)),
        ("soup of many sizes", scenes::soup_of_many_sizes(300, 7)),
        ("city", scenes::city(4)),
    ];
    for (name, loaded) in generated {
        let mesh = loaded.mesh().expect("generated meshes are sound");
        // Deep enough for the cost alone to decide.
        let options = BuildOptions { max_depth: Some(255), ..BuildOptions::default() };
        let tree = Tree::build(&mesh, &options).expect("the options are in range");
        assert!(tree.stats().depth < 255, "{name}");
        assert_eq!(definition::clipped::check(&mesh, &tree, &options), Ok(()), "{name}");
    }
}

#[test]
fn a_clipped_tree_is_told_from_an_unclipped_one() {
    let mesh = scenes::soup_of_size(100, 8, 1.0).mesh().expect("generated meshes are sound");
    let options = BuildOptions { max_depth: Some(255), ..BuildOptions::default() };
    let unclipped = BuildOptions { clip: false, ..options.clone() };
    let tree = Tree::build(&mesh, &unclipped).expect("the options are in range");
    assert!(definition::clipped::check(&mesh, &tree, &options).is_err());
}
