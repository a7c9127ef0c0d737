//! A ray ready for boxes.

use std::arch::x86_64::*;

use crate::geometry::Ray;
use crate::trace::step::{Axes, ROW};
use crate::trace::wide::Wide;

/// A ray on one line of the cache: [`Slabs`](crate::trace::prepare::Slabs) and its interval as single
/// numbers, of which a step makes vectors as it reads them.
#[repr(align(64))]
#[derive(Clone, Default)]
pub(super) struct Ready {
    /// And a number of no consequence.
    inverse: [f32; 4],
    /// Less than nothing, to be added; and where the ray starts.
    enter: [f32; 4],
    /// The same, and where it ends.
    leave: [f32; 4],
    /// By axis, where the row of a node's bounds starts that comes first, in bytes; and a number of no
    /// consequence.
    rows: [u32; 4],
}

impl Ready {
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn new(ray: &Ray, reach: f32) -> Self {
        let Axes { inverse, enter, leave, .. } = Axes::new(ray, reach);
        let less = |v: __m128| _mm_xor_ps(_mm_set1_ps(-0.0), v);
        let [row, rows] = [ROW as i32, 3 * ROW as i32];
        let backward = _mm_srai_epi32::<31>(_mm_castps_si128(inverse));
        let first = _mm_and_si128(backward, _mm_set1_epi32(rows));
        let first = _mm_add_epi32(first, _mm_setr_epi32(0, row, 2 * row, 0));
        let mut new = Self::default();
        // SAFETY: there is room for four.
        unsafe {
            _mm_storeu_ps(new.inverse.as_mut_ptr(), inverse);
            _mm_storeu_ps(new.enter.as_mut_ptr(), less(enter));
            _mm_storeu_ps(new.leave.as_mut_ptr(), less(leave));
            _mm_storeu_si128(new.rows.as_mut_ptr().cast(), first);
        }
        (new.enter[3], new.leave[3]) = (ray.t_min, ray.t_max);
        new
    }
}

/// The children that the ray meets, a bit each: [`meet`](crate::trace::step::meet).
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn meet(wide: &Wide, ready: &Ready) -> u32 {
    let bounds = std::ptr::from_ref(&wide.bounds).cast::<u8>();
    let all = |number: f32| _mm256_set1_ps(number);
    let (mut enter, mut leave) = (all(ready.enter[3]), all(ready.leave[3]));
    for axis in 0..3 {
        // The rows of an axis are as far from the ends.
        let (first, both) = (ready.rows[axis] as usize, ROW * (3 + 2 * axis));
        // SAFETY: there are six rows; they are eight lanes each, aligned like the node.
        let [near, far] = [first, both - first]
            .map(|row| unsafe { _mm256_load_ps(bounds.wrapping_add(row).cast()) });
        let inverse = all(ready.inverse[axis]);
        let near = _mm256_fmadd_ps(near, inverse, all(ready.enter[axis]));
        let far = _mm256_fmadd_ps(far, inverse, all(ready.leave[axis]));
        enter = _mm256_max_ps(enter, near);
        leave = _mm256_min_ps(leave, far);
    }
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave)) as u32
}
