//! Visit the leaves near a point, the nearer first, or in a box.

use super::block::Block;
use super::pending::{Pending, Visit};
use super::prepare::{greater, lesser};
use super::wide::{Layout, Wide};
use crate::geometry::Aabb;

/// Sees what lies around a point.
pub(super) trait NearVisitor {
    /// A block of a leaf. Gives the squared distance up to which there is more to see.
    fn block(&mut self, block: &Block) -> f32;
}

/// Squared distances are rounded; what seems farther by less than this may be nearer.
#[inline(always)]
fn with_slack(squared: f32) -> f32 {
    squared * (1.0 + 8.0 * f32::EPSILON) + f32::MIN_POSITIVE
}

/// Shows `visitor` the leaves whose boxes are within the squared distance `until` of `point`, the
/// nearer ones of each node first.
pub(super) fn visit_near(
    layout: &Layout,
    point: [f32; 3],
    until: f32,
    visitor: &mut impl NearVisitor,
) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { visit_avx2(layout, point, until, visitor) };
    }
    visit(layout, point, until, visitor);
}

/// [`visit`], compiled for eight lanes at once: the same arithmetic.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
fn visit_avx2(layout: &Layout, point: [f32; 3], until: f32, visitor: &mut impl NearVisitor) {
    visit(layout, point, until, visitor);
}

#[inline(always)]
fn visit(layout: &Layout, point: [f32; 3], mut until: f32, visitor: &mut impl NearVisitor) {
    let mut pending = Pending::root();
    while let Some(Visit { child, near: squared, .. }) = pending.pop() {
        if squared > with_slack(until) {
            continue;
        }
        let Some(first) = child.block() else {
            push_near(&layout.wides[child.0 as usize], point, until, &mut pending);
            continue;
        };
        for block in &layout.blocks[first..] {
            until = lesser(until, visitor.block(block));
            if block.is_last() {
                break;
            }
        }
    }
}

/// Pushes the children of a wide node that are near enough.
#[inline(always)]
fn push_near(wide: &Wide, point: [f32; 3], until: f32, pending: &mut Pending) {
    let [lower, upper] = &wide.bounds;
    let mut squared = [0.0; 8];
    for axis in 0..3 {
        for child in 0..8 {
            let below = lower[axis][child] - point[axis];
            let above = point[axis] - upper[axis][child];
            let outside = greater(greater(below, above), 0.0);
            squared[child] += outside * outside;
        }
    }
    let until = with_slack(until);
    let mut count = 0;
    for child in 0..8 {
        // Free places have empty boxes.
        if squared[child] <= until && lower[0][child] <= upper[0][child] {
            let (child, near) = (wide.children[child], squared[child]);
            pending.push(Visit { child, near, far: f32::INFINITY }, count);
            count += 1;
        }
    }
}

/// Shows `visit` the blocks of all leaves that meet `region`.
pub(super) fn visit_box(layout: &Layout, region: &Aabb, visit: &mut impl FnMut(&Block)) {
    let mut pending = Pending::root();
    while let Some(Visit { child, .. }) = pending.pop() {
        let Some(first) = child.block() else {
            push_overlapping(&layout.wides[child.0 as usize], region, &mut pending);
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
fn push_overlapping(wide: &Wide, region: &Aabb, pending: &mut Pending) {
    for child in 0..8 {
        let meets = (0..3).all(|axis| {
            wide.bounds[0][axis][child] <= region.upper[axis]
                && region.lower[axis] <= wide.bounds[1][axis][child]
        });
        if meets {
            // In no order.
            pending.push(Visit { child: wide.children[child], near: 0.0, far: 0.0 }, 0);
        }
    }
}
