use std::collections::HashMap;

use super::*;
use crate::Loaded;

/// FNV-1a over the bits of everything in a mesh.
fn checksum(mesh: &Loaded) -> u64 {
    let positions = mesh.positions.iter().flatten().map(|value| value.to_bits());
    let indices = mesh.triangles.iter().flatten().map(|&index| u64::from(index));
    positions.chain(indices).fold(0xcbf2_9ce4_8422_2325, |sum, word| {
        word.to_le_bytes()
            .iter()
            .fold(sum, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    })
}

/// How often each directed edge occurs.
fn edges(triangles: &[[u32; 3]]) -> HashMap<[u32; 2], usize> {
    let mut edges = HashMap::new();
    for &[a, b, c] in triangles {
        for edge in [[a, b], [b, c], [c, a]] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

/// Whether every edge is used once in each direction.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let edges = edges(triangles);
    edges.iter().all(|(&[a, b], &count)| count == 1 && edges.get(&[b, a]) == Some(&1))
}

fn volume(mesh: &Loaded) -> f64 {
    let sixth = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|index| mesh.positions[index as usize]);
        vector::dot(a, vector::cross(b, c)) / 6.0
    };
    mesh.triangles.iter().map(sixth).sum()
}

fn assert_sound(mesh: &Loaded) {
    assert!(mesh.positions.iter().flatten().all(|value| f64::from(*value as f32) == *value));
    let vertices = mesh.positions.len() as u32;
    assert!(mesh.triangles.iter().flatten().all(|&index| index < vertices));
    assert!(mesh.mesh().is_ok());
}

#[test]
fn the_same_bits_everywhere() {
    let sums = [
        checksum(&showcase(20_000)),
        checksum(&sphere(4)),
        checksum(&torus_knot([2, 3], 100, 9)),
        checksum(&soup(1000, 1)),
        checksum(&slivers(1000, 1)),
    ];
    let expected = [
        0x690c_7be6_aad2_b94d,
        0x0676_af1f_c886_913d,
        0x7a74_78c1_b857_62c6,
        0xf201_5c47_d02a_3d3e,
        0xe5f5_8e39_b2b7_9004,
    ];
    assert_eq!(sums, expected, "{sums:#x?}");
}

#[test]
fn the_showcase_has_exactly_the_triangles_asked_for() {
    for triangles in (1..400).chain([1_499, 1_500, 9_999, 10_000, 123_457, 1_000_000]) {
        let mesh = showcase(triangles);
        assert_eq!(mesh.triangles.len(), triangles);
        assert_sound(&mesh);
    }
    assert_eq!(showcase(0).triangles.len(), 1);
}

#[test]
fn solids_are_closed_and_face_outwards() {
    let cases = [
        ("cube", cube(), 12, 8.0),
        ("sphere", sphere(4), 5120, 4.17),
        ("trefoil", torus_knot([2, 3], 300, 16), 9600, 1.7),
    ];
    for (name, mesh, triangles, at_least) in cases {
        assert_eq!(mesh.triangles.len(), triangles, "{name}");
        assert_sound(&mesh);
        assert!(is_closed(&mesh.triangles), "{name}");
        assert!(volume(&mesh) >= at_least, "{name}: {}", volume(&mesh));
    }
}

#[test]
fn closed_pieces_of_the_showcase_are_closed() {
    let pieces: [(&str, showcase::Piece); 4] = [
        ("gourd", showcase::add_gourd),
        ("trefoil", showcase::add_trefoil),
        ("gear", showcase::add_gear),
        ("rounded cube", showcase::add_rounded_cube),
    ];
    for (name, add) in pieces {
        let mut mesh = Loaded::default();
        add(&mut mesh, 5_000);
        assert!((4_000..=5_000).contains(&mesh.triangles.len()), "{name}");
        assert!(is_closed(&mesh.triangles), "{name}");
        assert!(volume(&mesh) > 1.0, "{name}: {}", volume(&mesh));
    }
}

#[test]
fn loose_triangles_and_grids_have_their_counts() {
    for mesh in [soup(777, 3), slivers(777, 3)] {
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (777, 3 * 777));
        assert_sound(&mesh);
    }
    assert_eq!((grid(5).triangles.len(), grid(5).positions.len()), (50, 36));
    assert_eq!(grid(0).triangles.len(), 0);
}
