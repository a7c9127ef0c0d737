//! Visit the leaves near a point, the nearest first, or in a box.

use super::block::Block;
use super::prepare::{greater, lesser};
use super::wide::{Child, Layout, Wide};
use crate::geometry::Aabb;

/// Sees what lies around a point.
pub(super) trait NearVisitor {
    /// A block of a leaf. Gives the squared distance up to which there is more to see.
    fn block(&mut self, block: &Block) -> f32;
}

/// A subtree, and the squared distance of its box.
#[derive(Clone, Copy)]
struct Around {
    child: Child,
    squared: f32,
}

/// Distances are rounded; what seems farther by less than this fraction may be nearer.
const SLACK: f32 = 1.0 + 8.0 * f32::EPSILON;

/// Shows `visitor` the leaves whose boxes are within the squared distance `until` of `point`, the
/// nearer ones of each node first.
pub(super) fn visit_near(
    layout: &Layout,
    point: [f32; 3],
    mut until: f32,
    visitor: &mut impl NearVisitor,
) {
    let mut stack = vec![Around { child: Child(0), squared: 0.0 }];
    while let Some(Around { child, squared }) = stack.pop() {
        if squared > until * SLACK {
            continue;
        }
        match child.block() {
            None => push_near(&layout.wides[child.0 as usize], point, until, &mut stack),
            Some(first) => {
                for block in &layout.blocks[first..] {
                    until = lesser(until, visitor.block(block));
                    if block.is_last() {
                        break;
                    }
                }
            }
        }
    }
}

/// Pushes the children of a wide node that are near enough, the nearest last.
fn push_near(wide: &Wide, point: [f32; 3], until: f32, stack: &mut Vec<Around>) {
    let mut squared = [0.0; 8];
    for axis in 0..3 {
        for child in 0..8 {
            let below = wide.bounds[0][axis][child] - point[axis];
            let above = point[axis] - wide.bounds[1][axis][child];
            let outside = greater(greater(below, above), 0.0);
            squared[child] += outside * outside;
        }
    }
    let start = stack.len();
    for child in 0..8 {
        // A free place is infinitely far.
        if squared[child] <= until * SLACK && squared[child] < f32::INFINITY {
            stack.push(Around { child: wide.children[child], squared: squared[child] });
        }
    }
    stack[start..].sort_unstable_by(|a, b| b.squared.total_cmp(&a.squared));
}

/// Shows `visit` the blocks of all leaves that meet `region`.
pub(super) fn visit_box(layout: &Layout, region: &Aabb, visit: &mut impl FnMut(&Block)) {
    let mut stack = vec![Child(0)];
    while let Some(child) = stack.pop() {
        let Some(first) = child.block() else {
            push_overlapping(&layout.wides[child.0 as usize], region, &mut stack);
            continue;
        };
        for block in &layout.blocks[first..] {
            visit(block);
            if block.is_last() {
                break;
            }
        }
    }
}

/// Pushes the children of a wide node that `region` meets, touching included.
fn push_overlapping(wide: &Wide, region: &Aabb, stack: &mut Vec<Child>) {
    for child in 0..8 {
        let meets = (0..3).all(|axis| {
            wide.bounds[0][axis][child] <= region.upper[axis]
                && region.lower[axis] <= wide.bounds[1][axis][child]
        });
        if meets {
            stack.push(wide.children[child]);
        }
    }
}
