//! The boxes of what is in the nodes of a tree.

use rayon::prelude::*;

use crate::geometry::clip::clip;
use crate::geometry::{Aabb, Mesh};
use crate::tree::{Kind, Node, Tree};

/// By node: bounds of the parts of its triangles inside its cell.
pub(super) fn tight_bounds(mesh: &Mesh, tree: &Tree) -> Vec<Aabb> {
    let nodes = tree.nodes();
    let mut bounds = match tree.parts() {
        Some(parts) => known_parts(tree, parts),
        None => clipped_parts(mesh, tree),
    };
    for (index, node) in nodes.iter().enumerate().rev() {
        if let Kind::Inner { right, .. } = node.kind() {
            bounds[index] = bounds[index + 1].union(&bounds[right]);
        }
    }
    bounds
}

/// By node: what the builder knows of its parts if it is a leaf.
fn known_parts(tree: &Tree, parts: &[Aabb]) -> Vec<Aabb> {
    let mut parts = parts.iter();
    let part = |node: &Node| match node.kind() {
        Kind::Leaf { count: 1.., .. } => *parts.next().expect("every leaf has bounds"),
        _ => Aabb::EMPTY,
    };
    tree.nodes().iter().map(part).collect()
}

/// By node: bounds of the parts of its triangles if it is a leaf, found by clipping these.
fn clipped_parts(mesh: &Mesh, tree: &Tree) -> Vec<Aabb> {
    let nodes = tree.nodes();
    let mut bounds = vec![tree.bounds(); nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        if let Kind::Inner { axis, position, right } = node.kind() {
            let [left_cell, right_cell] = bounds[index].cut(axis, position);
            (bounds[index + 1], bounds[right]) = (left_cell, right_cell);
        }
    }
    bounds.par_iter_mut().zip(nodes).for_each(|(bounds, node)| {
        if let Kind::Leaf { first, count } = node.kind() {
            let triangles = &tree.references()[first..first + count];
            let part = |triangle: &u32| clip(&mesh.triangle(*triangle as usize), bounds);
            *bounds =
                triangles.iter().filter_map(part).fold(Aabb::EMPTY, |all, part| all.union(&part));
        }
    });
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BuildOptions;

    /// Triangles that reach over many cells.
    fn mesh() -> Mesh {
        let mut state = 7_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let positions: Vec<[f32; 3]> = (0..1500).map(|_| [0; 3].map(|_| next())).collect();
        let near = |k: u32| [k, (k + 1) % 1500, (k * 7 + 2) % 1500];
        let triangles: Vec<[u32; 3]> = (0..1500).map(near).collect();
        Mesh::new(&positions, &triangles).expect("sound")
    }

    #[test]
    fn what_the_builder_knows_is_what_clipping_finds() {
        let mesh = mesh();
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("no limits");
        let known = known_parts(&tree, tree.parts().expect("it was just built"));
        for (known, found) in known.iter().zip(clipped_parts(&mesh, &tree)) {
            let is_inner_or_empty = known.is_empty();
            // Both are larger than the parts by at most some ulps of one.
            let is_near = |a: f32, b: f32| (a - b).abs() < 1e-5;
            for axis in 0..3 {
                assert!(
                    is_inner_or_empty
                        || is_near(known.lower[axis], found.lower[axis])
                            && is_near(known.upper[axis], found.upper[axis]),
                    "{known:?} {found:?}"
                );
            }
        }
    }
}
