//! Whether nodes and references are a tree at all, whatever bytes they are.

use super::{Kind, Node};
use crate::build::MAX_DEPTH;
use crate::geometry::Aabb;

/// What makes nodes and references no tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("node {node}: {fault}")]
pub struct Fault {
    /// Index of the node.
    pub node: usize,
    /// What is wrong with it.
    pub fault: &'static str,
}

/// A node to be visited: its index must be the next one.
struct Pending {
    index: usize,
    bounds: Aabb,
    depth: u32,
}

/// Walks the tree in depth-first order and hands every node to `visit`, with its box and depth.
///
/// Checks that the nodes are exactly one tree in depth-first order, that planes lie strictly
/// inside their boxes, and that the leaves' references come one leaf after the other, name
/// triangles below `triangles`, ascend within a leaf and are all used. Costs one pass.
pub(super) fn walk(
    nodes: &[Node],
    references: &[u32],
    root: Aabb,
    triangles: usize,
    mut visit: impl FnMut(usize, &Aabb, u32),
) -> Result<(), Fault> {
    let mut pending = vec![Pending { index: 0, bounds: root, depth: 0 }];
    let (mut next, mut used) = (0, 0);
    while let Some(place) = pending.pop() {
        let Pending { index, bounds, depth } = place;
        let fault = |fault| Fault { node: index, fault };
        if index != next {
            return Err(fault("is not where depth-first order puts it"));
        }
        next += 1;
        let node = nodes.get(index).ok_or(fault("is beyond the last node"))?;
        visit(index, &bounds, depth);
        match node.kind() {
            Kind::Inner { axis, position, right } => {
                let children = place.children(axis, position, right).map_err(fault)?;
                pending.extend(children);
            }
            Kind::Leaf { first, count } => {
                if first != used {
                    return Err(fault("does not start where the leaf before it ended"));
                }
                used = check_leaf(references, first, count, triangles).map_err(fault)?;
            }
        }
    }
    if next != nodes.len() {
        return Err(Fault { node: next, fault: "belongs to no tree" });
    }
    if used != references.len() {
        let fault = "is the last leaf, but there are more references";
        return Err(Fault { node: next - 1, fault });
    }
    Ok(())
}

impl Pending {
    /// The right child and the left one, to be visited first.
    fn children(
        &self,
        axis: usize,
        position: f32,
        right: usize,
    ) -> Result<[Self; 2], &'static str> {
        if !(self.bounds.lower[axis] < position && position < self.bounds.upper[axis]) {
            return Err("has its plane outside its box");
        }
        if self.depth >= MAX_DEPTH {
            return Err("is deeper than any tree may be");
        }
        let [left_bounds, right_bounds] = self.bounds.cut(axis, position);
        let child = |index, bounds| Self { index, bounds, depth: self.depth + 1 };
        Ok([child(right, right_bounds), child(self.index + 1, left_bounds)])
    }
}

/// The end of a leaf's references, if they are sound.
fn check_leaf(
    references: &[u32],
    first: usize,
    count: usize,
    triangles: usize,
) -> Result<usize, &'static str> {
    let leaf = references.get(first..first + count).ok_or("has references beyond the last")?;
    if leaf.iter().any(|triangle| *triangle as usize >= triangles) {
        return Err("refers to a triangle that is not there");
    }
    if !leaf.is_sorted_by(|a, b| a < b) {
        return Err("has references that do not ascend");
    }
    Ok(first + count)
}
