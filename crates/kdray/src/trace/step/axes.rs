//! A ray with an axis a lane.

use std::arch::x86_64::*;

use crate::geometry::{LEAST, MOST, Ray};
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

/// [`Ray::is_valid`], with what [`Axes::new`] works out anyway. Magnitudes are compared as integers: what is not
/// a number is more than any.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
pub(in crate::trace) unsafe fn is_valid(ray: &Ray) -> bool {
    const SHORTEST: i32 = LEAST.to_bits() as i32;
    const LONGEST: i32 = MOST.to_bits() as i32;
    const FARTHEST: i32 = f32::MAX.to_bits() as i32;
    // SAFETY: the same.
    unsafe {
        let [origin, direction] = halves(ray);
        let [far, long] = [largest(magnitude(origin)), largest(magnitude(direction))];
        // The length twice, the distance, and the ends of the interval.
        let sizes = _mm_castps_si128(_mm_blend_ps::<0b0100>(long, far));
        let above = _mm_sub_epi32(sizes, _mm_setr_epi32(SHORTEST, SHORTEST, 0, 0));
        let range = LONGEST - SHORTEST;
        let most = _mm_setr_epi32(range, range, FARTHEST, 0);
        let are_in_range = _mm_castsi128_ps(_mm_cmpeq_epi32(above, _mm_min_epu32(above, most)));
        let is_forward = _mm_cmple_ps(origin, direction);
        _mm_movemask_ps(_mm_blend_ps::<0b1000>(are_in_range, is_forward)) == 0b1111
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
    use crate::trace::noise::noise;
    use crate::trace::prepare::Slabs;
    use crate::trace::simd::Best;

    /// The ends of what is valid, and beside them.
    #[test]
    fn the_same_rays_are_valid() {
        if Best::detect().avx2().is_none() {
            println!("this processor has no AVX2");
            return;
        }
        let of_origin = [0.0, -f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, -f32::NAN];
        let [below, above] = [LEAST.next_down(), MOST.next_up()];
        let of_direction = [0.0, -0.0, LEAST, -LEAST, below, 1.0, -MOST, MOST, -above, f32::NAN];
        let of_t = [0.0, 1.0, f32::INFINITY, f32::NAN, -1.0];
        let [mut valid, mut state] = [0; 2];
        for _ in 0..100_000 {
            let mut pick = |from: &[f32]| from[(from.len() as f32 * noise(&mut state)) as usize];
            let mut ray = Ray::new([1.0; 3], [(); 3].map(|()| pick(&of_direction)));
            for axis in 0..3 {
                ray.origin[axis] =
                    if pick(&[0.0, 0.0, 1.0]) > 0.0 { pick(&of_origin) } else { 2.0 };
            }
            [ray.t_min, ray.t_max] = [pick(&of_t), pick(&of_t)];
            // SAFETY: the processor has AVX2.
            assert_eq!(unsafe { is_valid(&ray) }, ray.is_valid(), "{ray:?}");
            valid += u32::from(ray.is_valid());
        }
        assert!((5_000..50_000).contains(&valid), "{valid} were valid");
    }

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
