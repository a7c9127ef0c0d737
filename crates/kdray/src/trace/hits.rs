//! What the queries keep of the hits they are shown.

use smallvec::SmallVec;

use super::Counts;
use super::sifted::Wants;
use super::traverse::{ENOUGH, Visitor};
use crate::geometry::{Hit, Ray};

/// Keeps the first hit.
pub(super) struct Closest<F> {
    t_min: f32,
    t_max: f32,
    accept: F,
    pub(super) hit: Option<Hit>,
}

impl<F> Closest<F> {
    pub(super) fn new(ray: &Ray, accept: F) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, accept, hit: None }
    }
}

impl<F: Fn(u32) -> bool> Visitor for Closest<F> {
    const WANTS: Wants = Wants::First;

    #[inline(always)]
    fn hit(&mut self, hit: Hit) -> f32 {
        let tie = || self.hit.is_none_or(|best| hit.triangle < best.triangle);
        let first = hit.t < self.t_max || hit.t == self.t_max && tie();
        if self.t_min <= hit.t && first && (self.accept)(hit.triangle) {
            self.t_max = hit.t;
            self.hit = Some(hit);
        }
        self.t_max
    }

    #[inline(always)]
    fn knows(&self, triangle: u32) -> bool {
        self.hit.is_some_and(|hit| hit.triangle == triangle)
    }
}

/// Counts while it looks for the first hit.
pub(super) struct Counted<F> {
    pub(super) closest: Closest<F>,
    pub(super) counts: Counts,
}

impl<F> Counted<F> {
    pub(super) fn new(ray: &Ray, accept: F) -> Self {
        Self { closest: Closest::new(ray, accept), counts: Counts::default() }
    }
}

impl<F: Fn(u32) -> bool> Visitor for Counted<F> {
    const WANTS: Wants = Wants::First;

    fn hit(&mut self, hit: Hit) -> f32 {
        self.closest.hit(hit)
    }

    fn step(&mut self) {
        self.counts.steps += 1;
    }

    fn leaf(&mut self) {
        self.counts.leaves += 1;
    }

    fn test(&mut self) {
        self.counts.tests += 1;
    }
}

/// Is content with any hit.
pub(super) struct Any<F> {
    t_min: f32,
    t_max: f32,
    accept: F,
    pub(super) found: bool,
}

impl<F> Any<F> {
    pub(super) fn new(ray: &Ray, accept: F) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, accept, found: false }
    }
}

impl<F: Fn(u32) -> bool> Visitor for Any<F> {
    #[inline(always)]
    fn hit(&mut self, hit: Hit) -> f32 {
        let inside = self.t_min <= hit.t && hit.t <= self.t_max;
        self.found = inside && (self.accept)(hit.triangle);
        if self.found { ENOUGH } else { self.t_max }
    }

    const WANTS: Wants = Wants::Whether;

    #[inline(always)]
    fn inside(&mut self, triangle: u32) -> f32 {
        self.found = (self.accept)(triangle);
        if self.found { ENOUGH } else { self.t_max }
    }
}

/// Keeps the first hits, at most `limit` of them, in order and each once.
///
/// A triangle in several leaves gives the very same hit in each of them, so repeated hits are
/// equal and stand side by side. Leaves come from front to back: a hit finds its place by looking
/// back over the few that are beyond it.
pub(super) struct FirstHits<F> {
    t_min: f32,
    t_max: f32,
    limit: usize,
    accept: F,
    pub(super) hits: Vec<Hit>,
}

impl<F> FirstHits<F> {
    /// Keeps them in `hits`, which is empty; `limit` is not zero.
    pub(super) fn new(ray: &Ray, limit: usize, accept: F, hits: Vec<Hit>) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, limit, accept, hits }
    }
}

impl<F: Fn(u32) -> bool> Visitor for FirstHits<F> {
    #[inline(always)]
    fn hit(&mut self, hit: Hit) -> f32 {
        let inside = self.t_min <= hit.t && hit.t <= self.t_max;
        if !inside || !(self.accept)(hit.triangle) {
            return self.t_max;
        }
        let beyond = self.hits.iter().rev().take_while(|other| comes_before(&hit, other)).count();
        let place = self.hits.len() - beyond;
        let repeated = place > 0 && self.hits[place - 1].triangle == hit.triangle;
        if !repeated && place < self.limit {
            self.hits.truncate(self.limit - 1);
            self.hits.insert(place, hit);
        }
        if self.hits.len() == self.limit {
            // Not nearer: a hit at this very `t` may have a lower triangle.
            self.t_max = self.hits[self.limit - 1].t;
        }
        self.t_max
    }

    /// Looks at the last few: a triangle in several leaves comes again soon.
    #[inline(always)]
    fn knows(&self, triangle: u32) -> bool {
        self.hits.iter().rev().take(4).any(|hit| hit.triangle == triangle)
    }
}

