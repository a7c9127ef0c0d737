//! Rays.

use std::ops::ControlFlow;

use super::fill::Chunk;
use super::{Batch, BatchError, Lists};
use crate::geometry::{Hit, Ray};
use crate::trace::Only;
use crate::trace::hits::{Any, Closest};
use crate::trace::stream::trace;
use crate::trace::traverse::Visitor;

/// Queries of rays. They panic if there are not as many answers, or triangles in
/// [`BatchOptions::except`](super::BatchOptions::except), as rays.
impl Batch<'_> {
    /// Writes to `hits[i]` the [closest hit](crate::Tracer::closest_hit) of `rays[i]`.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<(), BatchError> {
        if self.sees_all() {
            return self.ask_all(rays, hits, |ray| Closest::new(ray, |_| true), |it| it.hit);
        }
        self.ask(rays, hits, |index, ray| self.seen_by(index).closest_hit(ray))
    }

    /// Writes to `hits[i]` whether `rays[i]` [hits anything](crate::Tracer::any_hit).
    pub fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) -> Result<(), BatchError> {
        if self.sees_all() {
            return self.ask_all(rays, hits, |ray| Any::new(ray, |_| true), |it| it.found);
        }
        self.ask(rays, hits, |index, ray| self.seen_by(index).any_hit(ray))
    }

    /// Writes to `counts[i]` [how many triangles](crate::Tracer::count_hits) `rays[i]` hits.
    pub fn count_hits(&self, rays: &[Ray], counts: &mut [u32]) -> Result<(), BatchError> {
        self.ask(rays, counts, |index, ray| self.seen_by(index).count_hits(ray) as u32)
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
        let ask = |index: usize, ray: &Ray, hits: &mut Vec<Hit>| {
            self.seen_by(index).first_hits(ray, limit, hits);
        };
        self.stream(rays, ask, sink)
    }

    /// Gives `sink` [all hits](crate::Tracer::all_hits) of each ray, as [`Batch::first_hits`].
    pub fn all_hits(
        &self,
        rays: &[Ray],
        sink: impl FnMut(Lists<Hit>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        self.first_hits(rays, usize::MAX, sink)
    }

    fn ask<A: Default + Send>(
        &self,
        rays: &[Ray],
        answers: &mut [A],
        ask: impl Fn(usize, &Ray) -> A + Sync,
    ) -> Result<(), BatchError> {
        self.check_except(rays);
        let ask = |(): &mut (), index: usize, ray: &Ray| ask(index, ray);
        self.fill(rays, answers, self.options.reorder, |ray| self.key_of_ray(ray), ask)
    }

    /// Rays that see every triangle: several at a time, unless they go the same way.
    fn ask_all<V: Visitor, A: Default + Send>(
        &self,
        rays: &[Ray],
        answers: &mut [A],
        begin: impl Fn(&Ray) -> V + Sync,
        answer: impl Fn(V) -> A + Sync,
    ) -> Result<(), BatchError> {
        let trip = &self.tracer.trip;
        let begin = |ray: &Ray| ray.is_valid().then(|| begin(ray));
        let ask = |chunk: &Chunk<Ray>, answers: &mut [A]| {
            answers.fill_with(A::default);
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

    fn sees_all(&self) -> bool {
        self.options.visible.is_none() && self.options.except.is_none()
    }

    /// What the ray with this index sees.
    fn seen_by(&self, index: usize) -> Only<'_, impl Fn(u32) -> bool> {
        let except = self.options.except.map(|except| except[index]);
        let visible = self.options.visible;
        self.tracer.only(move |triangle| {
            Some(triangle) != except && visible.is_none_or(|visible| visible[triangle as usize])
        })
    }
}
