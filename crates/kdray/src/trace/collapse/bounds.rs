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
pub(super) fn known_parts(tree: &Tree, parts: &[Aabb]) -> Vec<Aabb> {
    let mut parts = parts.iter();
    let part = |node: &Node| match node.kind() {
        Kind::Leaf { count: 1.., .. } => *parts.next().expect("every leaf has bounds"),
        _ => Aabb::EMPTY,
    };
    tree.nodes().iter().map(part).collect()
}

/// By node: bounds of the parts of its triangles if it is a leaf, found by clipping these.
pub(super) fn clipped_parts(mesh: &Mesh, tree: &Tree) -> Vec<Aabb> {
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
