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
    #[cfg(target_arch = "aarch64")]
    Neon(Neon),
}

/// For processors with NEON: exists only there.
#[cfg(target_arch = "aarch64")]
#[derive(Clone, Copy)]
pub(super) struct Neon(());

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
        // The compiler knows that it has, where it may use it anyway.
        #[cfg(target_arch = "aarch64")]
        if std::arch::is_aarch64_feature_detected!("neon") {
            return Self::Neon(Neon(()));
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
            #[cfg(target_arch = "aarch64")]
            Self::Neon(_) => "neon",
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::noise::noise;

    /// Filters blocks: what is said of a lane is true of its hit. Gives how many lanes may be hit,
    /// and a hash of everything that was said.
    fn filters_what_is_hit(simd: impl Simd) -> (u32, u32) {
        let mut state = 5;
        let (mut maybes, mut hash) = (0, 0_u32);
        for round in 0..20_000 {
            // Up to the ends of what a mesh has, and rays from beyond.
            let size = [1.0, 1.0, 100.0, 4e9, 2e-10][round % 5];
            let far = [1.0, 1.0, 1e3, 1e12, 1e27][round % 11 % 5];
            let mut point = |size: f32| [(); 3].map(|()| size * (noise(&mut state) - 0.5));
            let origin = point(far * size);
            let corners = [(); 8].map(|()| [point(size), point(size), point(0.1 * size)]);
            let block = Block::new(&[0, 1, 2, 3, 4, 5, 6, 7], true, |at| corners[at as usize]);
            let direction = if round % 7 == 0 { [0.0, 1.0, 0.0] } else { point(1.0) };
            let (t_min, t_max) = (size * noise(&mut state), 2.0 * size * noise(&mut state));
            let ray = Ray { origin, direction, t_min, t_max };
            let shear = simd.shear(&ray);
            let said = simd.filter(&block, &shear, [t_min, t_max]);
            for lane in 0..8 {
                let [maybe, surely, inside] =
                    [said.maybe, said.surely, said.inside].map(|bits| bits >> lane & 1 == 1);
                let hit = block.hit(lane, false, shear.as_ref());
                let is_inside = hit.is_some_and(|hit| t_min <= hit.t && hit.t <= t_max);
                let case = format!("lane {lane}: {hit:?} of {ray:?} and {:?}", corners[lane]);
                assert!(maybe || !is_inside, "{case}");
                assert!(hit.is_some() || !(maybe && surely), "{case}");
                assert!(is_inside || !(maybe && inside), "{case}");
                assert!(
                    !is_inside || said.earliest[lane] <= hit.map_or(0.0, |hit| hit.t),
                    "{case}"
                );
                // Where no lane may be hit, nothing is said of when.
                let early = if maybe { said.earliest[lane].to_bits() } else { 0 };
                hash = hash.wrapping_mul(0x0100_0193) ^ early;
            }
            maybes += said.maybe.count_ones();
            for bits in [said.maybe, said.surely, said.inside] {
                hash = hash.wrapping_mul(0x0100_0193) ^ (bits & said.maybe);
            }
        }
        (maybes, hash)
    }

    #[test]
    fn filters_say_what_is_so_and_the_same_on_every_processor() {
        filters_what_is_hit(Plain);
        let said = match Best::detect() {
            #[cfg(target_arch = "x86_64")]
            Best::Avx2(proof) => filters_what_is_hit(Avx2::<()>::from(proof)),
            #[cfg(target_arch = "x86_64")]
            Best::Avx512(proof) => filters_what_is_hit(Avx2::<()>::from(proof.avx2())),
            #[cfg(target_arch = "aarch64")]
            Best::Neon(neon) => filters_what_is_hit(neon),
            Best::Plain => return println!("this processor has no fast path: none was tested"),
        };
        // What AVX2 says.
        assert_eq!(said, (29_663, 2_208_235_696));
    }
}
