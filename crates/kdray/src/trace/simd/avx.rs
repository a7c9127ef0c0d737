//! Eight boxes and triangles at once, with AVX2 or AVX-512.

use super::{HasAvx2, HasAvx512, Simd};
use crate::geometry::{Hit, Ray};
use crate::trace::block::Block;
use crate::trace::block_ray::BlockRay;
use crate::trace::hull::Hull;
use crate::trace::opaque::opaque;
use crate::trace::several::{all_of, first_of};
use crate::trace::sifted::{Sifted, Wants};
use crate::trace::stack::Stack;
use crate::trace::step::{self, Lanes, Ready};
use crate::trace::traverse::{Trip, Visitor, descend};
use crate::trace::walk::{test_blocks, test_lanes};
use crate::trace::wide::{Child, Wide};

/// For processors with AVX2.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Avx2 {
    /// That the processor has it.
    _proof: HasAvx2,
}

/// For processors with AVX-512: the same on as many lanes, with twice the registers.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Avx512 {
    /// That the processor has it.
    _proof: HasAvx512,
}

/// What both have, with the steps of each.
///
/// The numbers of a ray that are read one by one the compiler would read as vectors across what was written
/// to memory one by one a moment ago, and wait for it: so it does not see that they are in a row.
macro_rules! simd {
    ($simd:ident, $proof:ident, $features:literal, $nearest:ident, $push:ident) => {
        impl From<$proof> for $simd {
            #[inline(always)]
            fn from(proof: $proof) -> Self {
                Self { _proof: proof }
            }
        }

        impl Simd for $simd {
            type Slabs = Lanes;
            type Ready = Ready;
            type Shear = BlockRay;

            const SHEARS_AHEAD: bool = true;

            #[inline(always)]
            fn is_valid(self, ray: &Ray) -> bool {
                // SAFETY: this exists only where the processor has the instructions. The same below.
                unsafe { step::is_valid(ray) }
            }

            #[inline(always)]
            fn is_beside(self, ray: &Ray, hull: &Hull) -> bool {
                // SAFETY: as above.
                unsafe { hull.is_beside_avx2(ray) }
            }

            #[inline(always)]
            fn slabs(self, ray: &Ray, reach: f32) -> Lanes {
                // SAFETY: as above.
                unsafe { Lanes::new(ray, reach) }
            }

            #[inline(always)]
            fn ready(self, ray: &Ray, reach: f32) -> Ready {
                // SAFETY: as above.
                unsafe { Ready::new(ray, reach) }
            }

            #[inline(always)]
            fn shear(self, ray: &Ray) -> BlockRay {
                // SAFETY: as above.
                unsafe { BlockRay::new(ray) }
            }

            #[inline(always)]
            fn nearest(
                self,
                wide: &Wide,
                slabs: &Lanes,
                interval: [f32; 2],
                stack: &mut Stack,
            ) -> Option<Child> {
                // SAFETY: as above.
                unsafe { step::$nearest(wide, slabs, interval, stack) }
            }

            #[inline(always)]
            fn push(self, wide: &Wide, ready: &Ready, interval: [f32; 2], stack: &mut Stack) {
                // SAFETY: as above.
                unsafe { step::$push(wide, ready, interval, stack) }
            }

            #[inline(always)]
            fn filter(
                self,
                block: &Block,
                shear: &BlockRay,
                interval: [f32; 2],
                wants: Wants,
            ) -> Option<Sifted> {
                // SAFETY: as above.
                unsafe { block.filter_avx2(opaque(shear), interval, wants) }
            }

            #[inline(always)]
            fn hit(
                self,
                block: &Block,
                lane: usize,
                surely: bool,
                (ray, shear): (&Ray, &BlockRay),
            ) -> Option<Hit> {
                block.hit_by(lane, surely, (ray, opaque(shear)))
            }

            #[inline(always)]
            fn several<V: Visitor>(
                self,
                (block, foresees): (&Block, bool),
                lanes: [u32; 2],
                ray: (&Ray, &BlockRay),
                until: f32,
                visitor: &mut V,
            ) -> f32 {
                if V::WANTS != Wants::First {
                    return self.test_lanes(block, lanes, ray, until, visitor);
                }
                // Rows that were kept from the filter would be written to memory and read again.
                let (block, ray) = ((opaque(block), foresees), (ray.0, opaque(ray.1)));
                // SAFETY: as above.
                unsafe { first_of(self, block, lanes, ray, until, visitor) }
            }

            #[inline(always)]
            fn descend<V: Visitor>(self, trip: &Trip, ray: &Ray, visitor: &mut V) {
                #[inline(never)]
                #[target_feature(enable = $features)]
                fn apart<V: Visitor>(simd: $simd, trip: &Trip, ray: &Ray, visitor: &mut V) {
                    descend(simd, trip, ray, visitor);
                }
                // SAFETY: as above.
                unsafe { apart(self, trip, ray, visitor) }
            }

            #[inline(always)]
            fn test_blocks<V: Visitor>(
                self,
                blocks: &[Block],
                ray: (&Ray, &BlockRay),
                until: f32,
                visitor: &mut V,
            ) -> f32 {
                #[inline(never)]
                #[target_feature(enable = $features)]
                fn apart<V: Visitor>(
                    simd: $simd,
                    blocks: &[Block],
                    ray: (&Ray, &BlockRay),
                    until: f32,
                    visitor: &mut V,
                ) -> f32 {
                    test_blocks(simd, blocks, ray, until, visitor)
                }
                // SAFETY: as above.
                unsafe { apart(self, blocks, ray, until, visitor) }
            }

            #[inline(always)]
            fn test_lanes<V: Visitor>(
                self,
                block: &Block,
                lanes: [u32; 2],
                ray: (&Ray, &BlockRay),
                until: f32,
                visitor: &mut V,
            ) -> f32 {
                #[inline(never)]
                #[target_feature(enable = $features)]
                fn apart<V: Visitor>(
                    simd: $simd,
                    block: &Block,
                    lanes: [u32; 2],
                    ray: (&Ray, &BlockRay),
                    until: f32,
                    visitor: &mut V,
                ) -> f32 {
                    if V::WANTS == Wants::All {
                        // SAFETY: as above.
                        return unsafe { all_of(simd, block, lanes, ray, until, visitor) };
                    }
                    test_lanes(simd, block, lanes, ray, until, visitor)
                }
                // SAFETY: as above.
                unsafe { apart(self, block, lanes, ray, until, visitor) }
            }
        }
    };
}

simd!(Avx2, HasAvx2, "avx2,fma,bmi1,lzcnt,popcnt", nearest_avx2, push_avx2);
simd!(
    Avx512,
    HasAvx512,
    "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,lzcnt,popcnt",
    nearest_avx512,
    push_avx512
);
