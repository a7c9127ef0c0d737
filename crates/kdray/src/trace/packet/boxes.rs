//! Boxes, for all rays of a packet at once.

use std::arch::x86_64::*;

use super::Rays;
use crate::trace::prepare::{SMALLEST, THICKNESS};
use crate::trace::simd::HasAvx2;
use crate::trace::stack::Stack;
use crate::trace::step::{ROW, ROWS, far_to_near_avx2};
use crate::trace::vector::{Arithmetic, Eight, MOST, Mask, Numbers, Vector, by_axis};
use crate::trace::wide::{Child, Wide};

/// Rays ready for boxes, with what [`Slabs`](crate::trace::prepare::Slabs) has of one.
pub(super) struct Boxes<L> {
    inverse: [L; 3],
    enter: [L; 3],
    leave: [L; 3],
    t_min: L,
    /// That of the first ray.
    octant: usize,
    /// By axis: whether some rays go up and some down.
    is_mixed: [bool; 3],
    bounds: Bounds,
}

impl<L: Vector> Boxes<L> {
    /// `None` where the rays are largest in different axes, or do not go the same way there.
    #[inline(always)]
    pub(super) fn new(rays: &Rays<L>, reach: f32, proof: HasAvx2) -> Option<Self> {
        let Rays { origin, direction, t_min, .. } = *rays;
        let [x, y, z] = by_axis!(|axis| direction[axis].magnitude());
        let largest_origin =
            origin[0].magnitude().max(origin[1].magnitude()).max(origin[2].magnitude());
        let smallest = t_min.all(SMALLEST) * x.max(y).max(z);
        let thickness = t_min.all(THICKNESS) * (largest_origin + t_min.all(reach));
        let kept = by_axis!(|axis| {
            direction[axis].magnitude().max(smallest).with_signs_of(direction[axis])
        });
        let inverse = by_axis!(|axis| t_min.all(1.0) / kept[axis]);
        let backward = by_axis!(|axis| inverse[axis].is_less(t_min.all(0.0)).bits());
        let every = (1_u32 << L::LANES) - 1;
        let is_mixed = backward.map(|lanes| lanes != 0 && lanes != every);
        let largest = match (y.is_less(x).and(z.is_less(x)).bits(), z.is_less(y).bits()) {
            (x, _) if x == every => 0,
            (0, y) if y == every => 1,
            (0, 0) => 2,
            _ => return None,
        };
        if is_mixed[largest] {
            return None;
        }
        let octant = backward[0] & 1 | (backward[1] & 1) << 1 | (backward[2] & 1) << 2;
        let offset = by_axis!(|axis| origin[axis] * inverse[axis]);
        let thick = by_axis!(|axis| thickness * inverse[axis].magnitude());
        let bounds =
            Bounds::new(rays, (kept, inverse), is_mixed, 2.0 * thickness.greatest(), proof);
        Some(Self {
            inverse,
            enter: by_axis!(|axis| offset[axis] + thick[axis]),
            leave: by_axis!(|axis| offset[axis] - thick[axis]),
            t_min,
            octant: octant as usize,
            is_mixed,
            bounds,
        })
    }

    /// The rays that meet the box of a child before `until`.
    #[inline(always)]
    pub(super) fn meet(&self, wide: &Wide, child: usize, until: L) -> u32 {
        let bounds = wide.bounds.as_flattened();
        let rows = ROWS[self.octant].map(|bytes| bytes / ROW);
        let (mut enter, mut leave) = (self.t_min, until);
        for axis in 0..3 {
            let mut near = until.all(bounds[rows[axis]][child]) * self.inverse[axis];
            let mut far = until.all(bounds[rows[3 + axis]][child]) * self.inverse[axis];
            if self.is_mixed[axis] {
                (near, far) = (near.min(far), near.max(far));
            }
            enter = enter.max(near - self.enter[axis]);
            leave = leave.min(far - self.leave[axis]);
        }
        enter.is_at_most(leave).bits()
    }

