//! Boxes, for all rays of a packet at once.

use std::arch::x86_64::*;

use super::{Rays, greatest, least};
use crate::trace::prepare::{SMALLEST, THICKNESS};
use crate::trace::simd::HasAvx2;
use crate::trace::stack::Stack;
use crate::trace::step::{ROWS, far_to_near_avx2};
use crate::trace::vector::{Arithmetic, Eight, MOST, Mask, Numbers, Vector, by_axis};
use crate::trace::wide::{Child, Wide};

/// Rays ready for boxes, with what [`Slabs`](crate::trace::prepare::Slabs) has of one.
pub(super) struct Boxes<L> {
    inverse: [L; 3],
    enter: [L; 3],
    leave: [L; 3],
    t_min: L,
    octant: usize,
    bounds: Bounds,
}

/// Bounds of what the rays do, for eight boxes.
///
/// A plane at `p` is passed at `(p - o) / d`. That lies between the products of the bounds of the
/// difference and of the inverse. Differences are those to planes moved outwards, by twice the
/// thickness that planes have for one ray: this pays for the roundings here.
struct Bounds {
    /// By axis, in every lane: what is taken off a plane that comes first or last.
    near: [Eight; 3],
    far: [Eight; 3],
    /// The least and the greatest inverse.
    inverse: [[Eight; 2]; 3],
    t_min: Eight,
}

impl<L: Vector> Boxes<L> {
    /// `None` where the rays are not of one octant, or largest in different axes.
    #[inline(always)]
    pub(super) fn new(rays: &Rays<L>, reach: f32, proof: HasAvx2) -> Option<Self> {
        let Rays { origin, direction, t_min, .. } = *rays;
        let [x, y, z] = by_axis!(|axis| direction[axis].magnitude());
        let largest_origin =
            origin[0].magnitude().max(origin[1].magnitude()).max(origin[2].magnitude());
        let smallest = t_min.all(SMALLEST) * x.max(y).max(z);
        let thickness = t_min.all(THICKNESS) * (largest_origin + t_min.all(reach));
        let inverse = by_axis!(|axis| {
            let kept = direction[axis].magnitude().max(smallest).with_signs_of(direction[axis]);
            t_min.all(1.0) / kept
        });
        let backward = by_axis!(|axis| inverse[axis].is_less(t_min.all(0.0)).bits());
        let is_largest =
            [y.is_less(x).and(z.is_less(x)).bits(), z.is_less(y).and_not(y.is_less(x)).bits()];
        let every = (1_u32 << L::LANES) - 1;
        if is_largest.into_iter().chain(backward).any(|lanes| lanes != 0 && lanes != every) {
            return None;
        }
        let octant = backward[0] & 1 | backward[1] & 2 | backward[2] & 4;
        let offset = by_axis!(|axis| origin[axis] * inverse[axis]);
        let thick = by_axis!(|axis| thickness * inverse[axis].magnitude());
        Some(Self {
            inverse,
            enter: by_axis!(|axis| offset[axis] + thick[axis]),
            leave: by_axis!(|axis| offset[axis] - thick[axis]),
            t_min,
            octant: octant as usize,
            bounds: Bounds::new(rays, inverse, 2.0 * greatest(thickness), proof),
        })
    }

    /// The rays that meet the box of a child before `until`.
    #[inline(always)]
    pub(super) fn meet(&self, wide: &Wide, child: usize, until: L) -> u32 {
        let bounds = wide.bounds.as_flattened();
        let rows = &ROWS[self.octant];
        let (mut enter, mut leave) = (self.t_min, until);
        for axis in 0..3 {
            let near = until.all(bounds[rows[axis]][child]) * self.inverse[axis];
            let far = until.all(bounds[rows[3 + axis]][child]) * self.inverse[axis];
            enter = enter.max(near - self.enter[axis]);
            leave = leave.min(far - self.leave[axis]);
        }
        enter.is_at_most(leave).bits()
    }

    /// Puts the children on the stack that some of the rays may meet before `until`, the nearest on
    /// top: each as the index of `node` and its place there.
    #[inline]
    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn push(&self, wide: &Wide, node: Child, until: f32, stack: &mut Stack) {
        let rows = &ROWS[self.octant];
        let mut enter = self.bounds.t_min;
        let mut leave = enter.all(until);
        for axis in 0..3 {
            let [near, far] = [rows[axis], rows[3 + axis]].map(|row| {
                // SAFETY: eight lanes, aligned like the node.
                Eight(unsafe { _mm256_load_ps(wide.bounds.as_flattened()[row].as_ptr()) })
            });
            let [first, last] = self.bounds.times(axis, near, far);
            enter = enter.max(first);
            leave = leave.min(last);
        }
        let met = enter.is_at_most(leave);
        let (places, count) = far_to_near_avx2::<L>(wide, self.octant, met.0);
        let enter = _mm256_permutevar8x32_ps(enter.0, places);
        let places = _mm256_and_si256(places, _mm256_set1_epi32(7));
        let children = _mm256_or_si256(places, _mm256_set1_epi32((node.0 << 3) as i32));
        stack.push_avx2(children, enter, count);
    }
}

impl Bounds {
    #[inline(always)]
    fn new<L: Vector>(rays: &Rays<L>, inverse: [L; 3], thickness: f32, proof: HasAvx2) -> Self {
        let eight = Eight::of_numbers(proof, &Numbers([least(rays.t_min); MOST]));
        let mut bounds =
            Self { near: [eight; 3], far: [eight; 3], inverse: [[eight; 2]; 3], t_min: eight };
        for axis in 0..3 {
            let [first, last] = [least(inverse[axis]), greatest(inverse[axis])];
            let lower = eight.all(least(rays.origin[axis]) - thickness);
            let upper = eight.all(greatest(rays.origin[axis]) + thickness);
            bounds.inverse[axis] = [eight.all(first), eight.all(last)];
            let (near, far) = if first < 0.0 { (lower, upper) } else { (upper, lower) };
            (bounds.near[axis], bounds.far[axis]) = (near, far);
        }
        bounds
    }

    /// No ray passes `near` before the first, and none `far` after the last.
    #[inline(always)]
    fn times(&self, axis: usize, near: Eight, far: Eight) -> [Eight; 2] {
        let (near, far) = (near - self.near[axis], far - self.far[axis]);
        let [least, greatest] = self.inverse[axis];
        [(near * least).min(near * greatest), (far * least).max(far * greatest)]
    }
}
