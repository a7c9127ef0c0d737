//! Which triangles of a block a ray hits, and where, eight at a time.

use std::arch::x86_64::*;

use super::block::{Block, Filtered, LANES};
use super::block_ray::BlockRay;
use super::eights;
use super::located::{Located, located, precisely_sheared};
use super::prepare::Shear;
use super::sift::{Crossed, Sifted, crossed, crossed_between, sheared, sift};
use super::vector::{Arithmetic, Eight, Four, Mask, Precise, PreciseEight, by_axis};
use super::wave::Kept;
use crate::geometry::{Hit, Ray};

impl Block {
    /// The corners in ray space.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn sheared_avx2(&self, ray: &BlockRay) -> [[Eight; 3]; 3] {
        let all = |number: f32| Eight(_mm256_set1_ps(number));
        let origin = by_axis!(|axis| all(ray.origin[axis]));
        let slope = [all(ray.slope[0]), all(ray.slope[1])];
        by_axis!(|corner| {
            let point = by_axis!(|axis| {
                // SAFETY: rows are eight lanes, aligned like the block.
                Eight(unsafe { _mm256_load_ps(ray.row(self, corner, axis)) })
            });
            sheared(point, &origin, &slope)
        })
    }

    /// Where the line of the ray crosses the triangles. `V` is as for the filter.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn located_avx2<V>(&self, ray: &BlockRay) -> Located<PreciseEight> {
        let all = |number: f64| PreciseEight([Four(_mm256_set1_pd(number)); 2]);
        let origin = by_axis!(|axis| all(f64::from(ray.origin[axis])));
        let slope = [all(ray.precise[0]), all(ray.precise[1])];
        let corners = by_axis!(|corner| {
            let way = by_axis!(|axis| {
                let row = ray.row(self, corner, axis);
                // SAFETY: rows are eight lanes, aligned like the block.
                let [low, high] = unsafe { [_mm_load_ps(row), _mm_load_ps(row.add(4))] };
                let point = [Four(_mm256_cvtps_pd(low)), Four(_mm256_cvtps_pd(high))];
                PreciseEight(point) - origin[axis]
            });
            precisely_sheared(way, &slope)
        });
        located(corners, all(ray.precise[2]))
    }

    /// The lanes that are hit in the interval, and where; and those of which that is not known in vectors.
    /// Where it is enough to know whether, that may be all that is said.
    ///
    /// A line that crosses a triangle often does so behind the ray, most of all where the ray starts on a
    /// surface. Where it might, bounds of `t` are asked first: a third of the instructions. `V` is the place that asks.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn filter_avx2<V>(
        &self,
        ray: &BlockRay,
        [t_min, t_max]: [f32; 2],
        whether: bool,
    ) -> Option<Filtered> {
        let corners = self.sheared_avx2(ray);
        let all = |number: f32| Eight(_mm256_set1_ps(number));
        let (first, last, t_per_z) = (all(t_min), all(t_max), all(ray.precise[2] as f32));
        let crossed = crossed(&corners);
        let (mut maybe, surely) = (crossed.maybe.bits(), crossed.surely.bits());
        if maybe == 0 {
            return None;
        }
        let [a, b, c] = by_axis!(|corner| corners[corner][2] * t_per_z);
        let is_ahead = a.min(b).min(c).is_less(first).bits() & maybe == 0;
        if whether || !is_ahead || t_max < f32::INFINITY {
            let (sifted, _) = crossed_between(&corners, &crossed, t_per_z, [first, last]);
            maybe = sifted.maybe;
            if maybe == 0 {
                return None;
            }
            if whether && sifted.inside != 0 {
                return Some(Filtered { maybe, surely, inside: sifted.inside, ..Filtered::NONE });
            }
        }
        let Located { known, t, u, v } = self.located_avx2::<V>(ray);
        let (t, known) = (t.rounded(), known & surely);
        let inside = first.is_at_most(t).and(t.is_at_most(last)).bits();
        Some(Filtered {
            maybe: maybe & (inside | !known),
            surely,
            inside: inside & maybe & known,
            located: known,
            earliest: eights::Eights::numbers(t),
            weights: [eights::Eights::numbers(u.rounded()), eights::Eights::numbers(v.rounded())],
        })
    }

    /// Of the lanes whose edge functions do not differ in sign: all, those whose are not zero, and, if
    /// that is asked for, those that are hit in the interval for certain.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn crossed_avx2<T: Kept>(&self, ray: &BlockRay, [t_min, t_max]: [f32; 2]) -> Sifted {
        let corners = self.sheared_avx2(ray);
        if T::ASKS_WHETHER {
            let all = |number: f32| Eight(_mm256_set1_ps(number));
            let (sifted, _) = sift(&corners, all(ray.precise[2] as f32), [all(t_min), all(t_max)]);
            sifted
        } else {
            let Crossed { maybe, surely, .. } = crossed(&corners);
            Sifted { maybe: maybe.bits(), surely: surely.bits(), inside: 0 }
        }
    }
}

impl Filtered {
    /// [`Filtered::next`], all lanes at once. Those of which nothing is known come first; one that is left
    /// alone comes, wherever it is hit.
    #[inline]
    #[target_feature(enable = "avx2")]
    #[expect(clippy::extra_unused_type_parameters, reason = "one function a traversal")]
    pub(super) fn next_avx2<V>(&mut self, until: f32) -> Option<usize> {
        let maybe = self.maybe;
        if maybe & maybe.wrapping_sub(1) == 0 {
            self.maybe = 0;
            return (maybe != 0).then(|| maybe.trailing_zeros() as usize & (LANES - 1));
        }
        // SAFETY: eight lanes.
        let earliest = Eight(unsafe { _mm256_loadu_ps(self.earliest.as_ptr()) });
        let early = earliest.is_at_most(earliest.all(until)).bits();
        let maybe = maybe & (early | !self.located);
        let first = match (maybe, maybe & !self.located) {
            (0, _) => return None,
            (_, 0) => eights::Eights::least_of(earliest, maybe).0,
            (_, unknown) => unknown.trailing_zeros() as usize,
        };
        let first = first & (LANES - 1);
        self.maybe = maybe & !(1 << first);
        Some(first)
    }

    /// The hit in a lane of the block, if there is one.
    #[inline(always)]
    pub(super) fn hit(&self, block: &Block, lane: usize, ray: &Ray) -> Option<Hit> {
        if self.located >> lane & 1 == 0 {
            // Number by number: read as a whole, from where the call wrote its parts, they would be waited for.
            let Hit { t, triangle, u, v } = unknown_hit(block, lane, self.surely(lane), ray)?;
            return Some(Hit { t, triangle, u, v });
        }
        let [u, v] = [self.weights[0][lane], self.weights[1][lane]];
        Some(Hit { t: self.earliest[lane], triangle: block.index(lane), u, v })
    }
}

/// The hit in a lane of which nothing is known in vectors.
#[cold]
#[inline(never)]
pub(super) fn unknown_hit(block: &Block, lane: usize, surely: bool, ray: &Ray) -> Option<Hit> {
    block.hit(lane, surely, &Shear::new(ray))
}
