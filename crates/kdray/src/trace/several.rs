//! Where a ray hits several triangles of a block, of which four are looked at together.

use std::arch::x86_64::*;

use super::block::Block;
use super::block_ray::BlockRay;
use super::located::{Located, located, precisely_sheared};
use super::opaque::opaque;
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
/// and less than bounds of `t` that tell which one it is. Which four they are is [foreseen] if that is asked for.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
pub(super) unsafe fn first_of<S: Simd<Shear = BlockRay>, V: Visitor>(
    simd: S,
    (block, foresees): (&Block, bool),
    [maybe, surely]: [u32; 2],
    (ray, block_ray): (&Ray, &BlockRay),
    until: f32,
    visitor: &mut V,
) -> f32 {
    let mask = maybe & surely;
    let four = if foresees { foreseen(mask) } else { FirstFour::of(mask) };
    // SAFETY: the same.
    let Some([t, u, v]) = (unsafe { located_four(block, block_ray, four) }) else {
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
    let four = FirstFour::of(maybe & surely);
    // SAFETY: the same.
    if let Some([t, u, v]) = unsafe { located_four(block, block_ray, four) } {
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
unsafe fn located_four(block: &Block, ray: &BlockRay, four: &FirstFour) -> Option<[Four; 3]> {
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
        (four.once != 0 && known == 0b1111).then_some([t, u, v])
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
    #[inline(always)]
    fn of(mask: u32) -> &'static Self {
        &FIRST_FOUR[mask as usize & 255]
    }

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

/// The first four lanes of a mask, by a jump.
///
/// A mask is known when all triangles have been tested. A jump is foreseen, where the rays before met the same
/// ones: then these are worked out before that. Read by its mask, they would wait in a row with it, and what
/// comes after them with them: the processor has no more places for what waits.
#[inline(always)]
fn foreseen(mask: u32) -> &'static FirstFour {
    macro_rules! by_mask {
        ($($mask:literal)*) => {
            match mask as u8 {
                // If the compiler saw through this, it would read by the mask.
                $($mask => opaque(&FIRST_FOUR[$mask]),)*
            }
        };
    }
    by_mask! {
        0x00 0x01 0x02 0x03 0x04 0x05 0x06 0x07 0x08 0x09 0x0a 0x0b 0x0c 0x0d 0x0e 0x0f
        0x10 0x11 0x12 0x13 0x14 0x15 0x16 0x17 0x18 0x19 0x1a 0x1b 0x1c 0x1d 0x1e 0x1f
        0x20 0x21 0x22 0x23 0x24 0x25 0x26 0x27 0x28 0x29 0x2a 0x2b 0x2c 0x2d 0x2e 0x2f
        0x30 0x31 0x32 0x33 0x34 0x35 0x36 0x37 0x38 0x39 0x3a 0x3b 0x3c 0x3d 0x3e 0x3f
        0x40 0x41 0x42 0x43 0x44 0x45 0x46 0x47 0x48 0x49 0x4a 0x4b 0x4c 0x4d 0x4e 0x4f
        0x50 0x51 0x52 0x53 0x54 0x55 0x56 0x57 0x58 0x59 0x5a 0x5b 0x5c 0x5d 0x5e 0x5f
        0x60 0x61 0x62 0x63 0x64 0x65 0x66 0x67 0x68 0x69 0x6a 0x6b 0x6c 0x6d 0x6e 0x6f
        0x70 0x71 0x72 0x73 0x74 0x75 0x76 0x77 0x78 0x79 0x7a 0x7b 0x7c 0x7d 0x7e 0x7f
        0x80 0x81 0x82 0x83 0x84 0x85 0x86 0x87 0x88 0x89 0x8a 0x8b 0x8c 0x8d 0x8e 0x8f
        0x90 0x91 0x92 0x93 0x94 0x95 0x96 0x97 0x98 0x99 0x9a 0x9b 0x9c 0x9d 0x9e 0x9f
        0xa0 0xa1 0xa2 0xa3 0xa4 0xa5 0xa6 0xa7 0xa8 0xa9 0xaa 0xab 0xac 0xad 0xae 0xaf
        0xb0 0xb1 0xb2 0xb3 0xb4 0xb5 0xb6 0xb7 0xb8 0xb9 0xba 0xbb 0xbc 0xbd 0xbe 0xbf
        0xc0 0xc1 0xc2 0xc3 0xc4 0xc5 0xc6 0xc7 0xc8 0xc9 0xca 0xcb 0xcc 0xcd 0xce 0xcf
        0xd0 0xd1 0xd2 0xd3 0xd4 0xd5 0xd6 0xd7 0xd8 0xd9 0xda 0xdb 0xdc 0xdd 0xde 0xdf
        0xe0 0xe1 0xe2 0xe3 0xe4 0xe5 0xe6 0xe7 0xe8 0xe9 0xea 0xeb 0xec 0xed 0xee 0xef
        0xf0 0xf1 0xf2 0xf3 0xf4 0xf5 0xf6 0xf7 0xf8 0xf9 0xfa 0xfb 0xfc 0xfd 0xfe 0xff
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mask_has_its_own_lanes() {
        for mask in 0..256 {
            let four = foreseen(mask);
            assert!(std::ptr::eq(four, &raw const FIRST_FOUR[mask as usize]), "{mask}");
            let first: Vec<usize> = lanes(mask).take(4).collect();
            let found: Vec<usize> =
                lanes(u32::from(four.once)).map(|place| usize::from(four.lanes[place])).collect();
            assert_eq!(found, first, "{mask}");
            let beyond: u32 = lanes(mask).skip(4).map(|lane| 1 << lane).sum();
            assert_eq!(u32::from(four.beyond), beyond, "{mask}");
        }
    }
}
