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
    while let Some(Pending { index, bounds, depth }) = pending.pop() {
        let fault = |fault| Err(Fault { node: index, fault });
        if index != next {
            return fault("is not where depth-first order puts it");
        }
        next += 1;
        let Some(node) = nodes.get(index) else {
            return fault("is beyond the last node");
        };
        visit(index, &bounds, depth);
        match node.kind() {
            Kind::Inner { axis, position, right } => {
                if !(bounds.lower[axis] < position && position < bounds.upper[axis]) {
                    return fault("has its plane outside its box");
                }
                if depth >= MAX_DEPTH {
                    return fault("is deeper than any tree may be");
                }
                let [left_bounds, right_bounds] = bounds.cut(axis, position);
                let child = |index, bounds| Pending { index, bounds, depth: depth + 1 };
                pending.push(child(right, right_bounds));
                pending.push(child(index + 1, left_bounds));
            }
            Kind::Leaf { first, count } => {
                let leaf = first.checked_add(count).and_then(|end| references.get(first..end));
                let Some(leaf) = leaf else {
                    return fault("has references beyond the last");
                };
                if first != used {
                    return fault("does not start where the leaf before it ended");
                }
                used += count;
                if leaf.iter().any(|triangle| *triangle as usize >= triangles) {
                    return fault("refers to a triangle that is not there");
                }
                if !leaf.is_sorted_by(|a, b| a < b) {
                    return fault("has references that do not ascend");
                }
            }
        }
    }
    if next != nodes.len() {
        return Err(Fault { node: next, fault: "belongs to no tree" });
    }
    if used != references.len() {
        return Err(Fault {
            node: next - 1,
            fault: "is the last leaf, but there are more references",
        });
    }
    Ok(())
}
