//! Visit the leaves near a point, the nearest first, or in a box.

use super::block::Block;
use super::wide::{Child, Layout, Wide};
use crate::geometry::Aabb;

/// Sees what lies around a point.
pub(super) trait NearVisitor {
    /// A block of a leaf. Gives the squared distance up to which there is more to see.
    fn block(&mut self, block: &Block) -> f32;
}

/// A subtree, and how far the point is outside its box along each axis.
#[derive(Clone, Copy)]
struct Around {
    child: Child,
    outside: [f32; 3],
}

impl Around {
    fn squared_distance(&self) -> f32 {
        let [x, y, z] = self.outside;
        x * x + y * y + z * z
    }

    /// The same place, seen from beyond the plane `distance` away.
    fn beyond(&self, axis: usize, distance: f32) -> Self {
        let mut beyond = *self;
        beyond.outside[axis] = distance.abs();
        beyond
    }
}

/// Distances are rounded; what seems farther by less than this fraction may be nearer.
const SLACK: f32 = 1.0 + 8.0 * f32::EPSILON;

/// Shows `visitor` the leaves whose boxes are within the squared distance `until` of `point`, the
/// nearer ones of each node first.
pub(super) fn visit_near(
    layout: &Layout,
    bounds: &Aabb,
    point: [f32; 3],
    mut until: f32,
    visitor: &mut impl NearVisitor,
) {
    let outside = [0, 1, 2].map(|axis| {
        let (below, above) = (bounds.lower[axis] - point[axis], point[axis] - bounds.upper[axis]);
        below.max(above).max(0.0)
    });
    let mut stack = Vec::with_capacity(64);
    stack.push(Around { child: Child(0), outside });
    while let Some(place) = stack.pop() {
        if place.squared_distance() > until * SLACK {
            continue;
        }
        match place.child.block() {
            None => push_children(
                &layout.wides[place.child.0 as usize],
                point,
                place,
                until,
                &mut stack,
            ),
            Some(first) => {
                for block in &layout.blocks[first..] {
                    until = until.min(visitor.block(block));
                    if block.is_last() {
                        break;
                    }
                }
            }
        }
    }
}

/// Pushes the children of a wide node, those on the point's side of each plane last.
fn push_children(wide: &Wide, point: [f32; 3], place: Around, until: f32, stack: &mut Vec<Around>) {
    let sides = |lane: usize, place: Around| {
        let axis = (wide.axes() >> (2 * lane)) as usize & 3;
        let distance = point[axis] - wide.planes[lane];
        // Farther side first, as (index, place); an infinite plane has nothing on its right.
        let (near, far) = if distance < 0.0 { (0, 1) } else { (1, 0) };
        [(far, place.beyond(axis, distance)), (near, place)]
    };
    let within = |place: &Around| place.squared_distance() <= until * SLACK;
    for (half, place) in sides(3, place) {
        if !within(&place) {
            continue;
        }
        for (quarter, place) in sides(4 * half, place) {
            if !within(&place) {
                continue;
            }
            for (eighth, place) in sides(4 * half + 1 + quarter, place) {
                let child = wide.children[4 * half + 2 * quarter + eighth];
                if child != Child::EMPTY && within(&place) {
                    stack.push(Around { child, ..place });
                }
            }
        }
    }
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

/// Pushes the children of a wide node that `region` reaches: a plane that it only touches does
/// not keep it from either side.
fn push_overlapping(wide: &Wide, region: &Aabb, stack: &mut Vec<Child>) {
    let sides = |lane: usize| {
        let axis = (wide.axes() >> (2 * lane)) as usize & 3;
        let plane = wide.planes[lane];
        let reaches = [region.lower[axis] <= plane, region.upper[axis] >= plane];
        (0..2).filter(move |side| reaches[*side])
    };
    for half in sides(3) {
        for quarter in sides(4 * half) {
            for eighth in sides(4 * half + 1 + quarter) {
                let child = wide.children[4 * half + 2 * quarter + eighth];
                if child != Child::EMPTY {
                    stack.push(child);
                }
            }
        }
    }
}
