//! The arithmetic of a traversal, one triangle and box after the other or eight at once, and what
//! the processor has for it.

#[cfg(target_arch = "x86_64")]
mod avx;

use super::block::Block;
use super::hull::Hull;
use super::prepare::{Shear, Slabs};
use super::sifted::{Sifted, Wants};
use super::stack::Stack;
use super::step;
use super::traverse::{Trip, Visitor, descend};
use super::walk::{test_blocks, test_lanes};
use super::wide::{Child, Wide};
use crate::geometry::{Hit, Ray};
#[cfg(target_arch = "x86_64")]
pub(super) use avx::{Avx2, Avx512};

/// How a ray is made ready, steps down and meets triangles. All ways lead to the same hits.
pub(super) trait Simd: Copy {
    /// A ray ready for boxes.
    type Slabs;
    /// The same, of one among many.
    type Ready;
    /// A ray ready for triangles.
    type Shear;

    /// Whether a ray is made ready for triangles long before its first leaf, which would wait for it otherwise.
    /// Where that takes many instructions, only rays that reach a leaf are.
    const SHEARS_AHEAD: bool = false;

    /// [`Ray::is_valid`].
    #[inline(always)]
    fn is_valid(self, ray: &Ray) -> bool {
        ray.is_valid()
    }

    /// [`Hull::is_beside`].
    #[inline(always)]
    fn is_beside(self, ray: &Ray, hull: &Hull) -> bool {
        hull.is_beside(ray)
    }

    fn slabs(self, ray: &Ray, reach: f32) -> Self::Slabs;

    fn ready(self, ray: &Ray, reach: f32) -> Self::Ready;

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
    fn push(self, wide: &Wide, ready: &Self::Ready, interval: [f32; 2], stack: &mut Stack);

    /// The triangles of a block that may be hit in the interval, if any may.
    fn filter(
        self,
        block: &Block,
        shear: &Self::Shear,
        interval: [f32; 2],
        wants: Wants,
    ) -> Option<Sifted>;

    /// The hit in a lane, at any `t`, if there is one. `surely` says that the line crosses its triangle.
    fn hit(
        self,
        block: &Block,
        lane: usize,
        surely: bool,
        ray: (&Ray, &Self::Shear),
    ) -> Option<Hit>;

    /// [`test_lanes`] where there are several. Where the first hit is wanted, others need not be shown.
    ///
    /// The block comes with whether it is foreseen which they are, as for a single ray. One that takes turns with
    /// others would lose by it.
    #[inline(always)]
    fn several<V: Visitor>(
        self,
        (block, _): (&Block, bool),
        lanes: [u32; 2],
        ray: (&Ray, &Self::Shear),
        until: f32,
        visitor: &mut V,
    ) -> f32 {
        self.test_lanes(block, lanes, ray, until, visitor)
    }

    /// [`descend`] in a function of its own.
    #[inline(never)]
    fn descend<V: Visitor>(self, trip: &Trip, ray: &Ray, visitor: &mut V) {
        descend(self, trip, ray, visitor);
    }

    /// [`test_blocks`] in a function of its own, which may need to be told its instructions.
    #[inline(never)]
    fn test_blocks<V: Visitor>(
        self,
        blocks: &[Block],
        ray: (&Ray, &Self::Shear),
        until: f32,
        visitor: &mut V,
    ) -> f32 {
        test_blocks(self, blocks, ray, until, visitor)
    }

    /// [`test_lanes`] in a function of its own.
    #[inline(never)]
    fn test_lanes<V: Visitor>(
        self,
        block: &Block,
        lanes: [u32; 2],
        ray: (&Ray, &Self::Shear),
        until: f32,
        visitor: &mut V,
    ) -> f32 {
        test_lanes(self, block, lanes, ray, until, visitor)
    }
}

