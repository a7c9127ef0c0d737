//! Eight or sixteen rays at a time that go the same way.
//!
//! Camera rays, and shadow rays to a distant light, visit much the same nodes. A packet steps down
//! once for all of them, by bounds of what its rays do; then each box it comes to is tested by
//! all rays at once, and so is each triangle of a leaf. Where few of the rays are left, they go on
//! one by one.

mod boxes;
mod triangles;

use super::block::Block;
use super::fullness::Fullness;
use super::prepare::{Shear, lesser};
use super::sifted::{Wants, lanes};
use super::simd::{Avx2, HasAvx2, HasAvx512};
use super::stack::Stack;
use super::traverse::{ENOUGH, Trip, Visitor};
use super::vector::{Eight, Numbers, Sixteen, Vector};
use super::walk::visit_below;
use super::wide::Child;
use crate::geometry::{Hit, Ray};
use boxes::Boxes;
use triangles::{Triangles, Where};

/// Below so many rays each goes on alone.
const FEW: u32 = 3;

/// Rays on their way together.
struct Packet<'a, L: Vector> {
    simd: Avx2,
    trip: &'a Trip,
    rays: &'a [Ray],
    lanes: &'a Rays<L>,
    boxes: &'a Boxes<L>,
    proof: L::Proof,
    until: Numbers,
}

/// Shows each of eight visitors what its ray comes to, and gives how full the packet was; shows nothing
/// where the rays do not go the same way. Rays without a visitor stay away.
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn traverse_avx2<V: Visitor>(
    proof: HasAvx2,
    trip: &Trip,
    rays: &[Ray],
    visitors: &mut [Option<V>],
) -> Option<Fullness> {
    traverse::<V, Eight>((proof, proof), trip, rays, visitors)
}

/// The same for sixteen.
#[target_feature(enable = "avx512f,avx512dq,avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn traverse_avx512<V: Visitor>(
    proof: HasAvx512,
    trip: &Trip,
    rays: &[Ray],
    visitors: &mut [Option<V>],
) -> Option<Fullness> {
    traverse::<V, Sixteen>((proof.avx2(), proof), trip, rays, visitors)
}

#[inline(always)]
fn traverse<V: Visitor, L: Vector>(
    (avx2, proof): (HasAvx2, L::Proof),
    trip: &Trip,
    rays: &[Ray],
    visitors: &mut [Option<V>],
) -> Option<Fullness> {
    let lanes = Rays::<L>::new(proof, rays);
    let boxes = Boxes::new(&lanes, trip.hull.reach, avx2)?;
    let mut until = lanes.t_max.numbers();
    for (until, visitor) in until.0.iter_mut().zip(visitors.iter()) {
        *until = if visitor.is_some() { *until } else { ENOUGH };
    }
    let (lanes, boxes) = (&lanes, &boxes);
    let mut packet = Packet { simd: avx2.into(), trip, rays, lanes, boxes, proof, until };
    Some(packet.traverse(visitors))
}

/// Rays, one a lane.
struct Rays<L> {
    origin: [L; 3],
    t_min: L,
    direction: [L; 3],
    t_max: L,
}

impl<L: Vector> Rays<L> {
    #[inline(always)]
    fn new(proof: L::Proof, rays: &[Ray]) -> Self {
        let [ox, oy, oz, t_min, dx, dy, dz, t_max] = L::of_rays(proof, rays);
        Self { origin: [ox, oy, oz], t_min, direction: [dx, dy, dz], t_max }
    }
}

