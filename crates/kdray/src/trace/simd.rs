//! The arithmetic of a traversal, one triangle and box after the other or eight at once, and what
//! the processor has for it.

#[cfg(target_arch = "x86_64")]
use std::marker::PhantomData;

use super::block::{Block, Filtered};
use super::prepare::{Shear, Slabs};
use super::stack::Stack;
use super::step;
use super::wide::{Child, Wide};
use crate::geometry::Ray;

/// How a ray is made ready, steps down and meets triangles. All ways lead to the same hits.
pub(super) trait Simd: Copy {
    /// A ray ready for boxes.
    type Slabs;
    /// A ray ready for triangles.
    type Shear: AsRef<Shear>;

    fn slabs(self, ray: &Ray, reach: f32) -> Self::Slabs;

    fn shear(self, ray: &Ray) -> Self::Shear;

    /// The nearest child that is met in the interval; the others go on the stack.
    fn nearest(
        self,
        wide: &Wide,
        slabs: &Self::Slabs,
        interval: [f32; 2],
        stack: &mut Stack,
    ) -> Option<Child>;

    /// Puts the children that are met in the interval on the stack, the nearest on top.
    fn push(self, wide: &Wide, slabs: &Self::Slabs, interval: [f32; 2], stack: &mut Stack);

    /// The triangles of a block that may be hit in the interval.
    fn filter(self, block: &Block, shear: &Self::Shear, interval: [f32; 2]) -> Filtered;
}

/// For every processor.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl Simd for Plain {
    type Slabs = Slabs;
    type Shear = Shear;

    #[inline(always)]
    fn slabs(self, ray: &Ray, reach: f32) -> Slabs {
        Slabs::new(ray, reach)
    }

    #[inline(always)]
    fn shear(self, ray: &Ray) -> Shear {
        Shear::new(ray)
    }

    #[inline(always)]
    fn nearest(
        self,
        wide: &Wide,
        slabs: &Slabs,
        interval: [f32; 2],
        stack: &mut Stack,
    ) -> Option<Child> {
        step::nearest(wide, slabs.octant(), &step::meet(wide, slabs, interval), stack)
    }

    #[inline(always)]
    fn push(self, wide: &Wide, slabs: &Slabs, interval: [f32; 2], stack: &mut Stack) {
        step::push(wide, slabs.octant(), &step::meet(wide, slabs, interval), stack);
    }

    #[inline(always)]
    fn filter(self, block: &Block, _: &Shear, _: [f32; 2]) -> Filtered {
        block.unknown()
    }
}

/// For processors with AVX2. `V` is what a traversal is for: each has functions of its own, so that
/// the compiler makes them part of its loop.
#[cfg(target_arch = "x86_64")]
pub(super) struct Avx2<V> {
    /// That the processor has it.
    _proof: HasAvx2,
    purpose: PhantomData<V>,
}

/// The best that this processor can do.
#[derive(Clone, Copy)]
pub(super) enum Best {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Avx2(HasAvx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(HasAvx512),
}

/// Exists only where the processor has AVX2 and what came with it.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct HasAvx2(());

/// Exists only where the processor has AVX-512, as far as it is used here, and AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct HasAvx512(HasAvx2);

#[cfg(target_arch = "x86_64")]
impl HasAvx512 {
    #[inline(always)]
    pub(super) fn avx2(self) -> HasAvx2 {
        self.0
    }
}

impl Best {
    /// Asks the processor.
    pub(super) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("fma")
            && std::arch::is_x86_feature_detected!("bmi1")
            && std::arch::is_x86_feature_detected!("lzcnt")
            && std::arch::is_x86_feature_detected!("popcnt")
        {
            let proof = HasAvx2(());
            return if std::arch::is_x86_feature_detected!("avx512f")
                && std::arch::is_x86_feature_detected!("avx512dq")
            {
                Self::Avx512(HasAvx512(proof))
            } else {
                Self::Avx2(proof)
            };
        }
        Self::Plain
    }

    /// The proof that the processor has AVX2, if it has.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn avx2(self) -> Option<HasAvx2> {
        match self {
            Self::Plain => None,
            Self::Avx2(proof) | Self::Avx512(HasAvx512(proof)) => Some(proof),
        }
    }

    /// The proof that the processor has AVX-512, if it has.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn avx512(self) -> Option<HasAvx512> {
        match self {
            Self::Avx512(proof) => Some(proof),
            _ => None,
        }
    }

    /// Its name, for people.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Plain => "none",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => "avx512",
        }
    }
}

#[cfg(target_arch = "x86_64")]
impl<V> From<HasAvx2> for Avx2<V> {
    #[inline(always)]
    fn from(proof: HasAvx2) -> Self {
        Self { _proof: proof, purpose: PhantomData }
    }
}

#[cfg(target_arch = "x86_64")]
impl<V> Clone for Avx2<V> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

#[cfg(target_arch = "x86_64")]
impl<V> Copy for Avx2<V> {}

#[cfg(target_arch = "x86_64")]
impl<V> Simd for Avx2<V> {
    type Slabs = step::Lanes;
    type Shear = super::block::RayLanes;

    #[inline(always)]
    fn slabs(self, ray: &Ray, reach: f32) -> Self::Slabs {
        // SAFETY: this exists only where the processor has AVX2. The same below.
        unsafe { step::Lanes::new(ray, reach) }
    }

    #[inline(always)]
    fn shear(self, ray: &Ray) -> Self::Shear {
        // SAFETY: as above.
        unsafe { super::block::RayLanes::new(ray) }
    }

    #[inline(always)]
    fn nearest(
        self,
        wide: &Wide,
        slabs: &Self::Slabs,
        interval: [f32; 2],
        stack: &mut Stack,
    ) -> Option<Child> {
        // SAFETY: as above.
        unsafe {
            let met = step::meet_avx2::<V>(wide, slabs, interval);
            step::nearest_avx2::<V>(wide, slabs.octant, &met, stack)
        }
    }

    #[inline(always)]
    fn push(self, wide: &Wide, slabs: &Self::Slabs, interval: [f32; 2], stack: &mut Stack) {
        // SAFETY: as above.
        unsafe {
            let met = step::meet_avx2::<V>(wide, slabs, interval);
            step::push_avx2::<V>(wide, slabs.octant, &met, stack);
        }
    }

    #[inline(always)]
    fn filter(self, block: &Block, shear: &Self::Shear, interval: [f32; 2]) -> Filtered {
        // SAFETY: as above.
        unsafe { block.filter_avx2::<V>(shear, interval) }
    }
}
