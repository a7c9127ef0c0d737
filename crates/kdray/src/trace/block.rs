//! Eight triangles that are tested together.

use super::intersect::{Crossing, crossing, locate};
use super::prepare::Shear;
#[cfg(target_arch = "x86_64")]
use super::sift::{Sifted, sheared, sift, signs};
#[cfg(target_arch = "x86_64")]
use super::traverse::Visitor;
#[cfg(target_arch = "x86_64")]
use super::vector::{Arithmetic, Eight, Mask};
use crate::geometry::Hit;
#[cfg(target_arch = "x86_64")]
use crate::geometry::Ray;

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

/// The lanes of a block that a ray may hit in the interval that was asked for.
#[derive(Clone, Copy)]
pub(super) struct Filtered {
    pub(super) maybe: u32,
    /// Those of them that its line crosses for certain.
    pub(super) surely: u32,
    /// Those that are hit in the interval for certain.
    pub(super) inside: u32,
    /// No hit of a lane comes before.
    pub(super) earliest: Lanes,
}

impl Filtered {
    /// Whether the line crosses the triangle for certain.
    #[inline(always)]
    pub(super) fn surely(&self, lane: usize) -> bool {
        self.surely >> lane & 1 == 1
    }

    /// The lanes that are hit in the interval for certain.
    #[inline(always)]
    pub(super) fn inside(&self) -> impl Iterator<Item = usize> + use<> {
        let inside = self.inside;
        (0..LANES).filter(move |lane| inside >> lane & 1 == 1)
    }

    /// Takes out the lane that may be hit first, if that is not after `until`.
    #[inline(always)]
    pub(super) fn next(&mut self, until: f32) -> Option<usize> {
        while self.maybe != 0 {
            let mut first = self.maybe.trailing_zeros() as usize & (LANES - 1);
            let mut rest = self.maybe & (self.maybe - 1);
            while rest != 0 {
                let other = rest.trailing_zeros() as usize & (LANES - 1);
                rest &= rest - 1;
                first = if self.earliest[other] < self.earliest[first] { other } else { first };
            }
            self.maybe &= !(1 << first);
            if self.earliest[first] <= until {
                return Some(first);
            }
        }
        None
    }
}

/// A ray in every lane.
#[cfg(target_arch = "x86_64")]
pub(super) struct RayLanes {
    shear: Shear,
    origin: [Eight; 3],
    slope: [Eight; 2],
    t_per_z: f32,
}

#[cfg(target_arch = "x86_64")]
impl RayLanes {
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn new(ray: &Ray) -> Self {
        use std::arch::x86_64::*;
        let axes = Shear::axes(&ray.direction);
        let order = _mm_setr_epi32(axes[0] as i32, axes[1] as i32, axes[2] as i32, 3);
        let in_order = |start: *const f32| {
            let mut components = [0.0; 4];
            // SAFETY: `start` is followed by four numbers, as many as there is room for.
            unsafe {
                let permuted = _mm_permutevar_ps(_mm_loadu_ps(start), order);
                _mm_storeu_ps(components.as_mut_ptr(), permuted);
            }
            [components[0], components[1], components[2]]
        };
        let start = std::ptr::from_ref(ray).cast::<f32>();
        let shear = Shear::in_order(axes, in_order(start), in_order(start.wrapping_add(4)));
        let all = |value: f32| Eight(_mm256_set1_ps(value));
        let (origin, slope) = (shear.origin.map(all), shear.shear.map(all));
        Self { origin, slope, t_per_z: shear.t_per_z as f32, shear }
    }
}

#[cfg(target_arch = "x86_64")]
impl AsRef<Shear> for RayLanes {
    #[inline(always)]
    fn as_ref(&self) -> &Shear {
        &self.shear
    }
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

    /// A block of one triangle, of no leaf.
    pub(super) fn of(triangle: u32, corners: &[[f32; 3]; 3]) -> Self {
        Self::new(&[triangle], true, |_| *corners)
    }

    /// Puts another triangle in a lane of a block of no leaf, unless it is there already.
    pub(super) fn replace(&mut self, lane: usize, triangle: u32, corners: &[[f32; 3]; 3]) -> bool {
        if (0..LANES).any(|lane| self.index(lane) == triangle) {
            return false;
        }
        for corner in 0..3 {
            for axis in 0..3 {
                self.corners[corner][axis][lane] = corners[corner][axis];
            }
        }
        self.triangles[lane] = triangle;
        true
    }

    /// Whether the leaf has no more blocks after this.
    #[inline(always)]
    pub(super) fn is_last(&self) -> bool {
        self.triangles[LANES - 1] & LAST != 0
    }

