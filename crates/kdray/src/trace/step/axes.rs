//! A ray with an axis a lane.

use std::arch::x86_64::*;

use crate::geometry::Ray;
use crate::trace::prepare::{SMALLEST, THICKNESS};

/// [`Slabs`](crate::trace::prepare::Slabs) with an axis a lane, and a number of no consequence.
pub(in crate::trace) struct Axes {
    pub(in crate::trace) inverse: __m128,
    pub(in crate::trace) enter: __m128,
    pub(in crate::trace) leave: __m128,
    pub(in crate::trace) octant: usize,
}

impl Axes {
    /// The arithmetic of [`Slabs::new`](crate::trace::prepare::Slabs::new), on all axes at once. A single
    /// ray waits for it, so what is rare is behind a jump, and the octant comes from the direction, which is
    /// there before the quotients.
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(in crate::trace) fn new(ray: &Ray, reach: f32) -> Self {
        let all = |value: f32| _mm_set1_ps(value);
        let [origin, direction] = halves(ray);
        let smallest = _mm_mul_ps(all(SMALLEST), largest(magnitude(direction)));
        let reach = _mm_add_ps(largest(magnitude(origin)), all(reach));
        let thickness = _mm_mul_ps(all(THICKNESS), reach);
        let small = _mm_cmplt_ps(magnitude(direction), smallest);
        let kept = match signs(small) {
            0 => direction,
            _ => kept(direction, smallest, small),
        };
        let inverse = _mm_div_ps(all(1.0), kept);
        let offset = _mm_mul_ps(origin, inverse);
        let thick = _mm_mul_ps(thickness, magnitude(inverse));
        let (enter, leave) = (_mm_add_ps(offset, thick), _mm_sub_ps(offset, thick));
        Self { inverse, enter, leave, octant: signs(direction) }
    }
}

/// A direction whose small components are larger.
#[cold]
#[inline(never)]
#[target_feature(enable = "avx2")]
fn kept(direction: __m128, smallest: __m128, small: __m128) -> __m128 {
    let signed = _mm_or_ps(_mm_and_ps(_mm_set1_ps(-0.0), direction), smallest);
    _mm_blendv_ps(direction, signed, small)
}

/// The origin and the direction, each with a number of no consequence.
#[inline]
#[target_feature(enable = "avx2")]
pub(in crate::trace) fn halves(ray: &Ray) -> [__m128; 2] {
    let start = std::ptr::from_ref(ray).cast::<f32>();
    // SAFETY: a ray is eight numbers.
    unsafe { [_mm_loadu_ps(start), _mm_loadu_ps(start.add(4))] }
}

#[inline]
#[target_feature(enable = "avx2")]
pub(in crate::trace) fn magnitude(v: __m128) -> __m128 {
    _mm_andnot_ps(_mm_set1_ps(-0.0), v)
}

/// The largest of three magnitudes, in each of their lanes. Their bits are in the same order, and integers
/// are compared in a quarter of the time.
#[inline]
#[target_feature(enable = "avx2")]
pub(in crate::trace) fn largest(magnitudes: __m128) -> __m128 {
    let first = _mm_castps_si128(magnitudes);
    let [second, third] =
        [_mm_shuffle_epi32::<0b00_10_01>(first), _mm_shuffle_epi32::<0b01_00_10>(first)];
    _mm_castsi128_ps(_mm_max_epi32(first, _mm_max_epi32(second, third)))
}

/// The axes whose lanes are negative or all ones, a bit each.
#[inline]
#[target_feature(enable = "avx2")]
pub(in crate::trace) fn signs(v: __m128) -> usize {
    _mm_movemask_ps(v) as usize & 7
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::prepare::Slabs;
    use crate::trace::simd::Best;

    #[test]
    fn axes_are_those_of_slabs() {
        if Best::detect().avx2().is_none() {
            println!("this processor has no AVX2");
            return;
        }
        let numbers = |v: __m128| {
            let mut numbers = [0.0; 4];
            // SAFETY: there is room for four.
            unsafe { _mm_storeu_ps(numbers.as_mut_ptr(), v) };
            [numbers[0], numbers[1], numbers[2]]
        };
        let components = [-3.0_f32, -1.0, -1e-12, -0.0, 0.0, 1e-10, 1.0];
        for case in 0..components.len().pow(3) {
            let direction = [case / 49, case / 7 % 7, case % 7].map(|at| components[at]);
            let ray = Ray::new([0.5, -7.0, 2.0], direction);
            if ray.is_valid() {
                let slabs = Slabs::new(&ray, 4.0);
                // SAFETY: the processor has AVX2.
                let axes = unsafe { Axes::new(&ray, 4.0) };
                assert_eq!(numbers(axes.inverse), slabs.inverse, "{ray:?}");
                assert_eq!(numbers(axes.enter), slabs.enter, "{ray:?}");
                assert_eq!(numbers(axes.leave), slabs.leave, "{ray:?}");
                assert_eq!(axes.octant, slabs.octant(), "{ray:?}");
            }
        }
    }
}