impl<L: Vector> Packet<'_, L> {
    #[inline(always)]
    fn traverse<V: Visitor>(&mut self, visitors: &mut [Option<V>]) -> Fullness {
        let wides = &self.trip.layout.wides[..];
        let (mut stack, mut child, mut mask) = (Stack::new(), Child(0), (1_u32 << L::LANES) - 1);
        let mut last = self.last();
        // Made when the first leaf is reached: many packets reach none.
        let mut triangles = None;
        let (mut rays, mut room) = (0, 0);
        loop {
            rays += mask.count_ones() as usize;
            room += L::LANES;
            if mask.count_ones() < FEW {
                self.go_on_alone(child, mask, visitors);
                last = self.last();
            } else if let Some(first) = child.block() {
                let triangles = triangles.get_or_insert_with(|| self.triangles());
                let leaf = (&self.trip.layout.blocks[first..], child.is_one());
                self.test_leaf(leaf, triangles, mask, visitors);
                last = self.last();
            } else {
                // SAFETY: there is a vector, so the processor has AVX2.
                unsafe { self.boxes.push(&wides[child.0 as usize], child, last, &mut stack) };
            }
            let until = L::of_numbers(self.proof, &self.until);
            (child, mask) = loop {
                let Some(place) = stack.pop(last) else {
                    return Fullness { rays, room };
                };
                let (wide, place) = (&wides[place.0 as usize / 8], place.0 as usize % 8);
                let mask = self.boxes.meet(wide, place, until);
                if mask != 0 {
                    break (wide.children[place], mask);
                }
            };
        }
    }

    /// Up to where some ray has more to see.
    #[inline(always)]
    fn last(&self) -> f32 {
        L::of_numbers(self.proof, &self.until).greatest()
    }

    #[inline(always)]
    fn triangles(&self) -> Triangles<L> {
        Triangles::new(self.lanes, Shear::axes(&self.rays[0].direction))
    }

    /// Shows what is below `child` to the rays of `mask`, one after the other.
    #[inline(always)]
    fn go_on_alone<V: Visitor>(&mut self, child: Child, mask: u32, visitors: &mut [Option<V>]) {
        let Trip { layout, hull, .. } = self.trip;
        for lane in lanes(mask) {
            let Some(visitor) = &mut visitors[lane] else { continue };
            let until = &mut self.until.0[lane];
            let (ray, place) = ((&self.rays[lane], hull.reach), (child, *until));
            *until = visit_below(self.simd, layout, ray, place, visitor);
        }
    }

    /// Shows the triangles of a leaf to the rays of `mask`.
    #[inline(always)]
    fn test_leaf<V: Visitor>(
        &mut self,
        (blocks, is_one): (&[Block], bool),
        triangles: &Triangles<L>,
        mask: u32,
        visitors: &mut [Option<V>],
    ) {
        for block in blocks {
            for place in block.places() {
                self.test_triangle((block, place), triangles, mask, visitors);
            }
            if is_one || block.is_last() {
                break;
            }
        }
    }

    #[inline(always)]
    fn test_triangle<V: Visitor>(
        &mut self,
        (block, place): (&Block, usize),
        triangles: &Triangles<L>,
        mask: u32,
        visitors: &mut [Option<V>],
    ) {
        let until = L::of_numbers(self.proof, &self.until);
        let sifted = triangles.sift(block, place, until);
        let index = block.index(place);
        if V::WANTS == Wants::Whether {
            for lane in lanes(sifted.inside & mask) {
                let Some(visitor) = &mut visitors[lane] else { continue };
                self.until.0[lane] = visitor.inside(index);
            }
        }
        let news = |lane: &usize| {
            self.until.0[*lane] != ENOUGH
                && visitors[*lane].as_ref().is_some_and(|visitor| !visitor.knows(index))
        };
        let maybe = lanes(sifted.maybe & mask).filter(news).fold(0, |all, lane| all | 1 << lane);
        if maybe != 0 {
            let located = triangles.locate(block, place);
            self.show_hits((block, place), &located, (maybe, sifted.surely), visitors);
        }
    }

    /// Shows the hits of a triangle to the rays of a mask that may hit it; some do so for certain.
    #[inline(always)]
    fn show_hits<V: Visitor>(
        &mut self,
        (block, place): (&Block, usize),
        located: &Where,
        (maybe, surely): (u32, u32),
        visitors: &mut [Option<V>],
    ) {
        for lane in lanes(maybe) {
            let Some(visitor) = &mut visitors[lane] else { continue };
            let surely = surely >> lane & 1 == 1;
            let hit = if surely && located.known >> lane & 1 == 1 {
                let [t, u, v] = [&located.t, &located.u, &located.v].map(|it| it.0[lane]);
                Some(Hit { t, triangle: block.index(place), u, v })
            } else {
                block.hit(place, surely, &Shear::new(&self.rays[lane]))
            };
            if let Some(hit) = hit {
                self.until.0[lane] = lesser(self.until.0[lane], visitor.hit(hit));
            }
        }
    }
}

#[cfg(test)]
mod tests;
