//! Visit the leaves near a point, or in a box.

use super::block::Block;
use super::eights::{Array, Eights};
use super::pending::{Pending, Visit};
#[cfg(target_arch = "x86_64")]
use super::simd::HasAvx2;
use super::stack::{CAPACITY_OF_TWO, StackOf};
use super::tilt::Tilt;
use super::traverse::Trip;
#[cfg(target_arch = "x86_64")]
use super::vector::Eight;
use super::wide::{Child, Layout, Wide};
use crate::geometry::Aabb;

/// Sees what lies around a point.
pub(super) trait NearVisitor<'a> {
    /// The squared distance up to which there is something to see. Here and below, the point is in
    /// all lanes.
    fn start<E: Eights>(&mut self, point: &[E; 3]) -> f32;

    /// Whether that distance is likely to become much shorter.
    fn is_far(&self) -> bool;

    /// Leaves among `blocks`. Gives the squared distance up to which there is more to see.
    fn leaves<E: Eights>(&mut self, blocks: &'a [Block], leaves: &[Child], point: &[E; 3]) -> f32;
}

/// The blocks of a leaf.
#[inline(always)]
pub(super) fn blocks_of(blocks: &[Block], leaf: Child) -> impl Iterator<Item = &Block> {
    let mut rest = leaf.block().and_then(|first| blocks.get(first..)).unwrap_or_default().iter();
    let mut is_done = false;
    std::iter::from_fn(move || {
        let block = if is_done { None } else { rest.next() }?;
        is_done = block.is_last() || leaf.is_one();
        Some(block)
    })
}

/// Squared distances are rounded; what seems farther by less than this may be nearer.
#[inline(always)]
fn with_slack(squared: f32) -> f32 {
    squared * (1.0 + 16.0 * f32::EPSILON) + f32::MIN_POSITIVE
}

/// Shows `visitor` the leaves whose boxes are near enough to `point`.
pub(super) fn visit_near<'a>(
    trip: &'a Trip,
    tilts: &[Tilt],
    point: [f32; 3],
    visitor: &mut impl NearVisitor<'a>,
) {
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx2() {
        // SAFETY: the processor has AVX2.
        return unsafe { visit_avx2(proof, &trip.layout, tilts, point, visitor) };
    }
    visit(&trip.layout, tilts, point.map(|number| Array([number; 8])), visitor);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn visit_avx2<'a>(
    _proof: HasAvx2,
    layout: &'a Layout,
    tilts: &[Tilt],
    [x, y, z]: [f32; 3],
    visitor: &mut impl NearVisitor<'a>,
) {
    use std::arch::x86_64::_mm256_set1_ps;
    let point = [Eight(_mm256_set1_ps(x)), Eight(_mm256_set1_ps(y)), Eight(_mm256_set1_ps(z))];
    visit(layout, tilts, point, visitor);
}

#[inline(always)]
fn visit<'a, E: Eights>(
    layout: &'a Layout,
    tilts: &[Tilt],
    point: [E; 3],
    visitor: &mut impl NearVisitor<'a>,
) {
    let mut near = with_slack(visitor.start(&point));
    // The first leaf may be much nearer than what is known at the start.
    let (mut together, mut enough) = (1, 1);
    let mut stack = StackOf::<CAPACITY_OF_TWO>::new();
    let mut leaves = Leaves::new();
    stack.push(Child(0), 0.0);
    loop {
        let mut open = [Child::NONE; TOGETHER];
        let mut count = 0;
        while count < together
            && let Some(child) = stack.pop(near)
        {
            open[count] = child;
            count += 1;
        }
        // The nearest last, so that deeper nodes are on top: that bounds the stack.
        for child in open[..count].iter().rev() {
            let index = child.0 as usize;
            step(&layout.wides[index], &tilts[index], &point, near, &mut stack, &mut leaves);
        }
        if leaves.count >= if count == 0 { 1 } else { enough } {
            near = with_slack(visitor.leaves(&layout.blocks, leaves.take(near), &point));
            if !visitor.is_far() {
                (together, enough) = (TOGETHER, ENOUGH);
            }
        } else if count == 0 {
            break;
        }
    }
}

