//! Rays.

use std::cell::RefCell;
use std::ops::ControlFlow;

use super::fill::Chunk;
use super::{Batch, BatchError, Lists};
use crate::geometry::{Hit, Ray};
use crate::trace::hits::{AllHits, Any, Closest, Crossings, FirstHits};
use crate::trace::stream::trace;
use crate::trace::traverse::Visitor;

/// Queries of rays. They panic if there are not as many answers, or triangles in
/// [`BatchOptions::except`](super::BatchOptions::except), as rays.
impl Batch<'_> {
    /// Writes to `hits[i]` the [closest hit](crate::Tracer::closest_hit) of `rays[i]`.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<(), BatchError> {
        let begin = |index: usize, ray: &Ray| Closest::new(ray, self.accept(index));
        self.ask(rays, hits, begin, |it| it.hit)
    }

    /// Writes to `hits[i]` whether `rays[i]` [hits anything](crate::Tracer::any_hit).
    pub fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) -> Result<(), BatchError> {
        let begin = |index: usize, ray: &Ray| Any::new(ray, self.accept(index));
        self.ask(rays, hits, begin, |it| it.found)
    }

    /// Writes to `counts[i]` [how many triangles](crate::Tracer::count_hits) `rays[i]` hits.
    pub fn count_hits(&self, rays: &[Ray], counts: &mut [u32]) -> Result<(), BatchError> {
        let begin = |index: usize, ray: &Ray| Crossings::new(ray, self.accept(index));
        self.ask(rays, counts, begin, |it| it.count() as u32)
    }

    /// Gives `sink` the [first](crate::Tracer::first_hits) `limit` hits of each ray, in the order
    /// of the rays, some rays at a time, until it breaks. The memory that this takes does not grow
    /// with the number of rays.
    pub fn first_hits(
        &self,
        rays: &[Ray],
        limit: usize,
        sink: impl FnMut(Lists<Hit>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        let begin = |index: usize, ray: &Ray, list| {
            (limit > 0).then(|| FirstHits::new(ray, limit, self.accept(index), list))
        };
        self.list(rays, begin, |it| it.hits, sink)
    }

    /// Gives `sink` [all hits](crate::Tracer::all_hits) of each ray, as [`Batch::first_hits`].
    pub fn all_hits(
        &self,
        rays: &[Ray],
        sink: impl FnMut(Lists<Hit>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        let begin =
            |index: usize, ray: &Ray, list| Some(AllHits::new(ray, self.accept(index), list));
        self.list(rays, begin, AllHits::in_order, sink)
    }

    /// Gives `sink` the hits that `hits` makes of the visitor that `begin` gives for each ray and an
    /// empty list, when it has seen what the ray comes to.
    fn list<V: Visitor>(
        &self,
        rays: &[Ray],
        begin: impl Fn(usize, &Ray, Vec<Hit>) -> Option<V> + Sync,
        hits: impl Fn(V) -> Vec<Hit> + Sync,
        sink: impl FnMut(Lists<Hit>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        self.check_except(rays);
        let ask = |first: usize, rays: &[Ray], lists: &mut [Vec<Hit>]| {
            let lists = RefCell::new(lists);
            let begin = |index: usize, ray: &Ray| {
                let list = std::mem::take(&mut lists.borrow_mut()[index]);
                if ray.is_valid() { begin(first + index, ray, list) } else { None }
            };
            let end = |index: usize, it| lists.borrow_mut()[index] = hits(it);
            trace(&self.tracer.trip, rays, begin, end);
        };
        self.stream_groups(rays, ask, sink)
    }

    /// Writes to `answers[i]` what `answer` makes of the visitor that `begin` gives for `rays[i]`,
    /// when it has seen what the ray comes to.
    fn ask<V: Visitor, A: Default + Send>(
        &self,
        rays: &[Ray],
        answers: &mut [A],
        begin: impl Fn(usize, &Ray) -> V + Sync,
        answer: impl Fn(V) -> A + Sync,
    ) -> Result<(), BatchError> {
        self.check_except(rays);
        let trip = &self.tracer.trip;
        let ask = |chunk: &Chunk<Ray>, answers: &mut [A]| {
            answers.fill_with(A::default);
            let begin =
                |place: usize, ray: &Ray| ray.is_valid().then(|| begin((chunk.index)(place), ray));
            trace(trip, chunk.queries, begin, |index, visitor| answers[index] = answer(visitor));
        };
        let reorder = self.options.reorder;
        self.fill_chunks(rays, answers, reorder, |ray| self.key_of_ray(ray), ask)
    }

    fn check_except(&self, rays: &[Ray]) {
        if let Some(except) = self.options.except {
            assert_eq!(except.len(), rays.len(), "one triangle a ray");
        }
    }

    /// Which triangles the ray with this index sees.
    fn accept(&self, index: usize) -> impl Fn(u32) -> bool + use<'_> {
        let except = self.options.except.map(|except| except[index]);
        let visible = self.options.visible;
        move |triangle| {
            Some(triangle) != except && visible.is_none_or(|visible| visible[triangle as usize])
        }
    }
}
