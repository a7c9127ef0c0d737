//! Rays.

use std::ops::ControlFlow;

use super::fill::Chunk;
use super::stream::Found;
use super::{Batch, BatchError, Lists};
use crate::geometry::{Hit, Ray};
use crate::trace::hits::{Any, Closest};
use crate::trace::lists;
use crate::trace::stream::trace;
use crate::trace::traverse::Visitor;

/// Queries of rays. They panic if there are not as many answers, or triangles in
/// [`BatchOptions::except`](super::BatchOptions::except), as rays.
impl Batch<'_> {
    /// Writes to `hits[i]` the [closest hit](crate::Tracer::closest_hit) of `rays[i]`.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<(), BatchError> {
        let begin = |except, ray: &Ray| Closest::new(ray, self.accept(except));
        self.ask(rays, hits, begin, |it| it.hit)
    }

    /// Writes to `hits[i]` whether `rays[i]` [hits anything](crate::Tracer::any_hit).
    pub fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) -> Result<(), BatchError> {
        let begin = |except, ray: &Ray| Any::new(ray, self.accept(except));
        self.ask(rays, hits, begin, |it| it.found)
    }

    /// Writes to `counts[i]` [how many triangles](crate::Tracer::count_hits) `rays[i]` hits.
    pub fn count_hits(&self, rays: &[Ray], counts: &mut [u32]) -> Result<(), BatchError> {
        self.check_except(rays);
        let ask = |chunk: &Chunk<Ray>, counts: &mut [u32]| {
            counts.fill(0);
            let accept = |place: usize| self.accept(self.except(|| (chunk.index)(place)));
            let end = |place: usize, count| counts[place] = count as u32;
            lists::count_hits(&self.tracer.trip, chunk.queries, accept, end);
        };
        self.fill_chunks(rays, counts, self.options.reorder, |ray| self.key_of_ray(ray), ask)
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
        self.check_except(rays);
        // No ray hits more triangles than there are: without a limit none needs to go from front to back.
        let limit = if limit < self.tracer.triangle_count { limit } else { usize::MAX };
        let ask = |first: usize, rays: &[Ray], found: &mut Found<Hit>| {
            let accept = |index: usize| self.accept(self.except(|| first + index));
            let mut room = std::mem::take(&mut found.room);
            let end = |_: usize, hits: &[Hit]| found.add(hits);
            lists::first_hits(&self.tracer.trip, rays, limit, accept, &mut room, end);
            found.room = room;
        };
        self.stream_groups(rays, ask, sink)
    }

    /// Gives `sink` [all hits](crate::Tracer::all_hits) of each ray, as [`Batch::first_hits`].
    pub fn all_hits(
        &self,
        rays: &[Ray],
        sink: impl FnMut(Lists<Hit>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        self.first_hits(rays, usize::MAX, sink)
    }

    /// Writes to `answers[i]` what `answer` makes of the visitor that `begin` gives for `rays[i]` and the
    /// triangle that it does not see, when it has seen what the ray comes to.
    fn ask<V: Visitor, A: Default + Send>(
        &self,
        rays: &[Ray],
        answers: &mut [A],
        begin: impl Fn(Option<u32>, &Ray) -> V + Sync,
        answer: impl Fn(&V) -> A + Sync,
    ) -> Result<(), BatchError> {
        self.check_except(rays);
        let trip = &self.tracer.trip;
        let ask = |chunk: &Chunk<Ray>, answers: &mut [A]| {
            answers.fill_with(A::default);
            let begin =
                |place: usize, ray: &Ray| Some(begin(self.except(|| (chunk.index)(place)), ray));
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

    /// The triangle that a ray does not see, by its index, which is asked for only if there is one.
    fn except(&self, index: impl FnOnce() -> usize) -> Option<u32> {
        self.options.except.map(|except| except[index()])
    }

    /// Which triangles a ray sees that does not see one of them.
    fn accept(&self, except: Option<u32>) -> impl Fn(u32) -> bool + use<'_> {
        let options = &self.options;
        move |triangle| {
            let is_visible = |visible: &[bool]| visible[triangle as usize];
            Some(triangle) != except && options.visible.is_none_or(is_visible)
        }
    }
}
