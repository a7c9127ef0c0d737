//! One ray on its way through the tree.

use super::block::Block;
use super::prepare::lesser;
use super::sifted::{Sifted, Wants, lanes};
use super::simd::Simd;
use super::stack::Stack;
use super::traverse::{ENOUGH, Visitor};
use super::wide::{Child, Layout};
use crate::geometry::Ray;

/// Visits a node or a leaf, and gives what comes next.
///
/// The parts of a ray are single variables here and not a structure, so that the compiler keeps
/// those of the only ray in registers.
#[inline(always)]
fn visit<S: Simd>(
    simd: S,
    layout: &Layout,
    (ray, slabs, shear): (&Ray, &S::Slabs, &mut Sheared<S>),
    (child, until, stack): (Child, &mut f32, &mut Stack),
    visitor: &mut impl Visitor,
) -> Option<Child> {
    if let Some(first) = child.block() {
        visitor.leaf();
        let shear = shear.get(simd, ray);
        // SAFETY: children of a layout are in it.
        let blocks = unsafe { layout.blocks.get_unchecked(first..) };
        let leaf = (blocks, child.is_one(), true);
        *until = test_leaf(simd, leaf, (ray, shear), *until, visitor);
        if *until == ENOUGH { None } else { stack.pop(*until) }
    } else {
        visitor.step();
        // SAFETY: as above.
        let wide = unsafe { layout.wides.get_unchecked(child.0 as usize) };
        let interval = [ray.t_min, *until];
        let height = stack.height();
        let next = simd.nearest(wide, slabs, interval, stack);
        // What may come after it is asked for meanwhile; asking for all that are met is slower.
        if let Some(later) = stack.top_above(height) {
            layout.prefetch(later);
        }
        next.or_else(|| stack.pop(*until))
    }
}

/// Visits a node or a leaf and everything below it. Gives the `t` up to which there is more to see.
#[inline(always)]
pub(super) fn visit_below<S: Simd>(
    simd: S,
    layout: &Layout,
    (ray, reach): (&Ray, f32),
    (child, mut until): (Child, f32),
    visitor: &mut impl Visitor,
) -> f32 {
    let slabs = simd.slabs(ray, reach);
    let (mut shear, mut stack) = (Sheared::new(simd, ray), Stack::new());
    let mut next = Some(child);
    while let Some(child) = next {
        let ray = (ray, &slabs, &mut shear);
        next = visit(simd, layout, ray, (child, &mut until, &mut stack), visitor);
    }
    until
}

/// A ray ready for triangles: from the start, if it is made so [ahead](Simd::SHEARS_AHEAD), or from its first leaf
/// on.
struct Sheared<S: Simd>(Option<S::Shear>);

impl<S: Simd> Sheared<S> {
    #[inline(always)]
    fn new(simd: S, ray: &Ray) -> Self {
        Self(S::SHEARS_AHEAD.then(|| simd.shear(ray)))
    }

    #[inline(always)]
    fn get(&mut self, simd: S, ray: &Ray) -> &S::Shear {
        if S::SHEARS_AHEAD {
            // SAFETY: `new` made it, and nothing takes it away.
            unsafe { self.0.as_ref().unwrap_unchecked() }
        } else {
            self.0.get_or_insert_with(|| simd.shear(ray))
        }
    }
}

/// Where a ray is, and what it has still to visit.
pub(super) struct Walk<'a, S: Simd> {
    simd: S,
    ray: &'a Ray,
    ready: S::Ready,
    shear: Sheared<S>,
    stack: &'a mut Stack,
    /// That of the ray, on a line that a step reads anyway.
    t_min: f32,
    until: f32,
}

impl<'a, S: Simd> Walk<'a, S> {
    /// A ray at the root.
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &'a Ray, reach: f32, stack: &'a mut Stack) -> Self {
        let ready = simd.ready(ray, reach);
        stack.clear();
        let Ray { t_min, t_max, .. } = *ray;
        let shear = Sheared::new(simd, ray);
        Self { simd, ray, ready, shear, stack, t_min, until: t_max }
    }

    /// Goes on with another ray, at the root.
    #[inline(always)]
    pub(super) fn restart(&mut self, ray: &'a Ray, reach: f32) {
        self.stack.clear();
        self.ray = ray;
        self.ready = self.simd.ready(ray, reach);
        self.shear = Sheared::new(self.simd, ray);
        (self.t_min, self.until) = (ray.t_min, ray.t_max);
    }

    /// Visits a node, and gives what comes next.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        layout: &Layout,
        child: Child,
        visitor: &mut impl Visitor,
    ) -> Option<Child> {
        visitor.step();
        // SAFETY: children of a layout are in it.
        let wide = unsafe { layout.wides.get_unchecked(child.0 as usize) };
        let stack = &mut *self.stack;
        self.simd.push(wide, &self.ready, [self.t_min, self.until], stack);
        next(layout, stack, self.until)
    }

    /// Visits a leaf, and gives what comes next.
    #[inline(always)]
    pub(super) fn leaf(
        &mut self,
        layout: &Layout,
        child: Child,
        visitor: &mut impl Visitor,
    ) -> Option<Child> {
        visitor.leaf();
        let shear = self.shear.get(self.simd, self.ray);
        let first = child.block().unwrap_or(0);
        // SAFETY: as above.
        let blocks = unsafe { layout.blocks.get_unchecked(first..) };
        let (leaf, ray) = ((blocks, child.is_one(), false), (self.ray, shear));
        self.until = test_leaf(self.simd, leaf, ray, self.until, visitor);
        next(layout, self.stack, self.until)
    }
}

