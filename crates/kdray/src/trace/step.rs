//! One step down: which children of a wide node the ray meets, and where.

use super::prepare::{Slabs, greater, lesser};
use super::wide::Wide;

/// The children that the ray meets in `t_min..=t_max`, and where it enters each.
pub(super) struct Met {
    /// A bit for every child.
    pub(super) children: u32,
    pub(super) t_min: [f32; 8],
}

/// Tests the boxes one after the other.
#[inline(always)]
pub(super) fn step(wide: &Wide, slabs: &Slabs, [t_min, t_max]: [f32; 2]) -> Met {
    let mut met = Met { children: 0, t_min: [t_min; 8] };
    for child in 0..8 {
        let mut leave = t_max;
        for axis in 0..3 {
            let backward = slabs.backward[axis];
            let near = wide.bounds[backward][axis][child] * slabs.inverse[axis];
            let far = wide.bounds[1 - backward][axis][child] * slabs.inverse[axis];
            met.t_min[child] = greater(met.t_min[child], near - slabs.enter[axis]);
            leave = lesser(leave, far - slabs.leave[axis]);
        }
        met.children |= u32::from(met.t_min[child] <= leave) << child;
    }
    met
}

/// [`step`] with all boxes at once: the same arithmetic.
///
/// `V` is the visitor of the traversal, so that each traversal has a step of its own and the
/// compiler makes it part of the loop.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2")]
#[expect(clippy::extra_unused_type_parameters, reason = "one function a traversal")]
pub(super) fn step_avx2<V>(wide: &Wide, slabs: &Slabs, [t_min, t_max]: [f32; 2]) -> Met {
    use std::arch::x86_64::*;
    let mut enter = _mm256_set1_ps(t_min);
    let mut leave = _mm256_set1_ps(t_max);
    for axis in 0..3 {
        let backward = slabs.backward[axis];
        let inverse = _mm256_set1_ps(slabs.inverse[axis]);
        // SAFETY: rows are eight lanes, aligned like the node.
        let (near, far) = unsafe {
            let near = wide.bounds.get_unchecked(backward)[axis].as_ptr();
            let far = wide.bounds.get_unchecked(1 - backward)[axis].as_ptr();
            (_mm256_load_ps(near), _mm256_load_ps(far))
        };
        let near = _mm256_mul_ps(near, inverse);
        let far = _mm256_mul_ps(far, inverse);
        enter = _mm256_max_ps(enter, _mm256_sub_ps(near, _mm256_set1_ps(slabs.enter[axis])));
        leave = _mm256_min_ps(leave, _mm256_sub_ps(far, _mm256_set1_ps(slabs.leave[axis])));
    }
    let met = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave));
    let mut t_min = [0.0; 8];
    // SAFETY: eight lanes fit.
    unsafe { _mm256_storeu_ps(t_min.as_mut_ptr(), enter) };
    Met { children: met as u32, t_min }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Ray};
    use crate::trace::wide::Child;

    /// Numbers without a pattern, in 0..1.
    fn noise(state: &mut u32) -> f32 {
        *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (*state >> 8) as f32 / (1 << 24) as f32
    }

    fn random_wide(state: &mut u32) -> Wide {
        let mut wide = Wide::EMPTY;
        for place in 0..(8.9 * noise(state)) as usize {
            let mut corner = || [noise(state), noise(state), noise(state)];
            let bounds = Aabb::of_points(&[corner(), corner()]);
            wide.set(place, &bounds, Child(place as u32));
        }
        wide
    }

    #[test]
    fn avx2_steps_like_the_plain_step() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            println!("this processor has no AVX2: its path was not tested");
            return;
        }
        let mut state = 7;
        let mut count = 0;
        for _ in 0..200_000 {
            let wide = random_wide(&mut state);
            let mut component =
                || if noise(&mut state) < 0.1 { 0.0 } else { 2.0 * noise(&mut state) - 1.0 };
            let origin = [0.5 + 0.5 * component(), 0.5 + 0.5 * component(), component()];
            let ray = Ray::new(origin, [0.3 * component(), 0.3 * component(), 0.5]);
            let slabs = Slabs::new(&ray, 1.0);
            let interval = [0.2 * noise(&mut state), 20.0 * noise(&mut state)];
            let plain = step(&wide, &slabs, interval);
            // SAFETY: the processor has AVX2.
            let lanes = unsafe { step_avx2::<()>(&wide, &slabs, interval) };
            assert_eq!(plain.children, lanes.children, "{wide:?} {slabs:?} {interval:?}");
            for child in (0..8).filter(|child| plain.children >> child & 1 == 1) {
                assert_eq!(plain.t_min[child], lanes.t_min[child]);
                count += 1;
            }
        }
        assert!(count > 50_000, "only {count} children were met");
    }
}
