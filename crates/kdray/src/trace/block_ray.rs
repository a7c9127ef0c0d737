//! A ray as blocks want it.

use std::arch::x86_64::*;

use super::block::{Block, LANES};
use super::prepare::AXES;
use super::step::{halves, largest, magnitude, signs};
use crate::geometry::Ray;

/// A ray ready for the triangles of blocks, as [`Shear`](super::prepare::Shear) is for one: single
/// numbers, of which every test makes vectors as it reads them.
#[derive(Clone)]
pub(super) struct BlockRay {
    frame: &'static Frame,
    /// In the order of the axes of ray space.
    pub(super) origin: [f32; 4],
    pub(super) slope: [f32; 2],
    /// The slope in double precision, `t` per unit of z, and a number of no consequence.
    pub(super) precise: [f64; 4],
}

impl Default for BlockRay {
    fn default() -> Self {
        Self { frame: &FRAMES[0], origin: [0.0; 4], slope: [0.0; 2], precise: [0.0; 4] }
    }
}

impl BlockRay {
    /// The arithmetic of [`Shear::new`](super::prepare::Shear::new), on all axes at once.
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn new(ray: &Ray) -> Self {
        let [origin, direction] = halves(ray);
        let all = magnitude(direction);
        let largest = signs(_mm_cmpeq_ps(all, largest(all)));
        // SAFETY: both are below eight.
        let frame = unsafe { FRAMES.get_unchecked(largest << 3 | signs(direction)) };
        // SAFETY: they are four.
        let axes = unsafe { _mm_loadu_si128(frame.axes.as_ptr().cast()) };
        let [origin, direction] =
            [_mm_permutevar_ps(origin, axes), _mm_permutevar_ps(direction, axes)];
        let across = _mm_cvtps_pd(direction);
        let along = _mm_cvtps_pd(_mm_movehl_ps(direction, direction));
        let t_per_z = _mm_div_sd(_mm_set_sd(1.0), along);
        let slope = _mm_mul_pd(across, _mm_movedup_pd(t_per_z));
        let mut new = Self { frame, ..Self::default() };
        let rounded = _mm_castps_pd(_mm_cvtpd_ps(slope));
        // SAFETY: there is room for as many numbers.
        unsafe {
            _mm_storeu_ps(new.origin.as_mut_ptr(), origin);
            _mm_storel_pd(new.slope.as_mut_ptr().cast(), rounded);
            _mm_storeu_pd(new.precise.as_mut_ptr(), slope);
            _mm_storel_pd(new.precise.as_mut_ptr().add(2), t_per_z);
        }
        new
    }

    /// Where the row of a corner's coordinates starts in a block, by the place of their axis in ray space.
    #[inline(always)]
    pub(super) fn row(&self, block: &Block, corner: usize, place: usize) -> *const f32 {
        let corner = block.corners()[corner].as_ptr().cast::<u8>();
        corner.wrapping_add(self.frame.rows[place] as usize).cast()
    }

    /// The origin, in the order of the axes of ray space, and a number of no consequence.
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn origin_avx2(&self) -> __m128 {
        // SAFETY: they are four.
        unsafe { _mm_loadu_ps(self.origin.as_ptr()) }
    }

    /// The slope in double precision, `t` per unit of z, and a number of no consequence.
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn precise_avx2(&self) -> __m256d {
        // SAFETY: they are four.
        unsafe { _mm256_loadu_pd(self.precise.as_ptr()) }
    }
}

/// The axes of ray space; the fourth is of no consequence.
#[repr(align(32))]
#[derive(Clone, Copy)]
struct Frame {
    /// For permutations.
    axes: [u32; 4],
    /// Where their rows start in a corner of a block, in bytes. Read from here they are there sooner than if they
    /// were made with the ray: the addresses of a whole block wait for them.
    rows: [u32; 4],
}

/// By which axes of a direction are the largest, and which are negative, a bit each.
static FRAMES: [Frame; 64] = {
    let mut frames = [Frame { axes: [3; 4], rows: [0; 4] }; 64];
    let mut at = 0;
    while at < 64 {
        let (largest, negative) = (at >> 3, at & 7);
        // Of several, the last one, as for `frame`.
        let axis = if largest & 4 != 0 { 2 } else { largest >> 1 & 1 };
        let axes = AXES[axis + 3 * (negative >> axis & 1)];
        let mut place = 0;
        while place < 3 {
            frames[at].axes[place] = axes[place] as u32;
            frames[at].rows[place] = (size_of::<[f32; LANES]>() * axes[place]) as u32;
            place += 1;
        }
        at += 1;
    }
    frames
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::prepare::Shear;
    use crate::trace::simd::Best;

    #[test]
    fn axes_are_those_of_shears() {
        if Best::detect().avx2().is_none() {
            println!("this processor has no AVX2");
            return;
        }
        // Several are largest in many of these.
        let components = [-2.0_f32, -1.0, -0.0, 0.0, 1.0, 2.0];
        for case in 0..components.len().pow(3) {
            let direction = [case / 36, case / 6 % 6, case % 6].map(|at| components[at]);
            let ray = Ray::new([0.5, -7.0, 2.0], direction);
            if ray.is_valid() {
                let shear = Shear::new(&ray);
                // SAFETY: the processor has AVX2.
                let found = unsafe { BlockRay::new(&ray) };
                assert_eq!(
                    found.frame.rows[..3],
                    shear.axes.map(|axis| 32 * axis as u32),
                    "{ray:?}"
                );
                assert_eq!(found.origin[..3], shear.origin, "{ray:?}");
                assert_eq!(found.slope, shear.shear, "{ray:?}");
                assert_eq!(found.precise[..2], shear.precise_shear, "{ray:?}");
                assert_eq!(found.precise[2], shear.t_per_z, "{ray:?}");
            }
        }
    }
}
