//! Tree files: what was saved comes back, and no other bytes do.

use std::sync::Arc;

use kdray::{BuildOptions, Cost, FileError, Mesh, Tree};
use kdray_test::tree_file::{HEADER, TreeFile, sum_again};
use kdray_test::{Scene, presets, scenes};
use proptest::prelude::*;

fn small() -> (Mesh, Tree) {
    let mesh = scenes::lattice_soup(12, 6, 3).mesh().expect("generated meshes are sound");
    // Triangles so dear that every one is worth a plane.
    let cost = Cost { traversal: 1.0, intersect: 50.0, empty_bonus: 0.5 };
    let options = BuildOptions { cost, ..BuildOptions::default() };
    let tree = Tree::build(&mesh, &options).expect("the options are in range");
    assert!(tree.nodes().len() > 5, "{tree:?}");
    (mesh, tree)
}

#[test]
fn every_tree_comes_back() {
    for Scene { name, mesh, .. } in scenes::all() {
        for (preset, options) in presets::few() {
            let tree = Tree::build(&mesh, &options).expect("the options are in range");
            let bytes = tree.to_bytes();
            let opened = Tree::from_bytes(&bytes).expect("just written");
            assert_eq!(opened, tree, "{name}, {preset}");
            assert_eq!(opened.to_bytes(), bytes, "{name}, {preset}");
            assert_eq!((opened.bounds(), opened.frame()), (mesh.bounds(), mesh.frame()), "{name}");
            assert_eq!((opened.cost(), opened.stats()), (tree.cost(), tree.stats()), "{name}");
            assert!(opened.is_of(&mesh), "{name}");
        }
    }
}

#[test]
fn every_truncation_is_an_error() {
    let bytes = small().1.to_bytes();
    for length in 0..bytes.len() {
        assert!(Tree::from_bytes(&bytes[..length]).is_err(), "{length} of {} bytes", bytes.len());
    }
}

#[test]
fn bytes_that_are_too_many_are_an_error() {
    let mut bytes = small().1.to_bytes();
    bytes.push(0);
    assert!(matches!(Tree::from_bytes(&bytes), Err(FileError::Length { .. })));
}

#[test]
fn every_damaged_byte_is_found() {
    let bytes = small().1.to_bytes();
    for place in 0..bytes.len() {
        for flip in [0x01, 0x80, 0xff] {
            let mut damaged = bytes.clone();
            damaged[place] ^= flip;
            assert!(Tree::from_bytes(&damaged).is_err(), "byte {place} ^ {flip:#04x}");
        }
    }
}

#[test]
fn errors_say_what_is_wrong() {
    let bytes = small().1.to_bytes();
    let message = |bytes: &[u8]| Tree::from_bytes(bytes).expect_err("it is damaged").to_string();
    assert_eq!(message(b""), "not a kdray tree file: it starts with []");
    assert_eq!(message(b"ply\n"), "not a kdray tree file: it starts with [70, 6c, 79, 0a]");
    let mut newer = bytes.clone();
    newer[8] = 7;
    assert_eq!(message(&newer), "tree file of version 7; this program reads version 1");
    let size = bytes.len();
    let cut = message(&bytes[..size - 4]);
    assert_eq!(cut, format!("the header announces {size} bytes, but the file has {}", size - 4));
    let mut damaged = bytes;
    damaged[size - 1] ^= 1;
    assert!(message(&damaged).ends_with("the file is damaged"), "{}", message(&damaged));
}

/// A header may claim anything; memory and time follow the bytes that are there.
#[test]
fn counts_beyond_the_file_are_an_error() {
    let bytes = small().1.to_bytes();
    for count in [u64::MAX, u64::MAX / 8, 1 << 61, 1 << 40] {
        for place in [16, 24] {
            let mut claims = bytes.clone();
            claims[place..place + 8].copy_from_slice(&count.to_le_bytes());
            sum_again(&mut claims);
            assert!(matches!(Tree::from_bytes(&claims), Err(FileError::Length { .. })), "{count}");
        }
    }
}

#[test]
fn headers_without_meaning_are_errors() {
    let (_, tree) = small();
    let nan = f32::NAN.to_le_bytes();
    let refused = |offset: usize, value: &[u8]| {
        let mut file = TreeFile::of(&tree);
        file.header[offset..offset + value.len()].copy_from_slice(value);
        match Tree::from_bytes(&file.bytes()) {
            Err(FileError::Header { .. }) => {}
            other => panic!("at {offset}: {other:?}"),
        }
    };
    for offset in (32..56).chain(88..100).step_by(4) {
        refused(offset, &nan);
    }
    for offset in [56, 64, 72, 80] {
        refused(offset, &f64::INFINITY.to_le_bytes());
    }
    refused(80, &0.0_f64.to_le_bytes());
    refused(80, &(-1.0_f64).to_le_bytes());
    refused(88, &0.0_f32.to_le_bytes());
    refused(96, &1.0_f32.to_le_bytes());
    // A box whose lower corner is above its upper one.
    refused(32, &1e9_f32.to_le_bytes());
}

