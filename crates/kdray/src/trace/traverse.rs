//! Visit the leaves along a ray from front to back, with a stack [PH04].

use super::block::Block;
use super::prepare::Prepared;
use super::stack::Stack;
use super::step;
use super::wide::{Child, Layout, Wide};
use crate::geometry::{Aabb, Hit};

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
pub(super) fn traverse(layout: &Layout, bounds: &Aabb, ray: &Prepared, visitor: &mut impl Visitor) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { traverse_avx2(layout, bounds, ray, visitor) };
    }
    traverse_with(
        layout,
        bounds,
        ray,
        visitor,
        |wide, interval, stack| {
            step::step(wide, &ray.slabs, interval, stack);
        },
        Block::all,
    );
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
fn traverse_avx2(layout: &Layout, bounds: &Aabb, ray: &Prepared, visitor: &mut impl Visitor) {
    let lanes = step::avx2::Lanes::new(&ray.slabs);
    let step = |wide: &Wide, interval: [f32; 2], stack: &mut Stack| {
        step::avx2::step(wide, &ray.slabs, &lanes, interval, stack);
    };
    traverse_with(layout, bounds, ray, visitor, step, |block| block.filter_avx2(&ray.shear));
}

/// The traversal, with a way to step down and one to filter the triangles of a block.
#[inline(always)]
fn traverse_with(
    layout: &Layout,
    bounds: &Aabb,
    ray: &Prepared,
    visitor: &mut impl Visitor,
    step: impl Fn(&Wide, [f32; 2], &mut Stack),
    filter: impl Fn(&Block) -> u32,
) {
    let (t_min, t_max) = ray.slabs.clip(bounds, ray.t_min, ray.t_max);
    if t_min > t_max {
        return;
    }
    let mut until = t_max;
    let mut stack = Stack::new();
    stack.push(Child(0), t_min, t_max);
    while let Some((child, t_min, t_max)) = stack.pop() {
        if t_min > until {
            continue;
        }
        let Some(mut place) = child.block() else {
            visitor.step();
            step(&layout.wides[child.0 as usize], [t_min, t_max.min(until)], &mut stack);
            continue;
        };
        visitor.leaf();
        loop {
            let block = &layout.blocks[place];
            visitor.test();
            let mut lanes = filter(block);
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let Some(hit) = block.hit(lane, &ray.shear) else {
                    continue;
                };
                until = until.min(visitor.hit(hit));
                if until == ENOUGH {
                    return;
                }
            }
            if block.is_last() {
                break;
            }
            place += 1;
        }
    }
}