/// Counts hits, each triangle once, and asks where they are only if it must.
///
/// Few rays hit more triangles than there is room for here.
pub(super) struct Crossings<F> {
    t_min: f32,
    t_max: f32,
    accept: F,
    /// The triangles that were hit; some of them more than once.
    crossed: SmallVec<[u32; 8]>,
}

impl<F> Crossings<F> {
    pub(super) fn new(ray: &Ray, accept: F) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, accept, crossed: SmallVec::new() }
    }

    /// How many triangles were hit.
    pub(super) fn count(&mut self) -> usize {
        self.crossed.sort_unstable();
        self.crossed.dedup();
        self.crossed.len()
    }
}

impl<F: Fn(u32) -> bool> Visitor for Crossings<F> {
    #[inline(always)]
    fn hit(&mut self, hit: Hit) -> f32 {
        if self.t_min <= hit.t && hit.t <= self.t_max {
            self.inside(hit.triangle);
        }
        self.t_max
    }

    const WANTS: Wants = Wants::Whether;

    #[inline(always)]
    fn inside(&mut self, triangle: u32) -> f32 {
        if !self.knows(triangle) && (self.accept)(triangle) {
            self.crossed.push(triangle);
        }
        self.t_max
    }

    #[inline(always)]
    fn knows(&self, triangle: u32) -> bool {
        self.crossed.iter().rev().take(4).any(|other| *other == triangle)
    }
}

/// Hits come in order of `t`; of several at one `t` the lowest triangle comes first.
fn comes_before(a: &Hit, b: &Hit) -> bool {
    a.t < b.t || a.t == b.t && a.triangle < b.triangle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::trace::intersect;
    use crate::trace::noise::noise;
    use crate::trace::simd::Best;
    use crate::trace::traverse::{Trip, traverse};
    use crate::{BuildOptions, Tree};

    fn keep(limit: usize, shown: &[(f32, u32)]) -> Vec<(f32, u32)> {
        let ray = Ray::new([0.0; 3], [1.0, 0.0, 0.0]);
        let mut first = FirstHits::new(&ray, limit, |_| true, Vec::new());
        for (t, triangle) in shown {
            first.hit(Hit { t: *t, triangle: *triangle, u: 0.0, v: 0.0 });
        }
        first.hits.iter().map(|hit| (hit.t, hit.triangle)).collect()
    }

    const SHOWN: [(f32, u32); 6] = [(2.0, 7), (1.0, 9), (2.0, 7), (2.0, 3), (0.5, 1), (2.0, 3)];

    #[test]
    fn hits_are_kept_in_order_and_once() {
        assert_eq!(keep(9, &SHOWN), [(0.5, 1), (1.0, 9), (2.0, 3), (2.0, 7)]);
    }

    #[test]
    fn no_more_are_kept_than_wanted() {
        assert_eq!(keep(3, &SHOWN), [(0.5, 1), (1.0, 9), (2.0, 3)]);
        assert_eq!(keep(1, &SHOWN), [(0.5, 1)]);
    }

    /// Slanted triangles behind and through each other, in one leaf: those that are behind another are hit
    /// where that one is not accepted, or lies before the ray begins.
    #[test]
    fn the_closest_of_those_that_are_accepted() {
        let slant = |index: u32| 0.3 * (index % 3) as f32;
        let corners: Vec<_> = (0..8)
            .map(|index| (index, 0.2 * (index / 2) as f32 + slant(index)))
            .flat_map(|(index, z)| [[0.0, 0.0, z], [4.0, 0.0, z + slant(index)], [0.0, 4.0, z]])
            .collect();
        let triangles: Vec<_> = (0..8).map(|index| [0, 1, 2].map(|at| 3 * index + at)).collect();
        let mesh = Mesh::new(&corners, &triangles).expect("sound");
        let options = BuildOptions { max_leaf: 8, ..BuildOptions::default() };
        let tree = Tree::build(&mesh, &options).expect("sound options");
        assert_eq!(tree.references().len(), 8, "one leaf");
        let (mut state, mut hits) = (31, 0);
        for simd in Best::each() {
            let trip = Trip::new(&mesh, &tree, simd);
            for round in 0..20_000_u32 {
                let [x, y, t_min] = [(); 3].map(|()| noise(&mut state));
                let accept = |triangle: u32| round >> triangle & 1 == 1;
                let ray = Ray { t_min, ..Ray::new([3.0 * x, 3.0 * y, -0.5], [0.0, 0.1, 1.0]) };
                let mut closest = Closest::new(&ray, accept);
                traverse(&trip, &ray, &mut closest);
                let hit = |index: &u32| intersect(&ray, *index, &mesh.triangle(*index as usize));
                let expected = (0..8).filter(|index| accept(*index)).filter_map(|it| hit(&it));
                let expected = expected.reduce(|a, b| if comes_before(&b, &a) { b } else { a });
                assert_eq!(closest.hit, expected, "{}: {ray:?}", simd.name());
                hits += u32::from(expected.is_some());
            }
        }
        assert!(hits > 10_000, "{hits} hits");
    }
}