/// Bytes at any alignment are opened, in place or copied.
#[test]
fn shared_bytes_may_lie_anywhere() {
    struct Shifted(Vec<u8>, usize);
    impl AsRef<[u8]> for Shifted {
        fn as_ref(&self) -> &[u8] {
            &self.0[self.1..]
        }
    }
    let (mesh, tree) = small();
    for shift in 0..8 {
        let mut bytes = vec![0; shift];
        bytes.extend(tree.to_bytes());
        let opened = Tree::from_shared(Arc::new(Shifted(bytes.clone(), shift))).expect("sound");
        assert_eq!(opened, tree, "shift {shift}");
        assert_eq!(opened.validate(&mesh), Ok(()), "shift {shift}");
        assert_eq!(opened.to_bytes(), tree.to_bytes(), "shift {shift}");
        *bytes.last_mut().expect("there are bytes") ^= 4;
        assert!(Tree::from_shared(Arc::new(Shifted(bytes, shift))).is_err(), "shift {shift}");
    }
}

/// Opens bytes either way: the two must agree, and what opens must bear use.
fn open(bytes: &[u8]) -> Result<Tree, FileError> {
    let copied = Tree::from_bytes(bytes);
    let shared = Tree::from_shared(Arc::new(bytes.to_vec()));
    assert_eq!(copied.is_ok(), shared.is_ok());
    let tree = copied?;
    let stats = tree.stats();
    assert_eq!((stats.nodes, stats.references), (tree.nodes().len(), tree.references().len()));
    assert_eq!(stats.leaves, stats.nodes / 2 + 1, "every inner node has two children");
    assert_eq!(tree.to_bytes(), bytes, "what opens is written back unchanged");
    Ok(tree)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_bytes_are_errors(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(open(&bytes).is_err());
    }

    #[test]
    fn random_bytes_behind_a_sound_start_are_errors(
        body in prop::collection::vec(any::<u8>(), 0..400),
    ) {
        let mut bytes = small().1.to_bytes();
        bytes.truncate(16);
        bytes.extend(body);
        prop_assert!(open(&bytes).is_err());
    }

    /// Damage that the sum does not show: an error, or a tree that can be used and validated.
    #[test]
    fn well_summed_garbage_never_panics(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        is_in_body in any::<bool>(),
    ) {
        let (mesh, tree) = small();
        let mut bytes = tree.to_bytes();
        let start = if is_in_body { HEADER } else { 32 };
        for (place, value) in changes {
            let place = start + place.index(bytes.len() - start);
            // What is reserved is written back as 0, and the sum is set below.
            if !(100..104).contains(&place) && !(112..HEADER).contains(&place) {
                bytes[place] = value;
            }
        }
        sum_again(&mut bytes);
        if let Ok(tree) = open(&bytes) {
            // Either verdict is right; only a panic is wrong.
            let _verdict = tree.validate(&mesh);
            let tracer = kdray::Tracer::new(&mesh, &tree);
            let ray = kdray::Ray::new([-5.0, 0.3, 0.2], [1.0, 0.01, -0.02]);
            let hit = tracer.closest_hit(&ray);
            prop_assert!(hit.is_none_or(|hit| (hit.triangle as usize) < mesh.triangles().len()));
            let closest = tracer.closest_point([0.1, 0.2, 3.0], f32::INFINITY);
            prop_assert!(closest.is_none_or(|it| (it.triangle as usize) < mesh.triangles().len()));
        }
    }

    /// Whole random words for nodes, which hit the structure checks more often than bytes.
    #[test]
    fn well_summed_nodes_never_panic(
        nodes in prop::collection::vec((-4_i8..4, 0_u32..12, 0_u32..4), 1..12),
        references in prop::collection::vec(0_u32..12, 0..12),
    ) {
        let mut file = TreeFile::of(&small().1);
        let node = |(place, index, kind): &(i8, u32, u32)| {
            let first = if *kind == 3 { place.unsigned_abs().into() } else { f32::from(*place).to_bits() };
            [first, index << 2 | kind]
        };
        file.nodes = nodes.iter().map(node).collect();
        file.references = references;
        let _ = open(&file.bytes());
    }
}
