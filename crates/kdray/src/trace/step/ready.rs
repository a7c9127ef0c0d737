//! A ray ready for boxes, among many.

use std::arch::x86_64::*;

use super::axes::Axes;
use super::lanes::{Passage, ROW};
use crate::geometry::Ray;
use crate::trace::eights::by_axis;
use crate::trace::wide::Wide;

/// A ray on one line of the cache: [`Slabs`](crate::trace::prepare::Slabs) and its interval as single
/// numbers, of which a step makes vectors as it reads them.
#[repr(align(64))]
#[derive(Clone, Default)]
pub(in crate::trace) struct Ready {
    /// And a number of no consequence.
    inverse: [f32; 4],
    /// Less than nothing, to be added; and where the ray starts.
    enter: [f32; 4],
    /// The same, and where it ends.
    leave: [f32; 4],
    /// By axis, where the row of a node's bounds starts that comes first, in bytes; and the octant.
    rows: [u32; 4],
}

impl Ready {
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(in crate::trace) fn new(ray: &Ray, reach: f32) -> Self {
        let Axes { inverse, enter, leave, octant } = Axes::new(ray, reach);
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
        (new.enter[3], new.leave[3], new.rows[3]) = (ray.t_min, ray.t_max, octant as u32);
        new
    }

    /// The ray's interval.
    #[inline(always)]
    pub(in crate::trace) fn interval(&self) -> [f32; 2] {
        [self.enter[3], self.leave[3]]
    }

    /// Which way the ray goes, less than eight.
    #[inline(always)]
    pub(super) fn octant(&self) -> usize {
        self.rows[3] as usize
    }

    /// Where the ray enters the boxes of children and leaves them. Part of the loop that calls it, as in
    /// `lanes.rs`.
    ///
    /// # Safety
    ///
    /// The processor has AVX2 and FMA.
    #[inline(always)]
    pub(in crate::trace) unsafe fn pass(&self, wide: &Wide, [t_min, t_max]: [f32; 2]) -> Passage {
        let bounds = std::ptr::from_ref(&wide.bounds).cast::<u8>();
        // SAFETY: the same; there are six rows of bounds, eight lanes each, aligned like the node.
        unsafe {
            let inverse = by_axis!(|axis| _mm256_set1_ps(self.inverse[axis]));
            let near = by_axis!(|axis| {
                let row = _mm256_load_ps(bounds.wrapping_add(self.rows[axis] as usize).cast());
                _mm256_fmadd_ps(row, inverse[axis], _mm256_set1_ps(self.enter[axis]))
            });
            let far = by_axis!(|axis| {
                // The rows of an axis are as far from the ends.
                let row = ROW * (3 + 2 * axis) - self.rows[axis] as usize;
                let row = _mm256_load_ps(bounds.wrapping_add(row).cast());
                _mm256_fmadd_ps(row, inverse[axis], _mm256_set1_ps(self.leave[axis]))
            });
            Passage::new(near, far, [t_min, t_max])
        }
    }
}
