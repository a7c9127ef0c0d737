//! Where a ray hits several triangles of a block, of which four are looked at together.

use std::arch::x86_64::*;

use super::block::Block;
use super::block_ray::BlockRay;
use super::located::{Located, located, precisely_sheared};
use super::prepare::lesser;
use super::sifted::lanes;
use super::simd::Simd;
use super::traverse::Visitor;
use super::vector::{Four, Precise, by_axis};
use super::walk::test_lanes;
use crate::geometry::{Hit, Ray};

/// [`test_lanes`] where the first hit is wanted, four of them together.
///
/// Most of the time the least `t` of four is all there is to see. Working out four takes about as long as one,
/// and less than bounds of `t` that tell which one it is.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
pub(super) unsafe fn first_of<S: Simd<Shear = BlockRay>, V: Visitor>(
    simd: S,
    block: &Block,
    [maybe, surely]: [u32; 2],
    (ray, block_ray): (&Ray, &BlockRay),
    until: f32,
    visitor: &mut V,
) -> f32 {
    // SAFETY: the same.
    let Some((four, [t, u, v])) = (unsafe { located_four(block, block_ray, maybe & surely) })
    else {
        return simd.test_lanes(block, [maybe, surely], (ray, block_ray), until, visitor);
    };
    // SAFETY: the same.
    let (until, left) = unsafe {
        let [t, u, v] = [_mm256_cvtpd_ps(t.0), _mm256_cvtpd_ps(u.0), _mm256_cvtpd_ps(v.0)];
        let least = _mm_min_ps(t, _mm_shuffle_ps::<0b10_11_00_01>(t, t));
        let least = _mm_min_ps(least, _mm_shuffle_ps::<0b01_00_11_10>(least, least));
        let place = (_mm_movemask_ps(_mm_cmpeq_ps(t, least)) as u32).trailing_zeros() & 3;
        let at = _mm_cvtsi32_si128(place as i32);
        let hit = Hit {
            t: _mm_cvtss_f32(_mm_permutevar_ps(t, at)),
            triangle: block.index(usize::from(four.lanes[place as usize])),
            u: _mm_cvtss_f32(_mm_permutevar_ps(u, at)),
            v: _mm_cvtss_f32(_mm_permutevar_ps(v, at)),
        };
        let until = lesser(until, visitor.hit(hit));
        let left = _mm_movemask_ps(_mm_cmple_ps(t, _mm_set1_ps(until))) as u32;
        (until, left & u32::from(four.once) & !(1 << place))
    };
    let others = maybe & !surely | u32::from(four.beyond);
    if left | others == 0 {
        return until;
    }
    let others = others | four.lanes_of(left);
    simd.test_lanes(block, [others, surely], (ray, block_ray), until, visitor)
}

/// [`test_lanes`], four of them together.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
pub(super) unsafe fn all_of<S: Simd<Shear = BlockRay>, V: Visitor>(
    simd: S,
    block: &Block,
    [maybe, surely]: [u32; 2],
    (ray, block_ray): (&Ray, &BlockRay),
    mut until: f32,
    visitor: &mut V,
) -> f32 {
    let mut others = maybe;
    // SAFETY: the same.
    if let Some((four, [t, u, v])) = unsafe { located_four(block, block_ray, maybe & surely) } {
        let [t, u, v] = [t.rounded(), u.rounded(), v.rounded()];
        for place in lanes(u32::from(four.once)) {
            let place = place & 3;
            let triangle = block.index(usize::from(four.lanes[place]));
            if !visitor.knows(triangle) {
                let hit = Hit { t: t[place], triangle, u: u[place], v: v[place] };
                until = lesser(until, visitor.hit(hit));
            }
        }
        others = maybe & !surely | u32::from(four.beyond);
        if others == 0 {
            return until;
        }
    }
    test_lanes(simd, block, [others, surely], (ray, block_ray), until, visitor)
}

/// The first four of the lanes of a mask, and where the line of a ray crosses them: `t`, `u` and `v`. `None` if
/// that is not known of each, or if there is none.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn located_four(
    block: &Block,
    ray: &BlockRay,
    mask: u32,
) -> Option<(&'static FirstFour, [Four; 3])> {
    let four = &FIRST_FOUR[mask as usize & 255];
    // SAFETY: the same; there are four lanes, and rows are eight, aligned like the block.
    unsafe {
        let lanes = _mm_cvtepu8_epi32(_mm_loadu_si32(four.lanes.as_ptr().cast()));
        let lanes = _mm256_castsi128_si256(lanes);
        let origin = by_axis!(|axis| Four(_mm256_cvtps_pd(_mm_set1_ps(ray.origin[axis]))));
        let [slope_x, slope_y, t_per_z] = by_axis!(|at| Four(_mm256_set1_pd(ray.precise[at])));
        let corners = by_axis!(|corner| {
            let way = by_axis!(|axis| {
                let row = _mm256_load_ps(ray.row(block, corner, axis));
                let row = _mm256_castps256_ps128(_mm256_permutevar8x32_ps(row, lanes));
                Four(_mm256_cvtps_pd(row)) - origin[axis]
            });
            precisely_sheared(way, &[slope_x, slope_y])
        });
        let Located { known, t, u, v } = located(corners, t_per_z);
        (mask != 0 && known == 0b1111).then_some((four, [t, u, v]))
    }
}

/// The first four lanes of a mask.
#[repr(align(8))]
#[derive(Clone, Copy)]
struct FirstFour {
    /// Where there are fewer, the first comes again.
    lanes: [u8; 4],
    /// By place, which of these have not come before, a bit each.
    once: u8,
    /// The other lanes of the mask.
    beyond: u8,
}

impl FirstFour {
    /// The lanes at some places.
    #[cold]
    fn lanes_of(&self, places: u32) -> u32 {
        lanes(places).map(|place| 1 << self.lanes[place & 3]).sum()
    }
}

/// By mask. Of none it is the first lane, whatever is there.
static FIRST_FOUR: [FirstFour; 256] = {
    let mut all = [FirstFour { lanes: [0; 4], once: 0, beyond: 0 }; 256];
    let mut mask = 1;
    while mask < 256 {
        let (mut rest, mut count) = (mask as u8, 0);
        while count < 4 {
            let lane = if rest == 0 { mask as u8 } else { rest }.trailing_zeros();
            all[mask].lanes[count] = lane as u8;
            all[mask].once |= ((rest != 0) as u8) << count;
            rest &= rest.wrapping_sub(1);
            count += 1;
        }
        all[mask].beyond = rest;
        mask += 1;
    }
    all
};
