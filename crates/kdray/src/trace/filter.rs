//! Which triangles of a block a ray may hit, eight at a time.

use std::arch::x86_64::*;

use super::block::Block;
use super::block_ray::BlockRay;
use super::sift::{Crossed, crossed, crossed_between, sheared, sift};
use super::sifted::{Filtered, Sifted, Wants};
use super::vector::{Arithmetic, Eight, Mask, by_axis};
use super::wave::Kept;

/// A number in every lane.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn all(number: f32) -> Eight {
    // SAFETY: the same.
    Eight(unsafe { _mm256_set1_ps(number) })
}

impl Block {
    /// The corners in ray space.
    ///
    /// # Safety
    ///
    /// The processor has AVX2.
    #[inline(always)]
    unsafe fn sheared_avx2(&self, ray: &BlockRay) -> [[Eight; 3]; 3] {
        // SAFETY: the same; rows are eight lanes, aligned like the block.
        unsafe {
            let origin = by_axis!(|axis| all(ray.origin[axis]));
            let slope = [all(ray.slope[0]), all(ray.slope[1])];
            by_axis!(|corner| {
                let point = by_axis!(|axis| Eight(_mm256_load_ps(ray.row(self, corner, axis))));
                sheared(point, &origin, &slope)
            })
        }
    }

    /// The triangles that may be hit in the interval, if there are any.
    ///
    /// A line that crosses a triangle often does so behind the ray, most of all where the ray starts on a
    /// surface. Where it might, or if several may be hit and the first is wanted, or to know whether there is
    /// one is enough, bounds of `t` are asked: they are there sooner than a hit.
    ///
    /// Part of the loop that asks, as in `step/lanes.rs`.
    ///
    /// # Safety
    ///
    /// The processor has AVX2 and FMA.
    #[inline(always)]
    pub(super) unsafe fn filter_avx2(
        &self,
        ray: &BlockRay,
        [t_min, t_max]: [f32; 2],
        wants: Wants,
    ) -> Option<Filtered> {
        // SAFETY: the same.
        let (corners, first, last, t_per_z) =
            unsafe { (self.sheared_avx2(ray), all(t_min), all(t_max), all(ray.precise[2] as f32)) };
        let crossed = crossed(&corners);
        let maybe = crossed.maybe.bits();
        if maybe == 0 {
            return None;
        }
        if wants != Wants::Whether {
            let [a, b, c] = by_axis!(|corner| corners[corner][2] * t_per_z);
            let behind = a.min(b).min(c).is_less(first).bits() & maybe;
            let others = if wants == Wants::First { maybe & (maybe - 1) } else { 0 };
            if behind | others == 0 {
                let sifted = Sifted { maybe, surely: crossed.surely.bits(), inside: 0 };
                return Some(Filtered::all(sifted));
            }
        }
        crossed_between(&corners, &crossed, t_per_z, [first, last]).filtered(wants)
    }

    /// Of the lanes whose edge functions do not differ in sign: all, those whose are not zero, and, if
    /// that is asked for, those that are hit in the interval for certain.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn crossed_avx2<T: Kept>(&self, ray: &BlockRay, [t_min, t_max]: [f32; 2]) -> Sifted {
        // SAFETY: the processor has AVX2.
        let (corners, t_min, t_max, t_per_z) =
            unsafe { (self.sheared_avx2(ray), all(t_min), all(t_max), all(ray.precise[2] as f32)) };
        if T::ASKS_WHETHER {
            sift(&corners, t_per_z, [t_min, t_max])
        } else {
            let Crossed { maybe, surely, .. } = crossed(&corners);
            Sifted { maybe: maybe.bits(), surely: surely.bits(), inside: 0 }
        }
    }
}
