//! Eight or sixteen rays at a time that go the same way.
//!
//! Camera rays, and shadow rays to a distant light, visit much the same nodes. A packet steps down
//! once for all of them, by bounds of what its rays do; then each box it comes to is tested by
//! all rays at once, and so is each triangle of a leaf. Where few of the rays are left, they go on
//! one by one.

mod boxes;
mod triangles;

use super::block::Block;
use super::prepare::{Shear, greater, lesser};
use super::simd::{Avx2, HasAvx2, HasAvx512};
use super::stack::Stack;
use super::traverse::{ENOUGH, Trip, Visitor};
use super::vector::{Eight, MOST, Numbers, Sixteen, Vector};
use super::walk::visit_below;
use super::wide::Child;
use crate::geometry::{Hit, Ray};
use boxes::Boxes;
use triangles::Triangles;

/// Below so many rays each goes on alone.
const FEW: u32 = 3;

/// Rays on their way together.
struct Packet<'a, V, L: Vector> {
    simd: Avx2<V>,
    trip: &'a Trip,
    rays: &'a [Ray],
    boxes: &'a Boxes<L>,
    triangles: &'a Triangles<L>,
    proof: L::Proof,
    until: Numbers,
}

/// Shows each of eight visitors what its ray comes to; gives false and shows nothing where the rays
/// do not go the same way. Rays without a visitor stay away.
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn traverse_avx2<V: Visitor>(
    proof: HasAvx2,
    trip: &Trip,
    rays: &[Ray],
    visitors: &mut [Option<V>],
) -> bool {
    traverse::<V, Eight>((proof, proof), trip, rays, visitors)
}

/// The same for sixteen.
#[target_feature(enable = "avx512f,avx512dq,avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn traverse_avx512<V: Visitor>(
    proof: HasAvx512,
    trip: &Trip,
    rays: &[Ray],
    visitors: &mut [Option<V>],
) -> bool {
    traverse::<V, Sixteen>((proof.avx2(), proof), trip, rays, visitors)
}

