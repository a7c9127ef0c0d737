//! Eight boxes and triangles at once, with AVX2 or AVX-512.

use std::marker::PhantomData;

use super::{HasAvx2, HasAvx512, Simd};
use crate::geometry::{Hit, Ray};
use crate::trace::block::{Block, Filtered};
use crate::trace::block_ray::BlockRay;
use crate::trace::stack::Stack;
use crate::trace::step::{self, Lanes};
use crate::trace::wide::{Child, Wide};

/// For processors with AVX2. `V` is what a traversal is for: each has functions of its own, so that
/// the compiler makes them part of its loop.
pub(in crate::trace) struct Avx2<V> {
    /// That the processor has it.
    _proof: HasAvx2,
    purpose: PhantomData<V>,
}

/// For processors with AVX-512: the same on as many lanes, with twice the registers.
pub(in crate::trace) struct Avx512<V> {
    /// That the processor has it.
    _proof: HasAvx512,
    purpose: PhantomData<V>,
}

/// What both have, with the steps of each.
macro_rules! simd {
    ($simd:ident, $proof:ident, $nearest:ident, $push:ident) => {
        impl<V> From<$proof> for $simd<V> {
            #[inline(always)]
            fn from(proof: $proof) -> Self {
                Self { _proof: proof, purpose: PhantomData }
            }
        }

        impl<V> Clone for $simd<V> {
            #[inline(always)]
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<V> Copy for $simd<V> {}

        impl<V> Simd for $simd<V> {
            type Slabs = Lanes;
            type Shear = BlockRay;

            #[inline(always)]
            fn slabs(self, ray: &Ray, reach: f32) -> Lanes {
                // SAFETY: this exists only where the processor has the instructions. The same below.
                unsafe { Lanes::new(ray, reach) }
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
                unsafe { step::$nearest::<Self>(wide, slabs, interval, stack) }
            }

            #[inline(always)]
            fn push(self, wide: &Wide, slabs: &Lanes, interval: [f32; 2], stack: &mut Stack) {
                // SAFETY: as above.
                unsafe { step::$push::<Self>(wide, slabs, interval, stack) }
            }

            #[inline(always)]
            fn filter<P>(
                self,
                block: &Block,
                shear: &BlockRay,
                interval: [f32; 2],
                whether: bool,
            ) -> Option<Filtered> {
                // SAFETY: as above.
                unsafe { block.filter_avx2::<(Self, P)>(shear, interval, whether) }
            }

            #[inline(always)]
            fn next(self, filtered: &mut Filtered, until: f32) -> Option<usize> {
                // SAFETY: as above.
                unsafe { filtered.next_avx2::<Self>(until) }
            }

            #[inline(always)]
            fn hit(
                self,
                block: &Block,
                lane: usize,
                filtered: &Filtered,
                (ray, _): (&Ray, &BlockRay),
            ) -> Option<Hit> {
                filtered.hit(block, lane, ray)
            }
        }
    };
}

simd!(Avx2, HasAvx2, nearest_avx2, push_avx2);
simd!(Avx512, HasAvx512, nearest_avx512, push_avx512);