/// For every processor.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl Simd for Plain {
    type Slabs = Slabs;
    type Ready = Slabs;
    type Shear = Shear;

    #[inline(always)]
    fn slabs(self, ray: &Ray, reach: f32) -> Slabs {
        Slabs::new(ray, reach)
    }

    #[inline(always)]
    fn ready(self, ray: &Ray, reach: f32) -> Slabs {
        self.slabs(ray, reach)
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
    fn push(self, wide: &Wide, ready: &Slabs, interval: [f32; 2], stack: &mut Stack) {
        step::push(wide, ready.octant(), &step::meet(wide, ready, interval), stack);
    }

    #[inline(always)]
    fn filter(self, block: &Block, _: &Shear, _: [f32; 2], _: Wants) -> Option<Sifted> {
        Some(block.unknown())
    }

    #[inline(always)]
    fn hit(
        self,
        block: &Block,
        lane: usize,
        surely: bool,
        (_, shear): (&Ray, &Shear),
    ) -> Option<Hit> {
        block.hit(lane, surely, shear)
    }
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
                && std::arch::is_x86_feature_detected!("avx512vl")
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

    /// All ways of this processor, the best first.
    #[cfg(test)]
    pub(super) fn each() -> Vec<Self> {
        match Self::detect() {
            Self::Plain => vec![Self::Plain],
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(proof) => vec![Self::Avx512(proof), Self::Avx2(proof.avx2()), Self::Plain],
            other => vec![other, Self::Plain],
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::noise::noise;
    use crate::trace::sifted::Sifted;

    /// Filters blocks: what is said of a lane is true of its hit. Gives how many lanes may be hit, and a hash of
    /// everything that was said.
    fn filters_what_is_hit(simd: impl Simd, wants: Wants) -> [u32; 2] {
        let mut state = 5;
        let [mut maybes, mut hash] = [0, 0_u32];
        for round in 0..20_000 {
            // Up to the ends of what a mesh has, and rays from beyond.
            let size = [1.0, 1.0, 100.0, 4e9, 2e-10][round % 5];
            let far = [1.0, 1.0, 1e3, 1e12, 1e27][round % 11 % 5];
            let mut point = |size: f32| [(); 3].map(|()| size * (noise(&mut state) - 0.5));
            let origin = point(far * size);
            let corners = [(); 8].map(|()| [point(size), point(size), point(0.1 * size)]);
            let used = 8 - round % 3;
            let block =
                Block::new(&[0, 1, 2, 3, 4, 5, 6, 7][..used], true, |at| corners[at as usize]);
            let direction = if round % 7 == 0 { [0.0, 1.0, 0.0] } else { point(1.0) };
            let (t_min, t_max) = (size * noise(&mut state), 2.0 * size * noise(&mut state));
            let t_max = if round % 2 == 0 { t_max } else { f32::INFINITY };
            let ray = Ray { origin, direction, t_min, t_max };
            let shear = simd.shear(&ray);
            let nothing = Sifted { maybe: 0, surely: 0, inside: 0 };
            let said = simd.filter(&block, &shear, [t_min, t_max], wants).unwrap_or(nothing);
            for lane in 0..8 {
                let [maybe, surely, inside] =
                    [said.maybe, said.surely, said.inside].map(|bits| bits >> lane & 1 == 1);
                let hit = block.hit(lane, false, &Shear::new(&ray)).filter(|_| lane < used);
                let is_inside = hit.is_some_and(|hit| t_min <= hit.t && hit.t <= t_max);
                let case = format!("lane {lane}: {hit:?} of {ray:?} and {:?}", corners[lane]);
                assert!(maybe || !is_inside, "{case}");
                assert!(hit.is_some() || !(maybe && surely), "{case}");
                assert!(is_inside || !(maybe && inside), "{case}");
                if maybe {
                    let found = simd.hit(&block, lane, surely, (&ray, &shear));
                    let found = found.filter(|_| lane < used);
                    assert_eq!(found, hit, "{case}");
                    let bits = found.map_or(0, |hit| hit.t.to_bits() ^ hit.u.to_bits());
                    hash = hash.wrapping_mul(0x0100_0193) ^ bits;
                }
            }
            maybes += said.maybe.count_ones();
            for bits in [said.maybe, said.surely, said.inside] {
                hash = hash.wrapping_mul(0x0100_0193) ^ (bits & said.maybe);
            }
        }
        [maybes, hash]
    }

    #[test]
    fn filters_say_what_is_so_and_the_same_on_every_processor() {
        for wants in [Wants::All, Wants::First, Wants::Whether] {
            filters_what_is_hit(Plain, wants);
            #[cfg(target_arch = "x86_64")]
            for said in [
                Best::detect().avx2().map(|it| filters_what_is_hit(Avx2::from(it), wants)),
                Best::detect().avx512().map(|it| filters_what_is_hit(Avx512::from(it), wants)),
            ] {
                match said {
                    Some(said) => assert_eq!(said, SAID[wants as usize]),
                    None => println!("this processor has not all of AVX2 and AVX-512"),
                }
            }
            #[cfg(target_arch = "aarch64")]
            if let Best::Neon(neon) = Best::detect() {
                filters_what_is_hit(neon, wants);
            }
        }
    }

    /// What the first processor said, in the order of what is wanted.
    #[cfg(target_arch = "x86_64")]
    const SAID: [[u32; 2]; 3] =
        [[26_236, 3_464_674_724], [26_236, 3_464_674_724], [26_162, 899_333_319]];
}
