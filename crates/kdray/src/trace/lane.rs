//! Where a ray hits one triangle of a block: its corners side by side, a lane each.

use std::arch::x86_64::*;

use super::block::{Block, LANES};
use super::block_ray::BlockRay;
use super::prepare::Shear;
use super::vector::by_axis;
use crate::geometry::{Hit, Ray};

impl Block {
    /// The hit of the triangle in a lane, at any `t`. `surely` says that the line crosses it.
    ///
    /// Part of the loop that asks, as in `step/lanes.rs`.
    ///
    /// # Safety
    ///
    /// The processor has AVX2.
    #[inline(always)]
    pub(super) unsafe fn hit_avx2(
        &self,
        lane: usize,
        surely: bool,
        (ray, block_ray): (&Ray, &BlockRay),
    ) -> Option<Hit> {
        if surely {
            // SAFETY: the same.
            let located = unsafe { self.located_avx2(lane, block_ray) };
            if located.is_some() {
                return located;
            }
        }
        // Number by number: read as a whole, from where the call wrote its parts, they would be waited for.
        let Hit { t, triangle, u, v } = unknown_hit(self, lane, surely, ray)?;
        Some(Hit { t, triangle, u, v })
    }

    /// [`locate`](super::intersect::locate) with the same arithmetic, or `None` where the line passes an
    /// edge on the outside by a rounding, or through it.
    ///
    /// # Safety
    ///
    /// The processor has AVX2.
    #[inline(always)]
    unsafe fn located_avx2(&self, lane: usize, ray: &BlockRay) -> Option<Hit> {
        let lane = lane & (LANES - 1);
        // SAFETY: the same; the lane is one of a row.
        unsafe {
            let [x, y, z] = by_axis!(|axis| {
                let [a, b, c] = by_axis!(|corner| *ray.row(self, corner, axis).add(lane));
                let corners = _mm256_cvtps_pd(_mm_setr_ps(a, b, c, 0.0));
                _mm256_sub_pd(corners, _mm256_set1_pd(f64::from(ray.origin[axis])))
            });
            let x = _mm256_sub_pd(x, _mm256_mul_pd(_mm256_set1_pd(ray.precise[0]), z));
            let y = _mm256_sub_pd(y, _mm256_mul_pd(_mm256_set1_pd(ray.precise[1]), z));
            let [x_next, y_next] = [next(x), next(y)];
            // By lane w, u and v: the corner across comes before.
            let edges = _mm256_sub_pd(_mm256_mul_pd(x_next, y), _mm256_mul_pd(x, y_next));
            let [w, v] = halves(edges);
            let sum = _mm_add_sd(_mm_add_sd(_mm_unpackhi_pd(w, w), v), w);
            let weights = _mm256_div_pd(edges, _mm256_broadcastsd_pd(sum));
            // Of edge functions that differ in sign one has not that of their sum; a sum of zero has none.
            if _mm256_movemask_pd(weights) & 0b111 != 0 {
                return None;
            }
            let [a, _] = halves(z);
            // From the first corner to the third, to itself, and to the second.
            let ways = _mm256_sub_pd(next(next(z)), _mm256_broadcastsd_pd(a));
            let [third, second] = halves(_mm256_mul_pd(weights, ways));
            let along = _mm_cvtsd_f64(_mm_add_sd(a, _mm_add_sd(second, third)));
            let weights = _mm256_cvtpd_ps(weights);
            Some(Hit {
                t: (along * ray.precise[2]) as f32,
                triangle: self.index(lane),
                u: _mm_cvtss_f32(_mm_movehl_ps(weights, weights)),
                v: _mm_cvtss_f32(weights),
            })
        }
    }
}

/// In each of three lanes what is in the next.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn next(v: __m256d) -> __m256d {
    // SAFETY: the same.
    unsafe { _mm256_permute4x64_pd::<0b11_00_10_01>(v) }
}

/// The first two lanes, and the others.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn halves(v: __m256d) -> [__m128d; 2] {
    // SAFETY: the same.
    unsafe { [_mm256_castpd256_pd128(v), _mm256_extractf128_pd::<1>(v)] }
}

/// The hit in a lane that takes more than the arithmetic of vectors.
#[cold]
#[inline(never)]
pub(super) fn unknown_hit(block: &Block, lane: usize, surely: bool, ray: &Ray) -> Option<Hit> {
    block.hit(lane, surely, &Shear::new(ray))
}
