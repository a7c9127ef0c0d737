//! Eight triangles that are tested together.

use super::intersect::{Crossing, crossing, locate};
use super::prepare::Shear;
use super::sifted::Sifted;
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
    pub(super) fn unknown(&self) -> Sifted {
        Sifted { maybe: (1 << self.places().count()) - 1, surely: 0, inside: 0 }
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
