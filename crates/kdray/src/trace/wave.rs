//! Everything along many rays, where nothing that is found makes a ray shorter.
//!
//! Then it does not matter in which order nodes and leaves are visited, so no ray waits for itself:
//! pairs of a ray and a node are taken many at a time, and what comes of them is written down, without
//! a jump, as more pairs, or as pairs of a ray and a block. So it goes with the blocks, and with the
//! triangles that may be hit there. The processor works on the next pairs while it reads the last.

use std::arch::x86_64::*;

use super::block::Block;
use super::eights::Eights;
use super::filter::{RayLanes, unknown_hit};
use super::located::Located;
use super::prepare::Slabs;
use super::sift::Sifted;
use super::simd::HasAvx2;
use super::step::places;
use super::traverse::{Trip, Visitor};
use super::vector::lanes;
use super::wide::{Child, Wide};
use crate::geometry::{Hit, Ray};

/// Rays that are on their way together: what is known of them stays in the nearest cache.
const RAYS: usize = 128;

/// Pairs that are taken together. The last ones are: so there are never more than those of as many
/// nodes on every level.
const TOGETHER: usize = 64;

/// Blocks that are looked at together.
const BLOCKS: usize = 512;

/// How many pairs ahead memory is asked for.
const AHEAD: usize = 8;

/// A ray, by its place, and a node or a block that it meets.
#[derive(Clone, Copy)]
struct Pair {
    ray: u32,
    child: Child,
}

/// Pairs in two columns. Eight are written at a time, however many of them count.
struct Pairs {
    rays: Vec<u32>,
    children: Vec<Child>,
    len: usize,
}

impl Pairs {
    fn new() -> Self {
        Self { rays: Vec::new(), children: Vec::new(), len: 0 }
    }

    /// Makes room for so many pairs more, and for eight.
    fn reserve(&mut self, more: usize) {
        let len = self.len + more + 8;
        if self.rays.len() < len {
            self.rays.resize(2 * len, 0);
            self.children.resize(2 * len, Child::NONE);
        }
    }

    /// Adds those of eight children whose bit is set.
    #[inline]
    #[target_feature(enable = "avx2,popcnt")]
    fn push(&mut self, ray: u32, children: __m256i, mask: u32) {
        debug_assert!(self.len + 8 <= self.rays.len(), "there is room");
        let children = _mm256_permutevar8x32_epi32(children, places(mask));
        // SAFETY: there is room for eight.
        unsafe {
            let rays = self.rays.as_mut_ptr().add(self.len);
            _mm256_storeu_si256(rays.cast(), _mm256_set1_epi32(ray as i32));
            _mm256_storeu_si256(self.children.as_mut_ptr().add(self.len).cast(), children);
        }
        self.len += mask.count_ones() as usize;
    }

    /// Adds one. There is room.
    fn add(&mut self, pair: Pair) {
        (self.rays[self.len], self.children[self.len]) = (pair.ray, pair.child);
        self.len += 1;
    }

    fn get(&self, index: usize) -> Pair {
        Pair { ray: self.rays[index], child: self.children[index] }
    }

    /// Takes the last pairs, at most so many.
    fn take(&mut self, into: &mut [Pair]) -> usize {
        let count = self.len.min(into.len());
        self.len -= count;
        for (index, pair) in into[..count].iter_mut().enumerate() {
            *pair = self.get(self.len + index);
        }
        count
    }
}

/// Triangles of a block that a ray may hit.
#[derive(Clone, Copy)]
struct Candidates {
    ray: u32,
    block: u32,
    /// Bits of lanes: those that may be hit, that are crossed for certain, and that are hit in the
    /// ray's interval for certain.
    maybe: u32,
    surely: u32,
    inside: u32,
}

/// Walks all `rays` and shows their visitors all hits, in no order. Rays without a visitor stay away.
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn trace_avx2<V: Visitor>(
    _proof: HasAvx2,
    trip: &Trip,
    rays: &[Ray],
    mut begin: impl FnMut(usize, &Ray) -> Option<V>,
    mut end: impl FnMut(usize, V),
) {
    let mut wave = Wave { trip, nodes: Pairs::new(), leaves: Pairs::new() };
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
}

