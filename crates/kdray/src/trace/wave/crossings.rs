//! Triangles that rays' lines cross, and where they do, four at a time, whatever their rays and blocks.

use std::arch::x86_64::*;

use super::piles::{Kept, Piles};
use crate::trace::block::{Block, LANES};
use crate::trace::block_ray::BlockRay;
use crate::trace::located::{Located, located, precisely_sheared};
use crate::trace::step::places;
use crate::trace::vector::{Four, by_axis};

/// A ray, by its place, and a triangle, by its block and its lane there.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    pub(super) ray: usize,
    pub(super) block: usize,
    pub(super) lane: usize,
}

/// Crossings that are waited for before they are looked at: their blocks are still in the nearest cache.
pub(super) const CROSSINGS: usize = 32;

/// Places of a column: a power of two, so that no place needs a check.
const ROOM: usize = 64;

const _: () = assert!(CROSSINGS + LANES <= ROOM, "the last block adds eight at most");

/// Crossings in two columns. Eight are written at a time, however many of them count.
pub(super) struct Crossings {
    /// Ray and lane, of which there are eight.
    rays: [u32; ROOM],
    blocks: [u32; ROOM],
    len: usize,
}

impl Crossings {
    pub(super) fn new() -> Self {
        Self { rays: [0; _], blocks: [0; _], len: 0 }
    }

    pub(super) fn is_full(&self) -> bool {
        self.len >= CROSSINGS
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds the lanes of a block whose bit is set. They are not full.
    #[inline]
    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn push(&mut self, ray: u32, block: u32, mask: u32) {
        let lanes = _mm256_and_si256(places(mask), _mm256_set1_epi32(LANES as i32 - 1));
        let rays = _mm256_or_si256(lanes, _mm256_set1_epi32((ray * LANES as u32) as i32));
        let blocks = _mm256_set1_epi32(block as i32);
        assert!(self.len < CROSSINGS, "full ones are looked at");
        // SAFETY: there is room for eight.
        unsafe {
            _mm256_storeu_si256(self.rays.as_mut_ptr().add(self.len).cast(), rays);
            _mm256_storeu_si256(self.blocks.as_mut_ptr().add(self.len).cast(), blocks);
        }
        self.len += mask.count_ones() as usize;
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> Crossing {
        let (ray, block) = (self.rays[index] as usize, self.blocks[index] as usize);
        Crossing { ray: ray / LANES, block, lane: ray % LANES }
    }

    /// Leaves those out that are known already, without a jump.
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn leave_out_known<T: Kept>(&mut self, blocks: &[Block], piles: &mut Piles<T>) {
        let mut kept = 0;
        for index in 0..self.len.min(ROOM) {
            let Crossing { ray, block, lane } = self.get(index);
            let (from_rays, from_blocks) = (self.rays[index], self.blocks[index]);
            (self.rays[kept % ROOM], self.blocks[kept % ROOM]) = (from_rays, from_blocks);
            kept += usize::from(piles.is_new(ray, blocks[block].index(lane)));
        }
        self.len = kept;
    }
}

/// Where the lines of four rays cross a triangle each: a lane of a block.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn located_four(crossings: [(&BlockRay, &Block, usize); 4]) -> Located<Four> {
    let [a, b, c, d] = crossings.map(|(ray, ..)| ray);
    let [x, y, z, _] =
        columns([a.origin_avx2(), b.origin_avx2(), c.origin_avx2(), d.origin_avx2()]);
    let origin = [x, y, z];
    let [slope_x, slope_y, t_per_z] =
        precise_columns([a.precise_avx2(), b.precise_avx2(), c.precise_avx2(), d.precise_avx2()]);
    let corners = by_axis!(|corner| {
        let way = by_axis!(|axis| {
            let [a, b, c, d] = &crossings;
            let four = _mm_setr_ps(
                coordinate(a, corner, axis),
                coordinate(b, corner, axis),
                coordinate(c, corner, axis),
                coordinate(d, corner, axis),
            );
            Four(_mm256_cvtps_pd(four)) - Four(_mm256_cvtps_pd(origin[axis]))
        });
        precisely_sheared(way, &[slope_x, slope_y])
    });
    located(corners, t_per_z)
}

/// A coordinate of a corner, by the place of its axis in ray space.
#[inline(always)]
fn coordinate((ray, block, lane): &(&BlockRay, &Block, usize), corner: usize, place: usize) -> f32 {
    // SAFETY: a row is eight lanes.
    unsafe { *ray.row(block, corner, place).add(lane & (LANES - 1)) }
}

/// Columns of four rows.
#[inline]
#[target_feature(enable = "avx2")]
fn columns([a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
    let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
    let (high_ab, high_cd) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
    [
        _mm_movelh_ps(ab, cd),
        _mm_movehl_ps(cd, ab),
        _mm_movelh_ps(high_ab, high_cd),
        _mm_movehl_ps(high_cd, high_ab),
    ]
}

/// The first three columns of four rows.
#[inline]
#[target_feature(enable = "avx2")]
fn precise_columns([a, b, c, d]: [__m256d; 4]) -> [Four; 3] {
    let (low_ab, low_cd) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
    let (high_ab, high_cd) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
    [
        Four(_mm256_permute2f128_pd::<0x20>(low_ab, low_cd)),
        Four(_mm256_permute2f128_pd::<0x20>(high_ab, high_cd)),
        Four(_mm256_permute2f128_pd::<0x31>(low_ab, low_cd)),
    ]
}