/// Nodes that are stepped into before the next ones are chosen: the processor does not wait for the
/// one to begin with the other.
const TOGETHER: usize = 2;

/// Leaves that are looked at together, for the same reason. More of either are more of those that
/// would turn out to be too far away.
const ENOUGH: usize = 4;

/// Leaves that are to be looked at.
struct Leaves {
    leaves: [Child; Self::MOST],
    squared: [f32; Self::MOST],
    count: usize,
}

impl Leaves {
    /// Room for fewer than enough, and what nodes add to that.
    const MOST: usize = ENOUGH + 8 * TOGETHER;

    #[inline(always)]
    fn new() -> Self {
        Self { leaves: [Child::NONE; Self::MOST], squared: [0.0; Self::MOST], count: 0 }
    }

    /// Adds the first `count` of eight leaves.
    #[inline(always)]
    fn add(&mut self, leaves: [Child; 8], squared: [f32; 8], count: usize) {
        let places = self.count..self.count + 8;
        self.leaves[places.clone()].copy_from_slice(&leaves);
        self.squared[places].copy_from_slice(&squared);
        self.count += count;
    }

    /// Takes all; gives those that are near enough.
    #[inline(always)]
    fn take(&mut self, near: f32) -> &[Child] {
        let mut kept = 0;
        for index in 0..self.count {
            self.leaves[kept] = self.leaves[index];
            kept += usize::from(self.squared[index] <= near);
        }
        self.count = 0;
        &self.leaves[..kept]
    }
}

/// Puts the children of a wide node that are near enough where they belong, the nearest on top.
#[inline(always)]
fn step<E: Eights>(
    wide: &Wide,
    tilt: &Tilt,
    point: &[E; 3],
    near: f32,
    stack: &mut StackOf<CAPACITY_OF_TWO>,
    leaves: &mut Leaves,
) {
    let [lower, upper] = &wide.bounds;
    let zero = point[0].all(0.0);
    let mut squared = zero;
    for axis in 0..3 {
        let below = zero.load(&lower[axis]) - point[axis];
        let above = point[axis] - zero.load(&upper[axis]);
        let outside = below.max(above).max(zero);
        squared = outside.fused(outside, squared);
    }
    let squared = tilt.squared(point).max(squared);
    // Free places have empty boxes.
    let is_full = zero.load(&lower[0]).is_at_most(zero.load(&upper[0]));
    let is_near = squared.is_at_most(zero.all(near)) & is_full;
    let children = zero.load(bytemuck::cast_ref(&wide.children));
    let packed = |mask: u32| {
        let children = bytemuck::cast(children.packed(mask).numbers());
        (children, squared.packed(mask).numbers(), mask.count_ones() as usize)
    };
    // Those of leaves have their highest bits set.
    let is_leaf = children.signs();
    let (children, squares, count) = packed(is_near & is_leaf);
    leaves.add(children, squares, count);
    let inner = is_near & !is_leaf;
    let (nearest, least) = squared.least_of(inner);
    let (children, squares, count) = packed(inner & !(1 << nearest));
    stack.push_eight(children, squares, count);
    if inner != 0 {
        stack.push(wide.children[nearest], least);
    }
}

/// Shows `visit` the blocks of all leaves that meet `region`.
pub(super) fn visit_box(layout: &Layout, region: &Aabb, visit: &mut impl FnMut(&Block)) {
    let mut pending = Pending::root();
    while let Some(Visit { child, .. }) = pending.pop() {
        if child.block().is_none() {
            push_overlapping(&layout.wides[child.0 as usize], region, &mut pending);
        }
        blocks_of(&layout.blocks, child).for_each(&mut *visit);
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
