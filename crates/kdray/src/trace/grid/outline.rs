//! Where a surface ends.

use rayon::prelude::*;
use xxhash_rust::xxh3::xxh3_128;

/// Bits that say which edge it is; above them are those of its hash.
const NAME_BITS: u32 = 32;

/// About how many edges are sorted together, which bounds the memory that it takes.
const TOGETHER: usize = 1 << 24;

/// The edges of an odd number of triangles, by the positions of their ends.
///
/// Edges are told apart by 96 bits of a hash.
pub(super) fn odd_edges(triangles: &[[[f32; 3]; 3]]) -> Vec<[[f32; 3]; 2]> {
    of_parts(triangles, (3 * triangles.len()).div_ceil(TOGETHER))
}

/// The same, by the edges of so many parts one after the other.
fn of_parts(triangles: &[[[f32; 3]; 3]], parts: usize) -> Vec<[[f32; 3]; 2]> {
    let ends = |name: usize| {
        let corners = &triangles[name / 3];
        [corners[name % 3], corners[(name + 1) % 3]]
    };
    let hashed = |name: usize| hash(ends(name)) << NAME_BITS | name as u128;
    let mut odd = Vec::new();
    for part in 0..parts as u128 {
        let is_here = |edge: &u128| (edge >> NAME_BITS) % parts as u128 == part;
        let all = (0..3 * triangles.len()).into_par_iter().map(hashed);
        // Whether it is here takes a while to say, and mostly there is but one part.
        let mut edges: Vec<u128> =
            if parts == 1 { all.collect() } else { all.filter(is_here).collect() };
        edges.par_sort_unstable();
        let is_odd = |edges: &&[u128]| edges.len() % 2 == 1;
        let runs = edges.chunk_by(|a, b| a >> NAME_BITS == b >> NAME_BITS).filter(is_odd);
        let ends = runs.map(|edges| ends(edges[0] as u32 as usize));
        // An edge that is a point ends nothing.
        odd.extend(ends.filter(|[from, to]| from != to));
    }
    odd
}

/// The same whichever end comes first.
fn hash(ends: [[f32; 3]; 2]) -> u128 {
    let [mut from, mut to] = ends.map(|end| end.map(f32::to_bits));
    if from > to {
        std::mem::swap(&mut from, &mut to);
    }
    xxh3_128(bytemuck::cast_slice(&[from, to]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_even_numbers_of_triangles_are_none() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let of = |faces: &[[usize; 3]], parts: usize| {
            let triangles: Vec<_> =
                faces.iter().map(|face| face.map(|corner| corners[corner])).collect();
            let found = of_parts(&triangles, parts);
            let mut named: Vec<Vec<usize>> = found
                .iter()
                .map(|ends| (0..4).filter(|corner| ends.contains(&corners[*corner])).collect())
                .collect();
            named.sort();
            named
        };
        for parts in 1..5 {
            assert!(of(&faces, parts).is_empty(), "a tetrahedron is closed");
            assert_eq!(of(&faces[..3], parts), [[0, 2], [0, 3], [2, 3]], "one face is open");
            assert!(of(&[faces[0], [1, 0, 2]], parts).is_empty(), "wound either way");
            assert_eq!(of(&[[0, 1, 1]], parts), Vec::<Vec<usize>>::new(), "there and back");
            assert_eq!(of(&[faces[0]; 3], parts), [[0, 1], [0, 2], [1, 2]], "three on each other");
        }
        assert_eq!(odd_edges(&[]), Vec::<[[f32; 3]; 2]>::new());
    }
}
