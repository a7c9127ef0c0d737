//! Visit the leaves along a ray from front to back, with a stack \[PH04].

use super::block::{Block, Filtered};
use super::prepare::{Shear, Slabs, lesser};
use super::stack::{Stack, Visit};
use super::step;
use super::wide::{Child, Layout, Wide};
use crate::geometry::{Aabb, Hit, Ray};

/// Sees what a ray comes to.
pub(super) trait Visitor {
    /// A hit of a leaf, at any `t`. Gives the `t` up to which there is more to see.
    fn hit(&mut self, hit: Hit) -> f32;

    /// An inner node.
    #[inline(always)]
    fn step(&mut self) {}

    /// A leaf.
    #[inline(always)]
    fn leaf(&mut self) {}

    /// A block of a leaf.
    #[inline(always)]
    fn test(&mut self) {}
}

/// No `t` is as low: the visitor has seen enough.
pub(super) const ENOUGH: f32 = f32::NEG_INFINITY;

/// Shows `visitor` what the ray comes to, leaf by leaf from front to back.
///
/// Planes are as thick as [`Slabs`](super::prepare::Slabs) says, so a ray near a plane visits
/// both sides.
pub(super) fn traverse(
    layout: &Layout,
    bounds: &Aabb,
    ray: &Ray,
    slabs: &Slabs,
    visitor: &mut impl Visitor,
) {
    let (t_min, t_max) = slabs.clip(bounds, ray.t_min, ray.t_max);
    if t_min > t_max {
        return;
    }
    let entry = Entry { layout, shear: Shear::new(ray), slabs, interval: [t_min, t_max] };
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { entry.traverse_avx2(visitor) };
    }
    entry.traverse_with(
        visitor,
        |wide, interval, stack| step::step(wide, slabs, interval, stack),
        Block::unknown,
    );
}

/// A ray that has entered the root's box.
struct Entry<'a> {
    layout: &'a Layout,
    shear: Shear,
    slabs: &'a Slabs,
    interval: [f32; 2],
}

impl Entry<'_> {
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
    fn traverse_avx2<V: Visitor>(&self, visitor: &mut V) {
        let lanes = step::avx2::Lanes::new(self.slabs);
        let step = |wide: &Wide, interval: [f32; 2], stack: &mut Stack| {
            step::avx2::step::<V>(wide, self.slabs, &lanes, interval, stack)
        };
        self.traverse_with(visitor, step, |block| block.filter_avx2::<V>(&self.shear));
    }

    /// The traversal, with a way to step down and one to filter the triangles of a block.
    #[inline(always)]
    fn traverse_with(
        &self,
        visitor: &mut impl Visitor,
        step: impl Fn(&Wide, [f32; 2], &mut Stack) -> Option<Visit>,
        filter: impl Fn(&Block) -> Filtered,
    ) {
        let mut until = self.interval[1];
        let mut stack = Stack::new();
        let mut nearest =
            Some(Visit { child: Child(0), t_min: self.interval[0], t_max: self.interval[1] });
        while let Some(Visit { child, t_min, t_max }) = nearest.take().or_else(|| stack.pop()) {
            if t_min > until {
                continue;
            }
            let Some(first) = child.block() else {
                visitor.step();
                let interval = [t_min, lesser(t_max, until)];
                // SAFETY: children of a layout are in it.
                let wide = unsafe { self.layout.wides.get_unchecked(child.0 as usize) };
                nearest = step(wide, interval, &mut stack);
                continue;
            };
            visitor.leaf();
            for block in &self.layout.blocks[first..] {
                visitor.test();
                let filtered = filter(block);
                let mut lanes = filtered.maybe;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let Some(hit) = block.hit(lane, filtered, &self.shear) else { continue };
                    until = lesser(until, visitor.hit(hit));
                    if until == ENOUGH {
                        return;
                    }
                }
                if block.is_last() {
                    break;
                }
            }
        }
    }
}