    /// Puts the children on the stack that some of the rays may meet before `until`, the nearest on
    /// top: each as the index of `node` and its place there. Where an axis is mixed, the nearest is
    /// that of the first ray.
    #[inline]
    #[target_feature(enable = "avx2,fma,popcnt")]
    pub(super) fn push(&self, wide: &Wide, node: Child, until: f32, stack: &mut Stack) {
        let (met, enter) = self.bounds.meet(wide, until);
        // SAFETY: the processor has AVX2.
        let (places, count) = unsafe { far_to_near_avx2(wide, self.octant, met.0) };
        let enter = _mm256_permutevar8x32_ps(enter.0, places);
        let places = _mm256_and_si256(places, _mm256_set1_epi32(7));
        let children = _mm256_or_si256(places, _mm256_set1_epi32((node.0 << 3) as i32));
        stack.push_avx2(children, enter, count);
    }
}

/// Bounds of what the rays do, for eight boxes.
///
/// A plane at `p` is passed at `(p - o) / d`. Where all rays go the same way, that lies between the
/// products of the bounds of the difference and of the inverse. Where they do not, a box is missed if
/// it is beside all that they reach between the other planes. Planes are moved outwards, by twice the
/// thickness that they have for one ray: this pays for the roundings here.
struct Bounds {
    axes: [Axis; 3],
    t_min: Eight,
}

/// Numbers are in every lane.
#[derive(Clone, Copy)]
enum Axis {
    /// What is taken off a plane that comes first or last; the least and the greatest inverse; and
    /// whether upper planes come first.
    OneWay { off: [Eight; 2], inverse: [Eight; 2], is_backward: bool },
    /// The least and the greatest origin and direction.
    BothWays { origin: [Eight; 2], direction: [Eight; 2] },
}

impl Bounds {
    #[inline(always)]
    fn new<L: Vector>(
        rays: &Rays<L>,
        (direction, inverse): ([L; 3], [L; 3]),
        is_mixed: [bool; 3],
        thickness: f32,
        proof: HasAvx2,
    ) -> Self {
        let t_min = Eight::of_numbers(proof, &Numbers([rays.t_min.least(); MOST]));
        let ends = |lanes: L| [lanes.least(), lanes.greatest()];
        let axes = by_axis!(|axis| {
            let [least, greatest] = ends(rays.origin[axis]);
            let origin = [t_min.all(least - thickness), t_min.all(greatest + thickness)];
            if is_mixed[axis] {
                let direction = ends(direction[axis]).map(|end| t_min.all(end));
                Axis::BothWays { origin, direction }
            } else {
                let [least, greatest] = ends(inverse[axis]);
                let (is_backward, [lower, upper]) = (least < 0.0, origin);
                let off = if is_backward { [lower, upper] } else { [upper, lower] };
                Axis::OneWay { off, inverse: [t_min.all(least), t_min.all(greatest)], is_backward }
            }
        });
        Self { axes, t_min }
    }

    /// The boxes that some ray may meet before `until`, and when none is there yet.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn meet(&self, wide: &Wide, until: f32) -> (<Eight as Arithmetic>::Mask, Eight) {
        let row = |end: usize, axis: usize| {
            // SAFETY: rows are eight lanes, aligned like the node.
            Eight(unsafe { _mm256_load_ps(wide.bounds[end][axis].as_ptr()) })
        };
        let (mut enter, mut leave) = (self.t_min, self.t_min.all(until));
        for (at, axis) in self.axes.iter().enumerate() {
            if let Axis::OneWay { off, inverse: [least, greatest], is_backward } = *axis {
                let first = usize::from(is_backward);
                let (near, far) = (row(first, at) - off[0], row(1 - first, at) - off[1]);
                enter = enter.max((near * least).min(near * greatest));
                leave = leave.min((far * least).max(far * greatest));
            }
        }
        let mut met = enter.is_at_most(leave);
        for (at, axis) in self.axes.iter().enumerate() {
            if let Axis::BothWays { origin, direction: [down, up] } = *axis {
                // Between these times, of which the first may be below zero.
                let lowest = origin[0] + (leave * down).min(enter * up);
                let highest = origin[1] + (leave * up).max(enter * down);
                let beside = lowest.is_at_most(row(1, at)).and(row(0, at).is_at_most(highest));
                met = met.and(beside);
            }
        }
        (met, enter)
    }
}
