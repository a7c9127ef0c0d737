//! Eight triangles that are tested together.

use super::intersect::{Crossing, crossing, locate};
use super::prepare::Shear;
use crate::geometry::Hit;

/// Triangles in a block.
pub(super) const LANES: usize = 8;

type Lanes = [f32; LANES];

/// Corners and indices of up to eight triangles. Free lanes repeat the first triangle.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Block {
    /// By corner and axis.
    corners: [[Lanes; 3]; 3],
    triangles: [u32; LANES],
}

/// The lanes of a block that the line of a ray may cross, and those that it crosses for certain.
#[derive(Clone, Copy)]
pub(super) struct Filtered {
    pub(super) maybe: u32,
    surely: u32,
}

/// Marks the last block of a leaf, in its last index.
const LAST: u32 = 1 << 31;

impl Block {
    /// A block of `triangles`, which are not empty and at most eight.
    pub(super) fn new(
        triangles: &[u32],
        is_last: bool,
        corners_of: impl Fn(u32) -> [[f32; 3]; 3],
    ) -> Self {
        let mut block: Self = bytemuck::Zeroable::zeroed();
        for lane in 0..LANES {
            let triangle = triangles.get(lane).copied().unwrap_or(triangles[0]);
            let corners = corners_of(triangle);
            for corner in 0..3 {
                for axis in 0..3 {
                    block.corners[corner][axis][lane] = corners[corner][axis];
                }
            }
            block.triangles[lane] = triangle;
        }
        block.triangles[LANES - 1] |= if is_last { LAST } else { 0 };
        block
    }

    /// Whether the leaf has no more blocks after this.
    #[inline(always)]
    pub(super) fn is_last(&self) -> bool {
        self.triangles[LANES - 1] & LAST != 0
    }

    /// What is known of the lanes without a test: nothing.
    #[inline(always)]
    pub(super) fn unknown(&self) -> Filtered {
        Filtered { maybe: (1 << LANES) - 1, surely: 0 }
    }

    /// The lanes whose edge functions do not differ in sign: surely crossed if none is zero. The
    /// arithmetic is that of [`crossing`]. `V` is the visitor of the traversal, whose own it is.
    #[cfg(target_arch = "x86_64")]
    #[inline]
    #[target_feature(enable = "avx2")]
    #[expect(clippy::extra_unused_type_parameters, reason = "one function a traversal")]
    pub(super) fn filter_avx2<V>(&self, shear: &Shear) -> Filtered {
        use std::arch::x86_64::*;
        // SAFETY: rows are eight lanes, aligned like the block.
        let row = |corner: usize, axis: usize| unsafe {
            _mm256_load_ps(self.corners[corner][shear.axes[axis]].as_ptr())
        };
        let [shear_x, shear_y] = [_mm256_set1_ps(shear.shear[0]), _mm256_set1_ps(shear.shear[1])];
        let x0 = _mm256_set1_ps(shear.origin[0]);
        let y0 = _mm256_set1_ps(shear.origin[1]);
        let z0 = _mm256_set1_ps(shear.origin[2]);
        let point = |corner: usize| {
            let z = _mm256_sub_ps(row(corner, 2), z0);
            let x = _mm256_sub_ps(row(corner, 0), x0);
            let y = _mm256_sub_ps(row(corner, 1), y0);
            let x = _mm256_sub_ps(x, _mm256_mul_ps(shear_x, z));
            let y = _mm256_sub_ps(y, _mm256_mul_ps(shear_y, z));
            (x, y)
        };
        let edge = |p: (__m256, __m256), q: (__m256, __m256)| {
            _mm256_sub_ps(_mm256_mul_ps(p.0, q.1), _mm256_mul_ps(p.1, q.0))
        };
        let (a, b, c) = (point(0), point(1), point(2));
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let zero = _mm256_setzero_ps();
        let lowest = _mm256_min_ps(_mm256_min_ps(u, v), w);
        let highest = _mm256_max_ps(_mm256_max_ps(u, v), w);
        let positive = _mm256_cmp_ps::<_CMP_GE_OQ>(lowest, zero);
        let negative = _mm256_cmp_ps::<_CMP_LE_OQ>(highest, zero);
        let maybe = _mm256_movemask_ps(_mm256_or_ps(positive, negative)) as u32;
        if maybe == 0 {
            return Filtered { maybe, surely: 0 };
        }
        let positive = _mm256_cmp_ps::<_CMP_GT_OQ>(lowest, zero);
        let negative = _mm256_cmp_ps::<_CMP_LT_OQ>(highest, zero);
        let surely = _mm256_movemask_ps(_mm256_or_ps(positive, negative)) as u32;
        Filtered { maybe, surely }
    }

    /// The hit of the triangle in a lane of `filtered`, at any `t`.
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize, filtered: Filtered, shear: &Shear) -> Option<Hit> {
        let (triangle, corners) = self.triangle(lane);
        let surely = filtered.surely >> lane & 1 == 1;
        let Crossing { t, u, v } =
            if surely { locate(shear, &corners) } else { crossing(shear, &corners)? };
        Some(Hit { t, triangle, u, v })
    }

    /// The triangle in a lane: its index and its corners.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> (u32, [[f32; 3]; 3]) {
        let corner = |corner: usize| {
            let [x, y, z] = &self.corners[corner];
            [x[lane], y[lane], z[lane]]
        };
        (self.triangles[lane] & !LAST, [corner(0), corner(1), corner(2)])
    }

    /// A bit for every lane whose triangle's bounds are within the squared distance `until` of
    /// `point`, or seem to be.
    #[inline(always)]
    pub(super) fn near(&self, point: [f32; 3], until: f32) -> u32 {
        let mut squared = [0.0; LANES];
        for axis in 0..3 {
            for lane in 0..LANES {
                let [a, b, c] = [0, 1, 2].map(|corner: usize| self.corners[corner][axis][lane]);
                let below = a.min(b).min(c) - point[axis];
                let above = point[axis] - a.max(b).max(c);
                let outside = below.max(above).max(0.0);
                squared[lane] += outside * outside;
            }
        }
        let until = until * (1.0 + 8.0 * f32::EPSILON);
        let mut near = 0;
        for lane in 0..LANES {
            near |= u32::from(squared[lane] <= until) << lane;
        }
        near
    }
}
