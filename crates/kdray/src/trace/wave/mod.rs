//! Everything along many rays, where nothing that is found makes a ray shorter.
//!
//! Then it does not matter in which order nodes and leaves are visited, so no ray waits for itself:
//! pairs of a ray and a node are taken many at a time, and what comes of them is written down, without
//! a jump, as more pairs, or as pairs of a ray and a block. So it goes with the blocks, and with the
//! triangles that may be hit there. The processor works on the next pairs while it reads the last.

mod crossings;
mod pairs;
mod ready;

use std::arch::x86_64::*;

use self::crossings::{Crossing, Crossings, located_four};
use self::pairs::{Pair, Pairs};
use self::ready::{Ready, meet};
use super::block::Block;
use super::block_ray::BlockRay;
use super::filter::unknown_hit;
use super::located::Located;
use super::sift::Sifted;
use super::simd::HasAvx2;
use super::traverse::{Trip, Visitor};
use super::vector::{Precise, lanes};
use super::wide::{Child, Layout};
use crate::geometry::{Hit, Ray};

/// Rays that are on their way together: what is known of them stays in the nearest cache.
const RAYS: usize = 128;

/// Pairs that are taken together. The last ones are: so there are never more than those of as many
/// nodes on every level.
const TOGETHER: usize = 64;

/// Blocks that are looked at together.
const BLOCKS: usize = 512;

/// How many pairs ahead memory is asked for.
const AHEAD: usize = 12;

/// Walks all `rays` and shows their visitors all hits, in no order. Rays without a visitor stay away.
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn trace_avx2<V: Visitor>(
    _proof: HasAvx2,
    trip: &Trip,
    rays: &[Ray],
    mut begin: impl FnMut(usize, &Ray) -> Option<V>,
    mut end: impl FnMut(usize, V),
) {
    let mut wave = Wave {
        trip,
        nodes: Pairs::new(),
        leaves: Pairs::new(),
        inside: Crossings::new(),
        crossed: Crossings::new(),
    };
    let mut visitors = Vec::with_capacity(RAYS);
    for (group, rays) in rays.chunks(RAYS).enumerate() {
        let begun = rays.iter().enumerate().map(|(at, ray)| begin(group * RAYS + at, ray));
        visitors.extend(begun);
        wave.visit(rays, &mut visitors);
        for (at, visitor) in visitors.drain(..).enumerate() {
            if let Some(visitor) = visitor {
                end(group * RAYS + at, visitor);
            }
        }
    }
}

struct Wave<'a> {
    trip: &'a Trip,
    nodes: Pairs,
    leaves: Pairs,
    /// Hits for certain, if it is enough to know that.
    inside: Crossings,
    /// What is crossed, and is to be located.
    crossed: Crossings,
}

