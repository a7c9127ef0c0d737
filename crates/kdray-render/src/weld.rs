//! Vertices at one place are one vertex.

use kdray::Mesh;
use rayon::prelude::*;

/// For each vertex the lowest index of a vertex at the same position.
///
/// Files split vertices where texture coordinates or materials change; the surface goes on there.
pub(crate) fn weld(mesh: &Mesh) -> Vec<u32> {
    let positions = mesh.positions();
    let key = |index: &u32| positions[*index as usize].map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|index| (key(index), *index));
    let mut welded = vec![0; positions.len()];
    for group in order.chunk_by(|a, b| key(a) == key(b)) {
        for index in group {
            welded[*index as usize] = group[0];
        }
    }
    welded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_vertices_stands_for_all() {
        let positions = [[1.0; 3], [0.0; 3], [1.0; 3], [2.0; 3], [0.0; 3]];
        let mesh = Mesh::new(&positions, &[]).expect("finite");
        assert_eq!(weld(&mesh), [0, 1, 0, 3, 1]);
    }
}