impl Wave<'_> {
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn visit<V: Visitor>(&mut self, rays: &[Ray], visitors: &mut [Option<V>]) {
        let slabs: Vec<Slabs> = rays.iter().map(|ray| Slabs::new(ray, self.trip.reach)).collect();
        // Made when the first block is reached: many rays reach none.
        let mut shears = [const { None }; RAYS];
        self.nodes.reserve(rays.len());
        for at in (0..rays.len()).filter(|at| visitors[*at].is_some()) {
            self.nodes.add(Pair { ray: at as u32, child: Child(0) });
        }
        let mut pairs = [Pair { ray: 0, child: Child(0) }; TOGETHER];
        loop {
            let count = self.nodes.take(&mut pairs);
            self.step(rays, &slabs, &pairs[..count]);
            if self.leaves.len >= BLOCKS || count == 0 {
                self.test(rays, &mut shears, visitors);
            }
            if count == 0 {
                return;
            }
        }
    }

    /// Steps down from nodes.
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn step(&mut self, rays: &[Ray], slabs: &[Slabs], pairs: &[Pair]) {
        self.nodes.reserve(8 * pairs.len());
        self.leaves.reserve(8 * pairs.len());
        for (index, pair) in pairs.iter().enumerate() {
            self.trip.layout.prefetch(pairs[(index + AHEAD).min(pairs.len() - 1)].child);
            let at = pair.ray as usize;
            // SAFETY: rays and children of pairs are those of the wave and of the layout.
            let (slabs, ray, wide) = unsafe {
                let wide = self.trip.layout.wides.get_unchecked(pair.child.0 as usize);
                (slabs.get_unchecked(at), rays.get_unchecked(at), wide)
            };
            let met = meet(wide, slabs, ray);
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
        shears: &mut [Option<RayLanes>],
        visitors: &mut [Option<V>],
    ) {
        let blocks = &self.trip.layout.blocks[..];
        let mut found = [Candidates { ray: 0, block: 0, maybe: 0, surely: 0, inside: 0 }; BLOCKS];
        let mut count = 0;
        for index in 0..self.leaves.len {
            let Pair { ray: at, child } = self.leaves.get(index);
            self.trip.layout.prefetch(self.leaves.children[index + AHEAD]);
            let interval = [rays[at as usize].t_min, rays[at as usize].t_max];
            for place in child.block().unwrap_or(0).. {
                if count == BLOCKS {
                    show(blocks, &found, (rays, shears), visitors);
                    count = 0;
                }
                let shear =
                    shears[at as usize].get_or_insert_with(|| RayLanes::new(&rays[at as usize]));
                let Sifted { maybe, surely, inside } =
                    blocks[place].crossed_avx2::<V>(shear, interval);
                found[count] = Candidates { ray: at, block: place as u32, maybe, surely, inside };
                count += usize::from(maybe != 0);
                if child.is_one() || blocks[place].is_last() {
                    break;
                }
            }
        }
        show(blocks, &found[..count], (rays, shears), visitors);
        self.leaves.len = 0;
    }
}

/// Shows hits of candidates.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn show<V: Visitor>(
    blocks: &[Block],
    found: &[Candidates],
    (rays, shears): (&[Ray], &[Option<RayLanes>]),
    visitors: &mut [Option<V>],
) {
    for candidates in found {
        let block = &blocks[candidates.block as usize];
        let at = candidates.ray as usize;
        let (Some(shear), Some(visitor)) = (&shears[at], &mut visitors[at]) else { continue };
        let inside = if V::ASKS_WHETHER { candidates.inside } else { 0 };
        for lane in lanes(inside) {
            visitor.inside(block.index(lane));
        }
        let news = |lane: &usize| !visitor.knows(block.index(*lane));
        let rest =
            lanes(candidates.maybe & !inside).filter(news).fold(0, |all, lane| all | 1 << lane);
        if rest == 0 {
            continue;
        }
        let Located { known, t, u, v } = block.located_avx2(shear);
        let [t, u, v] = [t.numbers(), u.numbers(), v.numbers()];
        for lane in lanes(rest) {
            let triangle = block.index(lane);
            let surely = candidates.surely >> lane & 1 == 1;
            if known >> lane & 1 == 1 && surely {
                visitor.hit(Hit { t: t[lane], triangle, u: u[lane], v: v[lane] });
            } else if let Some(hit) = unknown_hit(block, lane, surely, &rays[at]) {
                visitor.hit(hit);
            }
        }
    }
}

/// The children that the ray meets, a bit each: [`meet`](super::step::meet) of a ray as single
/// numbers, since those of all rays of a wave stay in the nearest cache.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn meet(wide: &Wide, slabs: &Slabs, ray: &Ray) -> u32 {
    let mut enter = _mm256_set1_ps(ray.t_min);
    let mut leave = _mm256_set1_ps(ray.t_max);
    for axis in 0..3 {
        let backward = slabs.backward[axis];
        // SAFETY: there are two ends; eight lanes each, aligned like the node.
        let [near, far] = [backward, 1 - backward]
            .map(|end| unsafe { _mm256_load_ps(wide.bounds.get_unchecked(end)[axis].as_ptr()) });
        let inverse = _mm256_set1_ps(slabs.inverse[axis]);
        let near = _mm256_fmsub_ps(near, inverse, _mm256_set1_ps(slabs.enter[axis]));
        let far = _mm256_fmsub_ps(far, inverse, _mm256_set1_ps(slabs.leave[axis]));
        enter = _mm256_max_ps(enter, near);
        leave = _mm256_min_ps(leave, far);
    }
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave)) as u32
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
