//! Queries for one ray, among the triangles that the caller accepts.

use super::hits::{Any, Closest, Counted, Crossings, FirstHits};
use super::{Counts, Tracer};
use crate::geometry::{Hit, Ray};

/// A [`Tracer`] that sees some triangles only; made by [`Tracer::only`].
pub struct Only<'a, F> {
    tracer: &'a Tracer,
    accept: F,
}

impl<'a, F: Fn(u32) -> bool> Only<'a, F> {
    pub(super) fn new(tracer: &'a Tracer, accept: F) -> Self {
        Self { tracer, accept }
    }

    /// As [`Tracer::closest_hit`].
    #[inline]
    #[must_use]
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut closest = Closest::new(ray, &self.accept);
        self.tracer.visit(ray, &mut closest);
        closest.hit
    }

    /// As [`Tracer::closest_hit_counted`].
    #[must_use]
    pub fn closest_hit_counted(&self, ray: &Ray) -> (Option<Hit>, Counts) {
        let mut counted = Counted::new(ray, &self.accept);
        self.tracer.visit(ray, &mut counted);
        (counted.closest.hit, counted.counts)
    }

    /// As [`Tracer::any_hit`].
    #[inline]
    #[must_use]
    pub fn any_hit(&self, ray: &Ray) -> bool {
        let mut any = Any::new(ray, &self.accept);
        self.tracer.visit(ray, &mut any);
        any.found
    }

    /// As [`Tracer::first_hits`].
    pub fn first_hits(&self, ray: &Ray, limit: usize, hits: &mut Vec<Hit>) {
        hits.clear();
        if limit > 0 {
            let mut first = FirstHits::new(ray, limit, &self.accept, std::mem::take(hits));
            self.tracer.visit(ray, &mut first);
            *hits = first.hits;
        }
    }

    /// As [`Tracer::all_hits`].
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        self.first_hits(ray, usize::MAX, hits);
    }

    /// As [`Tracer::count_hits`].
    #[must_use]
    pub fn count_hits(&self, ray: &Ray) -> usize {
        let mut crossings = Crossings::new(ray, &self.accept);
        self.tracer.visit(ray, &mut crossings);
        crossings.count()
    }
}
