//! How the triangles of a mesh hang together.

use std::collections::HashMap;

use kdray::Mesh;
use serde::Serialize;

/// What a mesh is like as a surface. Vertices at one position count as one, and
/// triangles that use one twice have no edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Topology {
    /// Triangles without area.
    pub(crate) degenerate_triangles: usize,
    /// Edges of one triangle only.
    pub(crate) boundary_edges: usize,
    /// Edges of three triangles or more.
    pub(crate) non_manifold_edges: usize,
    /// Whether every edge has two triangles.
    pub(crate) closed: bool,
}

impl Topology {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let welded = weld(mesh);
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(3 * mesh.triangles().len());
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| welded[vertex as usize]);
            if a != b && b != c && c != a {
                edges.extend([[a, b], [b, c], [c, a]].map(|[x, y]| [x.min(y), x.max(y)]));
            }
        }
        edges.sort_unstable();
        let uses = || edges.chunk_by(|a, b| a == b).map(<[_]>::len);
        let boundary_edges = uses().filter(|uses| *uses == 1).count();
        let non_manifold_edges = uses().filter(|uses| *uses > 2).count();
        let degenerate = |index: &usize| has_no_area(mesh.triangle(*index));
        Self {
            degenerate_triangles: (0..mesh.triangles().len()).filter(degenerate).count(),
            boundary_edges,
            non_manifold_edges,
            closed: !edges.is_empty() && boundary_edges + non_manifold_edges == 0,
        }
    }
}

/// For each vertex the first one at its position.
fn weld(mesh: &Mesh) -> Vec<u32> {
    let mut first = HashMap::with_capacity(mesh.positions().len());
    let welded = (0..).zip(mesh.positions());
    welded.map(|(index, at)| *first.entry(at.map(f32::to_bits)).or_insert(index)).collect()
}

fn has_no_area(triangle: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = triangle.map(|corner| glam::DVec3::from(corner.map(f64::from)));
    (b - a).cross(c - a) == glam::DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn topology(triangles: &[[u32; 3]]) -> Topology {
        Topology::of(&Mesh::new(&CORNERS, triangles).expect("finite"))
    }

    #[test]
    fn a_tetrahedron_is_closed() {
        let tetrahedron = topology(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        assert!(tetrahedron.closed && tetrahedron.boundary_edges == 0);
    }

    #[test]
    fn what_is_wrong_is_counted() {
        let three_on_an_edge = topology(&[[0, 1, 2], [0, 1, 3], [1, 0, 2], [1, 1, 1]]);
        let expected = Topology {
            degenerate_triangles: 1,
            boundary_edges: 2,
            non_manifold_edges: 1,
            closed: false,
        };
        assert_eq!(three_on_an_edge, expected);
        assert!(!topology(&[]).closed);
    }
}
