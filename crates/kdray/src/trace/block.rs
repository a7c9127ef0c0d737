//! Eight triangles that are tested together.

use super::intersect::{Crossing, crossing, locate};
use super::prepare::Shear;
use crate::geometry::Hit;

/// Triangles in a block.
pub(super) const LANES: usize = 8;

type Lanes = [f32; LANES];

/// Corners and indices of up to eight triangles. Free lanes have the index of the first one, and corners
/// that are not numbers, so that no ray seems to hit anything there.
#[repr(C, align(64))]
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
    /// No hit of a lane comes before. Where hits are located in vectors, that is said of located lanes only.
    pub(super) earliest: Lanes,
    /// Those of which it is known where they are hit: at their earliest `t` and these `u` and `v`.
    #[cfg_attr(
        not(any(test, target_arch = "x86_64")),
        expect(dead_code, reason = "there are none")
    )]
    pub(super) located: u32,
    #[cfg_attr(not(target_arch = "x86_64"), expect(dead_code, reason = "none is located"))]
    pub(super) weights: [Lanes; 2],
}

impl Filtered {
    /// No lane may be hit.
    pub(super) const NONE: Self = Self {
        maybe: 0,
        surely: 0,
        inside: 0,
        earliest: [0.0; LANES],
        located: 0,
        weights: [[0.0; LANES]; 2],
    };

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
            let known = triangles.get(lane).copied();
            let corners = known.map_or([[f32::NAN; 3]; 3], &corners_of);
            for corner in 0..3 {
                for axis in 0..3 {
                    block.corners[corner][axis][lane] = corners[corner][axis];
                }
            }
            block.triangles[lane] = known.unwrap_or(triangles[0]);
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
        let maybe = (1 << self.places().count()) - 1;
        Filtered { maybe, earliest: [f32::NEG_INFINITY; LANES], ..Filtered::NONE }
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

    /// The same, with the first triangle in free lanes too.
    pub(super) fn filled_corners(&self) -> [[Lanes; 3]; 3] {
        let count = self.places().count();
        self.corners.map(|corner| {
            corner.map(|row| std::array::from_fn(|lane| row[if lane < count { lane } else { 0 }]))
        })
    }

    /// The triangles, each once.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> + '_ {
        self.places().map(|lane| self.index(lane))
    }

    /// The lanes that are not free.
    #[inline(always)]
    pub(super) fn places(&self) -> impl Iterator<Item = usize> + '_ {
        (0..LANES).take_while(|lane| *lane == 0 || !self.is_free(*lane))
    }

    /// Whether a lane, not the first, is free.
    #[inline(always)]
    pub(super) fn is_free(&self, lane: usize) -> bool {
        self.triangles[lane] & !LAST == self.triangles[0]
    }
}
