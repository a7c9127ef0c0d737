//! A ray ready for boxes.

use std::arch::x86_64::*;

use crate::geometry::Ray;
use crate::trace::prepare::Slabs;
use crate::trace::step::{ROW, ROWS};
use crate::trace::wide::Wide;

/// A ray on one line of the cache: [`Slabs`] as single numbers, of which a step makes
/// vectors as it reads them.
#[repr(align(64))]
pub(super) struct Ready {
    inverse: [f32; 3],
    /// Less than nothing, to be added.
    enter: [f32; 3],
    leave: [f32; 3],
    t_min: f32,
    t_max: f32,
    /// By axis, where the row of a node's bounds starts that comes first, in bytes.
    rows: [u32; 3],
}

impl Ready {
    pub(super) fn new(ray: &Ray, reach: f32) -> Self {
        let slabs = Slabs::new(ray, reach);
        Self {
            inverse: slabs.inverse,
            enter: slabs.enter.map(|number| -number),
            leave: slabs.leave.map(|number| -number),
            t_min: ray.t_min,
            t_max: ray.t_max,
            rows: std::array::from_fn(|axis| ROWS[slabs.octant()][axis] as u32),
        }
    }
}

/// The children that the ray meets, a bit each: [`meet`](crate::trace::step::meet).
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn meet(wide: &Wide, ready: &Ready) -> u32 {
    let bounds = std::ptr::from_ref(&wide.bounds).cast::<u8>();
    let mut enter = _mm256_set1_ps(ready.t_min);
    let mut leave = _mm256_set1_ps(ready.t_max);
    for axis in 0..3 {
        // The rows of an axis are as far from the ends.
        let (first, both) = (ready.rows[axis] as usize, ROW * (3 + 2 * axis));
        // SAFETY: there are six rows; they are eight lanes each, aligned like the node.
        let [near, far] = [first, both - first]
            .map(|row| unsafe { _mm256_load_ps(bounds.wrapping_add(row).cast()) });
        let inverse = _mm256_set1_ps(ready.inverse[axis]);
        let near = _mm256_fmadd_ps(near, inverse, _mm256_set1_ps(ready.enter[axis]));
        let far = _mm256_fmadd_ps(far, inverse, _mm256_set1_ps(ready.leave[axis]));
        enter = _mm256_max_ps(enter, near);
        leave = _mm256_min_ps(leave, far);
    }
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave)) as u32
}