    /// What is known of the lanes without a test: nothing.
    #[inline(always)]
    pub(super) fn unknown(&self) -> Filtered {
        let earliest = [f32::NEG_INFINITY; LANES];
        Filtered { maybe: (1 << LANES) - 1, surely: 0, inside: 0, earliest }
    }

    /// The corners in ray space.
    #[cfg(target_arch = "x86_64")]
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn sheared_avx2(&self, ray: &RayLanes) -> [[Eight; 3]; 3] {
        use std::arch::x86_64::_mm256_load_ps;
        let mut corners = [ray.origin; 3];
        for corner in 0..3 {
            for (place, axis) in ray.shear.axes.into_iter().enumerate() {
                // SAFETY: axes are less than three; rows are eight lanes, aligned like the block.
                corners[corner][place] = Eight(unsafe {
                    _mm256_load_ps(self.corners[corner].get_unchecked(axis).as_ptr())
                });
            }
            corners[corner] = sheared(corners[corner], &ray.origin, &ray.slope);
        }
        corners
    }

    /// The lanes whose edge functions do not differ in sign, with the arithmetic of [`crossing`],
    /// but for those that are hit before or after the interval for certain. `V` is the visitor of
    /// the traversal, whose own it is.
    #[cfg(target_arch = "x86_64")]
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    #[expect(clippy::extra_unused_type_parameters, reason = "one function a traversal")]
    pub(super) fn filter_avx2<V>(&self, ray: &RayLanes, [t_min, t_max]: [f32; 2]) -> Filtered {
        let corners = self.sheared_avx2(ray);
        let all = |number: f32| ray.origin[0].all(number);
        let sifted = sift(&corners, all(ray.t_per_z), [all(t_min), all(t_max)]);
        let mut earliest = [0.0; LANES];
        // SAFETY: eight lanes fit.
        unsafe { std::arch::x86_64::_mm256_storeu_ps(earliest.as_mut_ptr(), sifted.early.0) };
        let Sifted { maybe, surely, inside, .. } = sifted;
        Filtered { maybe, surely, inside, earliest }
    }

    /// Of the lanes whose edge functions do not differ in sign: all, those whose are not zero, and, if
    /// that is asked for, those that are hit in the interval for certain.
    #[cfg(target_arch = "x86_64")]
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn crossed_avx2<V: Visitor>(
        &self,
        ray: &RayLanes,
        [t_min, t_max]: [f32; 2],
    ) -> (u32, u32, u32) {
        let corners = self.sheared_avx2(ray);
        if V::ASKS_WHETHER {
            let all = |number: f32| ray.origin[0].all(number);
            let sifted = sift(&corners, all(ray.t_per_z), [all(t_min), all(t_max)]);
            (sifted.maybe, sifted.surely, sifted.inside)
        } else {
            let (_, maybe, surely) = signs(&corners);
            (maybe.bits(), surely.bits(), 0)
        }
    }

    /// The index of the triangle in a lane.
    #[inline(always)]
    pub(super) fn index(&self, lane: usize) -> u32 {
        self.triangles[lane & (LANES - 1)] & !LAST
    }

    /// The hit of the triangle in a lane, at any `t`. `surely` says that the line crosses it.
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize, surely: bool, shear: &Shear) -> Option<Hit> {
        let (triangle, corners) = self.triangle(lane);
        let Crossing { t, u, v } =
            if surely { locate(*shear, &corners) } else { crossing(*shear, &corners)? };
        Some(Hit { t, triangle, u, v })
    }

    /// The triangle in a lane: its index and its corners.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> (u32, [[f32; 3]; 3]) {
        let corner = |corner: usize| {
            let [x, y, z] = &self.corners[corner];
            [x[lane], y[lane], z[lane]]
        };
        (self.index(lane), [corner(0), corner(1), corner(2)])
    }

    /// The corners of the triangles, by corner and axis.
    #[inline(always)]
    pub(super) fn corners(&self) -> &[[Lanes; 3]; 3] {
        &self.corners
    }

    /// The triangles, each once.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> + '_ {
        self.places().map(|lane| self.index(lane))
    }

    /// The lanes that do not only repeat the first.
    #[inline(always)]
    pub(super) fn places(&self) -> impl Iterator<Item = usize> + '_ {
        (0..LANES).take_while(|lane| *lane == 0 || !self.is_free(*lane))
    }

    /// Whether a lane, not the first, only repeats the first.
    #[inline(always)]
    pub(super) fn is_free(&self, lane: usize) -> bool {
        self.triangles[lane] & !LAST == self.triangles[0]
    }
}
