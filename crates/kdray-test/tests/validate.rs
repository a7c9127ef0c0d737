//! Trees are valid; and trees damaged on purpose, in each way that can be, are not.

use kdray::{BuildOptions, Cost, FileError, Mesh, Tree, Violation};
use kdray_mesh::generate::{sphere, torus_knot};
use kdray_test::tree_file::TreeFile;
use kdray_test::{Scene, presets, scenes, shared};

#[test]
fn every_scene_with_every_options() {
    for Scene { name, mesh, .. } in scenes::all() {
        for (preset, options) in presets::all() {
            let tree = Tree::build(&mesh, &options).expect("the options are in range");
            assert_eq!(tree.validate(&mesh), Ok(()), "{name}, {preset}");
        }
    }
}

#[test]
fn real_meshes() {
    for name in ["bunny.ply", "gears.ply", "teapot.ply"] {
        let Some(mesh) = shared::mesh(name) else { continue };
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
        assert_eq!(tree.validate(&mesh), Ok(()), "{name}");
    }
}

fn sound() -> (Mesh, TreeFile) {
    let mesh = sphere(2).mesh().expect("generated meshes are sound");
    // Prices that make leaves of several references, and empty ones.
    let cost = Cost { traversal: 2.0, intersect: 1.0, empty_bonus: 0.5 };
    let tree = Tree::build(&mesh, &BuildOptions { cost, ..BuildOptions::default() });
    (mesh, TreeFile::of(&tree.expect("the options are in range")))
}

/// The parts of a file put together again are the file.
#[test]
fn taking_apart_changes_nothing() {
    let (mesh, file) = sound();
    let tree = Tree::from_bytes(&file.bytes()).expect("nothing was changed");
    assert_eq!(tree.to_bytes(), file.bytes());
    assert_eq!(tree.validate(&mesh), Ok(()));
    assert!(!file.inner_nodes().is_empty() && !file.leaves_of(2).is_empty());
}

/// What opening the damaged file says; it must not open.
fn refusal(damage: impl FnOnce(&mut TreeFile)) -> String {
    let (_, mut file) = sound();
    let before = file.clone();
    damage(&mut file);
    assert_ne!(file, before, "the damage is one");
    match Tree::from_bytes(&file.bytes()) {
        Err(FileError::Structure(fault)) => fault.fault.to_string(),
        other => panic!("{other:?}"),
    }
}

fn assert_refused(fault: &str, damage: impl FnOnce(&mut TreeFile)) {
    let refusal = refusal(damage);
    assert!(refusal.contains(fault), "{refusal:?} instead of {fault:?}");
}

#[test]
fn nodes_that_are_no_tree_are_refused() {
    let node_count = sound().1.nodes.len() as u32;
    assert_refused("plane outside its box", |file| {
        let node = file.inner_nodes()[3];
        file.nodes[node][0] = 7.5_f32.to_bits();
    });
    assert_refused("plane outside its box", |file| file.nodes[0][0] = f32::NAN.to_bits());
    assert_refused("plane outside its box", |file| {
        // In the face is not inside.
        let axis = (file.nodes[0][1] & 3) as usize;
        file.nodes[0][0]
            .clone_from(&u32::from_le_bytes([0, 1, 2, 3].map(|i| file.header[32 + 4 * axis + i])));
    });
    assert_refused("depth-first order", |file| {
        let node = file.inner_nodes()[2];
        file.nodes[node][1] += 1 << 2;
    });
    assert_refused("depth-first order", |file| {
        // A cycle: the root is its own right child.
        file.nodes[0][1] &= 3;
    });
    assert_refused("beyond the last node", |file| {
        file.nodes.truncate(file.nodes.len() - 1);
    });
    assert_refused("depth-first order", |file| file.nodes[0][1] = (node_count + 10) << 2);
    assert_refused("belongs to no tree", |file| file.nodes.push([0, 3]));
    assert_refused("beyond the last node", |file| file.nodes.clear());
}

#[test]
fn references_that_do_not_fit_are_refused() {
    assert_refused("do not ascend", |file| {
        let first = file.nodes[file.leaves_of(2)[0]][0] as usize;
        file.references.swap(first, first + 1);
    });
    assert_refused("do not ascend", |file| {
        let first = file.nodes[file.leaves_of(2)[0]][0] as usize;
        file.references[first + 1] = file.references[first];
    });
    assert_refused("triangle that is not there", |file| {
        let leaf = file.leaves_of(1)[0];
        let last = (file.nodes[leaf][0] + (file.nodes[leaf][1] >> 2) - 1) as usize;
        file.references[last] = 320;
    });
    assert_refused("references beyond the last", |file| {
        let last = *file.leaves_of(1).last().expect("there are leaves");
        file.nodes[last][1] += 1 << 2;
    });
    assert_refused("where the leaf before it ended", |file| {
        let leaf = file.leaves_of(1)[1];
        file.nodes[leaf][1] -= 1 << 2;
    });
    assert_refused("more references", |file| file.references.push(0));
}

