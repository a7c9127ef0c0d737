//! Which triangles of a block a ray may hit, eight at a time.

use std::arch::x86_64::*;

use super::block::Block;
use super::block_ray::BlockRay;
use super::sift::{Crossed, crossed, filtered, sheared, sift};
use super::sifted::{Sifted, Wants};
use super::vector::{Eight, Mask, by_axis};
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

    /// [`filtered`], as a part of the loop that asks, as in `step/lanes.rs`.
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
    ) -> Option<Sifted> {
        // SAFETY: the same.
        let (corners, interval, t_per_z) = unsafe {
            (self.sheared_avx2(ray), [all(t_min), all(t_max)], all(ray.precise[2] as f32))
        };
        filtered(&corners, t_per_z, interval, wants)
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