/// What comes next on the way; asks for its memory.
#[inline(always)]
fn next(layout: &Layout, stack: &mut Stack, until: f32) -> Option<Child> {
    let next = stack.pop(until)?;
    layout.prefetch(next);
    Some(next)
}

/// Shows the visitor the hits of a leaf, which comes with whether it has one block, and whether its triangles are
/// [foreseen](Simd::several); gives the `t` up to which there is more to see.
///
/// Few leaves have more than one block. In a loop with the first one the compiler would make vectors of the
/// ray before it, more than there are registers, so the others are tested elsewhere, and not foreseen.
#[inline(always)]
fn test_leaf<S: Simd, V: Visitor>(
    simd: S,
    (blocks, is_one, foresees): (&[Block], bool, bool),
    ray: (&Ray, &S::Shear),
    until: f32,
    visitor: &mut V,
) -> f32 {
    let until = test_block(simd, (&blocks[0], foresees), ray, until, visitor);
    if is_one || blocks[0].is_last() || until == ENOUGH {
        return until;
    }
    simd.test_blocks(&blocks[1..], ray, until, visitor)
}

/// Shows the visitor the hits of blocks up to the last of a leaf; gives the `t` up to which there is more.
#[inline(always)]
pub(super) fn test_blocks<S: Simd, V: Visitor>(
    simd: S,
    blocks: &[Block],
    ray: (&Ray, &S::Shear),
    mut until: f32,
    visitor: &mut V,
) -> f32 {
    for block in blocks {
        until = test_block(simd, (block, false), ray, until, visitor);
        if block.is_last() || until == ENOUGH {
            break;
        }
    }
    until
}

/// Shows the visitor the hits of a block, which comes with whether its triangles are foreseen.
#[inline(always)]
fn test_block<S: Simd, V: Visitor>(
    simd: S,
    (block, foresees): (&Block, bool),
    (ray, shear): (&Ray, &S::Shear),
    mut until: f32,
    visitor: &mut V,
) -> f32 {
    visitor.test();
    let interval = [ray.t_min, until];
    let Some(sifted) = simd.filter(block, shear, interval, V::WANTS) else {
        return until;
    };
    let Sifted { maybe, surely, inside } = sifted;
    if V::WANTS == Wants::Whether {
        for lane in lanes(inside) {
            until = lesser(until, visitor.inside(block.index(lane)));
            if until == ENOUGH {
                return ENOUGH;
            }
        }
        // Of most the bounds tell enough.
        return simd.test_lanes(block, [maybe, surely], (ray, shear), until, visitor);
    }
    if maybe & (maybe - 1) != 0 {
        return simd.several((block, foresees), [maybe, surely], (ray, shear), until, visitor);
    }
    let lane = maybe.trailing_zeros() as usize;
    test_lane(simd, block, (lane, sifted.surely(lane)), (ray, shear), until, visitor)
}

/// Shows the visitor the hits of the first of these masks of lanes; the line crosses those of the second for
/// certain.
#[inline(always)]
pub(super) fn test_lanes<S: Simd, V: Visitor>(
    simd: S,
    block: &Block,
    [maybe, surely]: [u32; 2],
    ray: (&Ray, &S::Shear),
    mut until: f32,
    visitor: &mut V,
) -> f32 {
    for lane in lanes(maybe) {
        let surely = surely >> lane & 1 == 1;
        until = test_lane(simd, block, (lane, surely), ray, until, visitor);
        if until == ENOUGH {
            break;
        }
    }
    until
}

