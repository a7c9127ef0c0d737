//! Everything along many rays, where nothing that is found makes a ray shorter.
//!
//! Then it does not matter in which order nodes and leaves are visited, so no ray waits for itself:
//! pairs of a ray and a node are taken many at a time, and what comes of them is written down, without
//! a jump, as more pairs, or as pairs of a ray and a block. So it goes with the blocks, and with the
//! triangles that may be hit there. The processor works on the next pairs while it reads the last.

mod crossings;
mod pairs;
mod piles;

use std::arch::x86_64::*;

use self::crossings::{Crossing, Crossings, located_four};
use self::pairs::Pairs;
pub(super) use self::piles::Kept;
use self::piles::Piles;
use super::block_ray::BlockRay;
use super::lane::unknown_hit;
use super::located::Located;
use super::sifted::{Sifted, lanes};
use super::simd::HasAvx2;
use super::step::Ready;
use super::traverse::Trip;
use super::vector::Precise;
use super::wide::Child;
use crate::geometry::{Hit, Ray};

/// Rays that are on their way together: what is known of them stays in the nearest cache.
const RAYS: usize = 128;

/// Pairs that are taken together. The last ones are: so there are never more than those of as many
/// nodes on every level.
const TOGETHER: usize = 64;

/// Leaves that are waited for before their blocks are tested.
const LEAVES: usize = 512;

/// Walks all `rays` and gives `end`, ray by ray, all that is hit of what `accept`, by the index of the
/// ray, holds of: in order, and each triangle once.
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn trace_avx2<T: Kept, F: Fn(u32) -> bool>(
    _proof: HasAvx2,
    trip: &Trip,
    rays: &[Ray],
    accept: impl Fn(usize) -> F,
    mut end: impl FnMut(usize, &[T]),
) {
    let most = rays.len().min(RAYS);
    let mut wave = Wave {
        trip,
        accept: |ray, triangle| accept(ray)(triangle),
        first: 0,
        rays: &[],
        ready: vec![Ready::default(); most],
        prepared: vec![BlockRay::default(); most],
        met: Pairs::default(),
        nodes: Pairs::default(),
        leaves: Pairs::default(),
        inside: Crossings::new(),
        crossed: Crossings::new(),
        piles: Piles::new(),
    };
    for (group, rays) in rays.chunks(RAYS).enumerate() {
        (wave.first, wave.rays) = (group * RAYS, rays);
        wave.visit();
        wave.piles.hand_over(rays.len(), |at, list| end(group * RAYS + at, list));
    }
}

struct Wave<'a, T, A> {
    trip: &'a Trip,
    /// Whether a ray, by its index, sees a triangle.
    accept: A,
    /// The index of the first ray.
    first: usize,
    rays: &'a [Ray],
    /// The rays for boxes, and for blocks.
    ready: Vec<Ready>,
    prepared: Vec<BlockRay>,
    /// What rays have met.
    met: Pairs,
    /// Nodes of it, from which the wave steps down next, and leaves.
    nodes: Pairs,
    leaves: Pairs,
    /// Hits for certain, if it is enough to know that.
    inside: Crossings,
    /// What is crossed, and is to be located.
    crossed: Crossings,
    piles: Piles<T>,
}