#[inline(always)]
fn traverse<V: Visitor, L: Vector>(
    (avx2, proof): (HasAvx2, L::Proof),
    trip: &Trip,
    rays: &[Ray],
    visitors: &mut [Option<V>],
) -> bool {
    let lanes = Rays::<L>::new(proof, rays);
    let Some(boxes) = Boxes::new(&lanes, trip.reach, avx2) else { return false };
    let triangles = Triangles::new(&lanes, Shear::axes(&rays[0].direction));
    let mut until = lanes.t_max.numbers();
    for (until, visitor) in until.0.iter_mut().zip(visitors.iter()) {
        *until = if visitor.is_some() { *until } else { ENOUGH };
    }
    let (boxes, triangles) = (&boxes, &triangles);
    let mut packet = Packet { simd: avx2.into(), trip, rays, boxes, triangles, proof, until };
    packet.traverse(visitors);
    true
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

#[inline(always)]
fn least<L: Vector>(lanes: L) -> f32 {
    lanes.numbers().0[..L::LANES].iter().copied().fold(f32::INFINITY, lesser)
}

#[inline(always)]
fn greatest<L: Vector>(lanes: L) -> f32 {
    lanes.numbers().0[..L::LANES].iter().copied().fold(f32::NEG_INFINITY, greater)
}

impl<V: Visitor, L: Vector> Packet<'_, V, L> {
    #[inline(always)]
    fn traverse(&mut self, visitors: &mut [Option<V>]) {
        let wides = &self.trip.layout.wides[..];
        let (mut stack, mut child, mut mask) = (Stack::new(), Child(0), (1_u32 << L::LANES) - 1);
        let mut last = self.last();
        loop {
            if mask.count_ones() < FEW {
                self.go_on_alone(child, mask, visitors);
                last = self.last();
            } else if let Some(first) = child.block() {
                self.test_leaf(&self.trip.layout.blocks[first..], mask, visitors);
                last = self.last();
            } else {
                // SAFETY: there is a vector, so the processor has AVX2.
                unsafe { self.boxes.push(&wides[child.0 as usize], child, last, &mut stack) };
            }
            let until = L::of_numbers(self.proof, &self.until);
            (child, mask) = loop {
                let Some(place) = stack.pop(last) else { return };
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
        greatest(L::of_numbers(self.proof, &self.until))
    }

    /// Shows what is below `child` to the rays of `mask`, one after the other.
    #[inline(always)]
    fn go_on_alone(&mut self, child: Child, mask: u32, visitors: &mut [Option<V>]) {
        let Trip { layout, reach, .. } = self.trip;
        for lane in lanes(mask) {
            let Some(visitor) = &mut visitors[lane] else { continue };
            let until = &mut self.until.0[lane];
            let (ray, place) = ((&self.rays[lane], *reach), (child, *until));
            *until = visit_below(self.simd, layout, ray, place, visitor);
        }
    }

    /// Shows the triangles of a leaf to the rays of `mask`.
    #[inline(always)]
    fn test_leaf(&mut self, blocks: &[Block], mask: u32, visitors: &mut [Option<V>]) {
        for block in blocks {
            for place in block.places() {
                self.test_triangle(block, place, mask, visitors);
            }
            if block.is_last() {
                break;
            }
        }
    }

    #[inline(always)]
    fn test_triangle(
        &mut self,
        block: &Block,
        place: usize,
        mask: u32,
        visitors: &mut [Option<V>],
    ) {
        let until = L::of_numbers(self.proof, &self.until);
        let sifted = self.triangles.sift(block, place, until);
        let index = block.index(place);
        if V::ASKS_WHETHER {
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
            self.show_hits(block, place, (maybe, sifted.surely), visitors);
        }
    }

    /// Shows the hits of a triangle to the rays of a mask that may hit it; some do so for certain.
    #[inline(always)]
    fn show_hits(
        &mut self,
        block: &Block,
        place: usize,
        (maybe, surely): (u32, u32),
        visitors: &mut [Option<V>],
    ) {
        let located = self.triangles.locate(block, place);
        for lane in lanes(maybe) {
            let Some(visitor) = &mut visitors[lane] else { continue };
            let surely = surely >> lane & 1 == 1;
            let hit = if surely && located.mask >> lane & 1 == 1 {
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

/// The lanes of a mask.
#[inline(always)]
fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < MOST).then_some(lane)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::trace::hits::Closest;
    use crate::trace::prepare::reach;
    use crate::trace::simd::Best;
    use crate::trace::wide::Layout;
    use crate::{BuildOptions, Tree};

    /// Whether rays along these directions, all that a packet has, were a packet, and their hits.
    fn traced(trip: &Trip, direction: impl Fn(usize) -> [f32; 3]) -> Option<Vec<Option<Hit>>> {
        let count = if trip.simd.avx512().is_some() { 16 } else { 8 };
        let rays = (0..count).map(|index| Ray::new([0.5, 0.5, 5.0], direction(index)));
        let rays: Vec<Ray> = rays.collect();
        let visitor = |ray: &Ray| Some(Closest::new(ray, |_| true));
        let mut visitors: Vec<_> = rays.iter().map(visitor).collect();
        visitors[3] = None;
        let together = match trip.simd {
            Best::Plain => panic!("asked for AVX2 before"),
            // SAFETY: the processor has it.
            Best::Avx2(proof) => unsafe { traverse_avx2(proof, trip, &rays, &mut visitors) },
            // SAFETY: as above.
            Best::Avx512(proof) => unsafe { traverse_avx512(proof, trip, &rays, &mut visitors) },
        };
        together.then(|| visitors.into_iter().map(|visitor| visitor?.hit).collect())
    }

    #[test]
    fn rays_go_together_where_their_largest_axes_and_signs_agree() {
        if Best::detect().avx2().is_none() {
            println!("this processor has no AVX2: packets were not tested");
            return;
        }
        let square = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]];
        let mesh = Mesh::new(&square, &[[0, 1, 2]]).expect("sound");
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let (layout, reach) = (Layout::new(&mesh, &tree), reach(&tree.bounds()));
        let trip = Trip { layout, reach, simd: Best::detect() };
        let fan = |spread: f32| move |index: usize| [spread * (index as f32 + 0.5), 0.1, -1.0];
        let hits = traced(&trip, fan(0.01)).expect("these go together");
        assert!((0..hits.len()).all(|lane| hits[lane].is_some() == (lane != 3)));
        assert!(traced(&trip, fan(0.2)).is_none(), "the last ones are largest in x");
        let torn = |index: usize| [0.01, if index == 5 { -0.1 } else { 0.1 }, -1.0];
        assert!(traced(&trip, torn).is_none(), "one goes down in y");
    }
}