/// Shows the visitor the hit of a triangle, if it wants it.
#[inline(always)]
fn test_lane<S: Simd, V: Visitor>(
    simd: S,
    block: &Block,
    (lane, surely): (usize, bool),
    ray: (&Ray, &S::Shear),
    until: f32,
    visitor: &mut V,
) -> f32 {
    if visitor.knows(block.index(lane)) {
        return until;
    }
    match simd.hit(block, lane, surely, ray) {
        Some(hit) => lesser(until, visitor.hit(hit)),
        None => until,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Hit;
    use crate::trace::hits::Closest;
    use crate::trace::intersect::intersect;
    use crate::trace::noise::noise;
    #[cfg(target_arch = "x86_64")]
    use crate::trace::simd::{Avx2, Avx512};
    use crate::trace::simd::{Best, Plain};

    /// Keeps every hit, and knows which it has.
    struct Everything(Vec<Hit>);

    impl Visitor for Everything {
        fn hit(&mut self, hit: Hit) -> f32 {
            self.0.push(hit);
            f32::INFINITY
        }

        fn knows(&self, triangle: u32) -> bool {
            self.0.iter().any(|hit| hit.triangle == triangle)
        }
    }

    /// Up to eight triangles of which a ray crosses several: some of them the same, some behind it, and some
    /// through an edge or a vertex but for a rounding.
    fn triangles_and_ray(state: &mut u32) -> (Vec<[[f32; 3]; 3]>, Ray) {
        let count = 1 + (8.0 * noise(state)) as usize;
        let slope = if noise(state) < 0.5 { [0.0; 2] } else { [noise(state), noise(state)] };
        // So far from the ray at `z`.
        let beside = |[x, y, z]: [f32; 3]| [x + slope[0] * z, y + slope[1] * z, z];
        let mut triangles: Vec<[[f32; 3]; 3]> = Vec::new();
        for _ in 0..count {
            let kind = (6.0 * noise(state)) as usize;
            let mut corner = || [2.0 * noise(state) - 1.0, 2.0 * noise(state) - 1.0, noise(state)];
            let [a, b, c] = [corner(), corner(), corner()];
            triangles.push(match (kind, triangles.last()) {
                (0, Some(last)) => *last,
                (1, _) => [beside([0.0, 0.0, a[2]]), b, c],
                (2, _) => [beside([-b[0], -b[1], b[2]]), beside(b), c],
                _ => [[-1.0, -1.0, a[2]], [3.0, -1.0, 0.4], [-1.0, 3.0, c[2]]].map(beside),
            });
        }
        let t_min = if noise(state) < 0.5 { 0.0 } else { noise(state) };
        let t_max = 2.0 * noise(state) + 0.5;
        let ray = Ray::new([0.0; 3], [slope[0], slope[1], 1.0]);
        (triangles, Ray { t_min, t_max, ..ray })
    }

    /// What is shown of blocks of triangles that a ray crosses is what [`intersect`] gives. Gives how many hits.
    fn shows_the_hits_of_blocks(simd: impl Simd) -> usize {
        let (mut state, mut shown) = (3, 0);
        for round in 0..40_000 {
            let (triangles, ray) = triangles_and_ray(&mut state);
            let indices: Vec<u32> = (0..triangles.len() as u32).collect();
            let blocks = [Block::new(&indices, true, |index| triangles[index as usize])];
            let shear = simd.shear(&ray);
            let hit = |index: &u32| intersect(&ray, *index, &triangles[*index as usize]);
            let mut hits: Vec<Hit> = indices.iter().filter_map(hit).collect();
            let mut all = Everything(Vec::new());
            test_blocks(simd, &blocks, (&ray, &shear), ray.t_max, &mut all);
            let mut all: Vec<Hit> =
                all.0.into_iter().filter(|hit| ray.t_min <= hit.t && hit.t <= ray.t_max).collect();
            all.sort_unstable_by_key(|hit| hit.triangle);
            assert_eq!(all, hits, "{triangles:?} {ray:?}");
            // One that is left out now and then, which may be the first.
            let accept = |triangle: u32| round % 3 != 0 || triangle != round as u32 % 8;
            let mut closest = Closest::new(&ray, accept);
            let leaf = (&blocks[..], true, round % 2 == 0);
            test_leaf(simd, leaf, (&ray, &shear), ray.t_max, &mut closest);
            hits.retain(|hit| accept(hit.triangle));
            let first = hits.iter().copied().min_by(|a, b| a.t.total_cmp(&b.t));
            assert_eq!(closest.hit, first, "{triangles:?} {ray:?}");
            shown += hits.len();
        }
        shown
    }

    #[test]
    fn hits_of_blocks_are_shown_on_every_processor() {
        let shown = shows_the_hits_of_blocks(Plain);
        assert!(shown > 40_000, "only {shown} hits");
        match Best::detect() {
            #[cfg(target_arch = "x86_64")]
            Best::Avx2(proof) => {
                println!("this processor has no AVX-512: its way was not tested");
                assert_eq!(shows_the_hits_of_blocks(Avx2::from(proof)), shown);
            }
            #[cfg(target_arch = "x86_64")]
            Best::Avx512(proof) => {
                assert_eq!(shows_the_hits_of_blocks(Avx2::from(proof.avx2())), shown);
                assert_eq!(shows_the_hits_of_blocks(Avx512::from(proof)), shown);
            }
            #[cfg(target_arch = "aarch64")]
            Best::Neon(neon) => assert_eq!(shows_the_hits_of_blocks(neon), shown),
            Best::Plain => println!("this processor has no fast path: none was tested"),
        }
    }
}