/// What validation says of a tree that opens, but was damaged.
fn violation(damage: impl FnOnce(&mut TreeFile)) -> Violation {
    let (mesh, mut file) = sound();
    let before = file.clone();
    damage(&mut file);
    assert_ne!(file, before, "the damage is one");
    let tree = Tree::from_bytes(&file.bytes()).expect("it is a tree, though not the mesh's");
    tree.validate(&mesh).expect_err("the tree is damaged")
}

#[test]
fn a_dropped_reference_is_missed() {
    let (_, file) = sound();
    // A triangle's only reference in a leaf is needed for the part that lies there.
    for leaf in file.leaves_of(1) {
        let first = file.nodes[leaf][0] as usize;
        let triangle = file.references[first];
        let violation = violation(|file| file.drop_reference(leaf, first));
        assert_eq!(violation, Violation::Missing { node: leaf, triangle });
    }
}

#[test]
fn a_reference_to_another_triangle_is_found() {
    let (mesh, file) = sound();
    let beyond = |triangle: u32, side: f32| {
        mesh.triangle(triangle as usize).iter().all(|corner| side * corner[2] > 0.6)
    };
    // The first reference of a leaf at the top becomes an earlier triangle at the bottom.
    let mut damages = file.leaves_of(1).into_iter().filter_map(|leaf| {
        let first = file.nodes[leaf][0] as usize;
        let bottom = (0..file.references[first]).find(|triangle| beyond(*triangle, -1.0))?;
        beyond(file.references[first], 1.0).then_some((leaf, first, bottom))
    });
    let (leaf, first, bottom) = damages.next().expect("the sphere has a top and a bottom");
    let violation = violation(|file| file.references[first] = bottom);
    assert_eq!(violation, Violation::Unreached { node: leaf, triangle: bottom });
}

/// A plane that moved takes space away from one child's leaves and gives it to the other's.
#[test]
fn a_moved_plane_is_found() {
    let (mesh, file) = sound();
    let mut found = 0;
    for node in file.inner_nodes() {
        let mut moved = file.clone();
        moved.nodes[node][0] = (f32::from_bits(moved.nodes[node][0]) + 0.02).to_bits();
        // Where planes below are passed, it is no tree.
        let Ok(tree) = Tree::from_bytes(&moved.bytes()) else { continue };
        found += usize::from(tree.validate(&mesh).is_err());
    }
    assert!(found > file.inner_nodes().len() / 4, "{found} of {}", file.inner_nodes().len());
}

#[test]
fn a_turned_axis_is_found() {
    let (mesh, file) = sound();
    let mut turned = file;
    turned.nodes[0][1] ^= if turned.nodes[0][1] & 3 == 0 { 1 } else { turned.nodes[0][1] & 3 };
    let rejected = match Tree::from_bytes(&turned.bytes()) {
        Ok(tree) => tree.validate(&mesh).is_err(),
        Err(_) => true,
    };
    assert!(rejected);
}

#[test]
fn a_tree_that_is_one_empty_leaf_is_found() {
    let violation = violation(|file| {
        file.nodes = vec![[0, 3]];
        file.references.clear();
    });
    assert_eq!(violation, Violation::Missing { node: 0, triangle: 0 });
}

#[test]
fn a_tree_of_another_mesh_is_told_apart() {
    let (_, file) = sound();
    let tree = Tree::from_bytes(&file.bytes()).expect("it is sound");
    let knot = torus_knot([2, 3], 40, 5).mesh().expect("generated meshes are sound");
    let swelled = scenes::moved(&sphere(2), |p| p.map(|x| 1.01 * x));
    let mut bent = sphere(2);
    let inside = |p: &[f64; 3]| p.iter().all(|x| x.abs() < 0.9);
    let vertex = bent.positions.iter().position(inside).expect("not all are at the poles");
    bent.positions[vertex][0] += 1e-3;
    for other in [knot, swelled.mesh().expect("sound"), bent.mesh().expect("sound")] {
        assert!(!tree.is_of(&other));
        let violation = tree.validate(&other).expect_err("it is of another mesh");
        assert!(matches!(violation, Violation::OtherMesh { .. }), "{violation}");
    }
}