impl Wave<'_> {
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn visit<V: Visitor>(&mut self, rays: &[Ray], visitors: &mut [Option<V>]) {
        let ready: Vec<Ready> = rays.iter().map(|ray| Ready::new(ray, self.trip.reach)).collect();
        // Made when the first block is reached: many rays reach none.
        let mut prepared = [const { None }; RAYS];
        self.nodes.reserve(rays.len());
        for at in (0..rays.len()).filter(|at| visitors[*at].is_some()) {
            self.nodes.add(Pair { ray: at as u32, child: Child(0) });
        }
        let mut pairs = [Pair { ray: 0, child: Child(0) }; TOGETHER];
        loop {
            let count = self.nodes.take(&mut pairs);
            self.step(&ready, &pairs[..count]);
            if self.leaves.len >= BLOCKS || count == 0 {
                self.test(rays, &mut prepared, visitors);
            }
            if count == 0 {
                return;
            }
        }
    }

    /// Steps down from nodes.
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn step(&mut self, ready: &[Ready], pairs: &[Pair]) {
        self.nodes.reserve(8 * pairs.len());
        self.leaves.reserve(8 * pairs.len());
        let layout = &self.trip.layout;
        for pair in &pairs[..AHEAD.min(pairs.len())] {
            layout.prefetch_wide(pair.child);
        }
        for (index, pair) in pairs.iter().enumerate() {
            layout.prefetch_wide(pairs[(index + AHEAD).min(pairs.len() - 1)].child);
            // SAFETY: rays and children of pairs are those of the wave and of the layout.
            let (ready, wide) = unsafe {
                let wide = layout.wides.get_unchecked(pair.child.0 as usize);
                (ready.get_unchecked(pair.ray as usize), wide)
            };
            let met = meet(wide, ready);
            // SAFETY: eight lanes, aligned like the node.
            let children = unsafe { _mm256_load_si256(wide.children.as_ptr().cast()) };
            // Leaves have the sign bit.
            let leaves = _mm256_movemask_ps(_mm256_castsi256_ps(children)) as u32;
            self.nodes.push(pair.ray, children, met & !leaves);
            self.leaves.push(pair.ray, children, met & leaves);
        }
    }

    /// Tests the blocks that were met.
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn test<V: Visitor>(
        &mut self,
        rays: &[Ray],
        prepared: &mut [Option<BlockRay>],
        visitors: &mut [Option<V>],
    ) {
        let Trip { layout: Layout { blocks, .. }, .. } = self.trip;
        for index in 0..self.leaves.len {
            let Pair { ray: at, child } = self.leaves.get(index);
            let ahead = self.leaves.get((index + AHEAD).min(self.leaves.len - 1));
            self.trip.layout.prefetch(ahead.child);
            let ray = &rays[at as usize];
            for place in child.block().unwrap_or(0).. {
                let block = &blocks[place];
                let ready = prepared[at as usize].get_or_insert_with(|| BlockRay::new(ray));
                let Sifted { maybe, surely, inside } =
                    block.crossed_avx2::<V>(ready, [ray.t_min, ray.t_max]);
                if V::ASKS_WHETHER {
                    self.inside.push(at, place as u32, inside);
                }
                self.crossed.push(at, place as u32, maybe & surely & !inside);
                if maybe & !surely != 0 {
                    show_unsure(block, maybe & !surely, ray, &mut visitors[at as usize]);
                }
                if self.inside.is_full() || self.crossed.is_full() {
                    self.show(rays, prepared, visitors);
                }
                if child.is_one() || block.is_last() {
                    break;
                }
            }
        }
        self.leaves.len = 0;
        self.show(rays, prepared, visitors);
    }

    /// Shows the hits among crossings.
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn show<V: Visitor>(
        &mut self,
        rays: &[Ray],
        prepared: &[Option<BlockRay>],
        visitors: &mut [Option<V>],
    ) {
        let Trip { layout: Layout { blocks, .. }, .. } = self.trip;
        for index in 0..self.inside.len() {
            let Crossing { ray, block, lane } = self.inside.get(index);
            if let Some(visitor) = &mut visitors[ray] {
                visitor.inside(blocks[block].index(lane));
            }
        }
        self.inside.clear();
        let count = self.crossed.len();
        for first in (0..count).step_by(4) {
            // The last ones are fewer: then one of them is there more than once.
            let four = [0, 1, 2, 3].map(|at| self.crossed.get((first + at).min(count - 1)));
            let [Some(a), Some(b), Some(c), Some(d)] =
                [0, 1, 2, 3].map(|at| &prepared[four[at].ray])
            else {
                continue;
            };
            let at = |ray, at: usize| (ray, &blocks[four[at].block], four[at].lane);
            let Located { known, t, u, v } = located_four([at(a, 0), at(b, 1), at(c, 2), at(d, 3)]);
            let [t, u, v] = [t.rounded(), u.rounded(), v.rounded()];
            for (place, Crossing { ray, block, lane }) in
                four[..(count - first).min(4)].iter().enumerate()
            {
                let Some(visitor) = &mut visitors[*ray] else { continue };
                let (block, triangle) = (&blocks[*block], blocks[*block].index(*lane));
                if known >> place & 1 == 1 {
                    if !visitor.knows(triangle) {
                        visitor.hit(Hit { t: t[place], triangle, u: u[place], v: v[place] });
                    }
                } else if let Some(hit) = unknown_hit(block, *lane, true, &rays[*ray]) {
                    visitor.hit(hit);
                }
            }
        }
        self.crossed.clear();
    }
}

/// Shows what is hit of triangles that a ray may cross, a bit each.
#[cold]
#[inline(never)]
fn show_unsure<V: Visitor>(block: &Block, mask: u32, ray: &Ray, visitor: &mut Option<V>) {
    let Some(visitor) = visitor else { return };
    for lane in lanes(mask) {
        if let Some(hit) = unknown_hit(block, lane, false, ray) {
            visitor.hit(hit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::trace::hits::{AllHits, Crossings, FirstHits};
    use crate::trace::noise::noise;
    use crate::trace::prepare::reach;
    use crate::trace::simd::Best;
    use crate::trace::traverse::traverse;
    use crate::trace::wide::Layout;
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
        let (layout, reach) = (Layout::new(&mesh, &tree), reach(&tree.bounds()));
        let trip = Trip { layout, reach, simd };
        let ray = |index: usize| {
            let mut point = || [(); 3].map(|()| 2.0 * noise(&mut state) - 0.5);
            let ray = Ray::new(point(), point().map(|number| number - 0.5));
            let t_min = if index.is_multiple_of(3) { f32::NEG_INFINITY } else { 0.0 };
            let t_max = if index.is_multiple_of(5) { 0.7 } else { f32::INFINITY };
            Ray { t_min, t_max, ..ray }
        };
        let rays: Vec<Ray> = (0..1000).map(ray).collect();
        let one_by_one = |ray: &Ray| {
            let mut hits = FirstHits::new(ray, usize::MAX, |_| true, Vec::new());
            traverse(&trip, ray, &mut hits);
            hits.hits
        };
        let expected: Vec<_> = rays.iter().map(one_by_one).collect();
        assert!(expected.iter().map(Vec::len).max() > Some(1000), "some meet the thousand");
        let mut hits = vec![Vec::new(); rays.len()];
        let begin = |index: usize, ray: &Ray| {
            (!index.is_multiple_of(7)).then(|| AllHits::new(ray, |_| true, Vec::new()))
        };
        // SAFETY: the processor has AVX2.
        unsafe { trace_avx2(proof, &trip, &rays, begin, |at, it| hits[at] = it.in_order()) };
        let mut counts = vec![0; rays.len()];
        let begin = |_: usize, ray: &Ray| Some(Crossings::new(ray, |_| true));
        // SAFETY: as above.
        unsafe { trace_avx2(proof, &trip, &rays, begin, |at, it| counts[at] = it.count()) };
        for (at, expected) in expected.iter().enumerate() {
            assert_eq!(counts[at], expected.len(), "{:?}", rays[at]);
            let stays_away = at.is_multiple_of(7);
            assert_eq!(hits[at], if stays_away { vec![] } else { expected.clone() }, "{at}");
        }
    }
}