impl<T: Kept, A: Fn(usize, u32) -> bool> Wave<'_, T, A> {
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn visit(&mut self) {
        // For blocks too: which rays come to one nobody can foresee.
        let places = self.ready.iter_mut().zip(&mut self.prepared);
        for (ray, (ready, prepared)) in self.rays.iter().zip(places) {
            (*ready, *prepared) = (Ready::new(ray, self.trip.hull.reach), BlockRay::new(ray));
        }
        let mut met = self.met.end(self.rays.len());
        for (at, _) in self.rays.iter().enumerate().filter(|(_, ray)| ray.is_valid()) {
            met.add(at as u32, Child(0));
        }
        drop(met);
        while self.met.len() > 0 {
            self.met.take(TOGETHER, &mut self.nodes, &mut self.leaves);
            self.step();
            if self.leaves.len() >= LEAVES {
                self.test();
            }
        }
        self.test();
    }

    /// Steps down from nodes.
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn step(&mut self) {
        let layout = &self.trip.layout;
        let mut met = self.met.end(8 * TOGETHER);
        let (first, nodes) = self.nodes.iter(Child(0));
        first.iter().for_each(|child| layout.prefetch_wide(*child));
        for (ray, child, ahead) in nodes {
            layout.prefetch_wide(ahead);
            // SAFETY: rays and children of pairs are those of the wave and of the layout.
            let (ready, wide) = unsafe {
                let wide = layout.wides.get_unchecked(child.0 as usize);
                (self.ready.get_unchecked(ray as usize), wide)
            };
            // SAFETY: the processor has AVX2 and FMA; eight lanes, aligned like the node.
            let (mask, children) = unsafe {
                let passage = ready.pass(wide, ready.interval());
                (passage.met(), _mm256_load_si256(wide.children.as_ptr().cast()))
            };
            let mask = _mm256_movemask_ps(mask) as u32;
            met.push_for(_mm256_set1_epi32(ray as i32), children, mask);
        }
        drop(met);
        self.nodes.clear();
    }

    /// Tests the blocks that were met.
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn test(&mut self) {
        let layout = &self.trip.layout;
        let mut leaves = std::mem::take(&mut self.leaves);
        let (first, pairs) = leaves.iter(Child::leaf(0));
        first.iter().for_each(|child| layout.prefetch_block(*child));
        for (at, child, ahead) in pairs {
            layout.prefetch_block(ahead);
            let Ray { t_min, t_max, .. } = self.rays[at as usize];
            for place in child.place().. {
                let (ray, block) = (&self.prepared[at as usize], &layout.blocks[place]);
                let Sifted { maybe, surely, inside } = block.crossed_avx2::<T>(ray, [t_min, t_max]);
                if T::ASKS_WHETHER {
                    self.inside.push(at, place as u32, inside);
                }
                self.crossed.push(at, place as u32, maybe & surely & !inside);
                if maybe & !surely != 0 {
                    self.keep_unsure(at as usize, place, maybe & !surely);
                }
                if self.crossed.is_full() || T::ASKS_WHETHER && self.inside.is_full() {
                    self.locate();
                }
                if child.is_one() || block.is_last() {
                    break;
                }
            }
        }
        leaves.clear();
        self.leaves = leaves;
        self.locate();
    }

    /// Keeps the hits among crossings.
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn locate(&mut self) {
        let blocks = &self.trip.layout.blocks;
        self.inside.leave_out_known(blocks, &mut self.piles);
        self.crossed.leave_out_known(blocks, &mut self.piles);
        for index in 0..self.inside.len() {
            let Crossing { ray, block, lane } = self.inside.get(index);
            let triangle = blocks[block].index(lane);
            self.keep(ray, &Hit { t: 0.0, triangle, u: 0.0, v: 0.0 });
        }
        self.inside.clear();
        let count = self.crossed.len();
        for first in (0..count).step_by(4) {
            // The last ones are fewer: then one of them is there more than once.
            let four = [0, 1, 2, 3].map(|at| self.crossed.get((first + at).min(count - 1)));
            let Located { known, t, u, v } =
                located_four(four.map(|Crossing { ray, block, lane }| {
                    (&self.prepared[ray], &blocks[block], lane)
                }));
            let [t, u, v] = [t.rounded(), u.rounded(), v.rounded()];
            for (place, crossing) in four[..(count - first).min(4)].iter().enumerate() {
                let Crossing { ray, block, lane } = *crossing;
                if known >> place & 1 == 1 {
                    let triangle = blocks[block].index(lane);
                    self.look_at(ray, &Hit { t: t[place], triangle, u: u[place], v: v[place] });
                } else if let Some(hit) = unknown_hit(&blocks[block], lane, true, &self.rays[ray]) {
                    self.look_at(ray, &hit);
                }
            }
        }
        self.crossed.clear();
    }

    /// Keeps what is hit of triangles of a block that a ray may cross, a bit each.
    #[cold]
    #[inline(never)]
    fn keep_unsure(&mut self, ray: usize, block: usize, mask: u32) {
        let block = &self.trip.layout.blocks[block];
        for lane in lanes(mask) {
            if let Some(hit) = unknown_hit(block, lane, false, &self.rays[ray]) {
                self.look_at(ray, &hit);
            }
        }
    }

    /// Keeps a hit if it is in the ray's interval.
    #[inline(always)]
    fn look_at(&mut self, ray: usize, hit: &Hit) {
        let Ray { t_min, t_max, .. } = self.rays[ray];
        if t_min <= hit.t && hit.t <= t_max {
            self.keep(ray, hit);
        }
    }

    /// Keeps a hit in the ray's interval, if the ray sees the triangle.
    #[inline(always)]
    fn keep(&mut self, ray: usize, hit: &Hit) {
        if (self.accept)(self.first + ray, hit.triangle) {
            self.piles.add(ray, T::of(hit));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::trace::hits::FirstHits;
    use crate::trace::noise::noise;
    use crate::trace::simd::Best;
    use crate::trace::traverse::traverse;
    use crate::{BuildOptions, Tree};

    /// Triangles without a pattern, of which one stands there a thousand times: a leaf of many blocks.
    fn mesh(state: &mut u32) -> Mesh {
        let positions: Vec<[f32; 3]> = (0..900).map(|_| [(); 3].map(|()| noise(state))).collect();
        let mut triangles: Vec<[u32; 3]> = (0..800).map(|at| [at, at + 1, at + 100]).collect();
        triangles.extend([[3, 400, 700]; 1000]);
        Mesh::new(&positions, &triangles).expect("sound")
    }

    #[test]
    fn all_is_seen_that_one_ray_after_the_other_sees() {
        let simd = Best::detect();
        let Some(proof) = simd.avx2() else {
            return println!("this processor has no AVX2: there are no waves");
        };
        let mut state = 17;
        let mesh = mesh(&mut state);
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let trip = Trip::new(&mesh, &tree, simd);
        let ray = |index: usize| {
            let mut point = || [(); 3].map(|()| 2.0 * noise(&mut state) - 0.5);
            let ray = Ray::new(point(), point().map(|number| number - 0.5));
            let t_min = if index.is_multiple_of(3) { f32::NEG_INFINITY } else { 0.0 };
            let t_max = if index.is_multiple_of(5) { 0.7 } else { f32::INFINITY };
            Ray { t_min, t_max, ..ray }
        };
        let mut rays: Vec<Ray> = (0..1000).map(ray).collect();
        // These can hit nothing.
        rays.iter_mut().step_by(7).for_each(|ray| ray.direction = [0.0; 3]);
        // Every ray sees the thousand, and of the others its own.
        let accept = |index: usize| {
            move |triangle: u32| triangle >= 800 || !(triangle + index as u32).is_multiple_of(11)
        };
        let one_by_one = |(index, ray): (usize, &Ray)| {
            let mut hits = FirstHits::new(ray, usize::MAX, accept(index), Vec::new());
            if ray.is_valid() {
                traverse(&trip, ray, &mut hits);
            }
            hits.hits
        };
        let expected: Vec<_> = rays.iter().enumerate().map(one_by_one).collect();
        assert!(expected.iter().map(Vec::len).max() > Some(1000), "some meet the thousand");
        let mut hits = vec![Vec::new(); rays.len()];
        // SAFETY: the processor has AVX2.
        unsafe { trace_avx2(proof, &trip, &rays, accept, |at, it: &[Hit]| hits[at] = it.to_vec()) };
        let mut counts = vec![0; rays.len()];
        // SAFETY: as above.
        unsafe { trace_avx2(proof, &trip, &rays, accept, |at, it: &[u32]| counts[at] = it.len()) };
        for (at, expected) in expected.iter().enumerate() {
            assert_eq!(counts[at], expected.len(), "{:?}", rays[at]);
            assert_eq!(hits[at], *expected, "{at}");
        }
    }
}
