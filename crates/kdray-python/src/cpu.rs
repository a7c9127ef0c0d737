//! Rays answered on the CPU.

use std::ops::{ControlFlow, Range};

use kdray::{Batch, BatchError, BatchOptions, Hit, Lists, Ray};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::zeros;
use crate::columns::{Columns, Part};
use crate::error;
use crate::order::{self, Order};
use crate::rays::Rays;
use crate::run::Watch;
use crate::scene::Scene;

/// Rays that a thread brings into the core's form and asks at a time. They and their hits fit the
/// nearest cache; the core takes as many for one thread.
const CHUNK: usize = 1024;

/// A ray that hits nothing, where one will be.
const NOTHING: Ray = Ray { origin: [0.0; 3], t_min: 0.0, direction: [0.0; 3], t_max: 0.0 };

/// The most rays that are brought in order together. More of them go together better, and fit a
/// cache worse.
const WINDOW: usize = 64 * CHUNK;

/// The most rays whose hits are listed together. What the lists of some rays have taken is there
/// for those of the next.
const LISTED: usize = 16 * CHUNK;

/// Rays, and what answers them.
pub(crate) struct Asked<'a, 'r> {
    pub(crate) rays: &'a Rays<'r>,
    pub(crate) scene: &'a Scene,
    pub(crate) watch: &'a Watch,
}

impl Asked<'_, '_> {
    pub(crate) fn closest(&self) -> PyResult<Columns> {
        let mut columns = Columns::new(self.rays.len())?;
        let ask = |batch: &Batch<'_>, rays: &[Ray], hits: &mut [_]| batch.closest_hits(rays, hits);
        if let Some(window) = self.window() {
            let put = |part: &mut Part<'_>, place, hit| part.set(place, hit);
            self.in_windows(window, columns.parts(window), ask, put)?;
        } else {
            self.in_chunks(columns.parts(CHUNK), |batch, rays, part| {
                let mut hits = [None; CHUNK];
                let hits = &mut hits[..rays.len()];
                ask(batch, rays, hits)?;
                part.put(hits.iter().copied());
                Ok(())
            })?;
        }
        Ok(columns)
    }

    pub(crate) fn any(&self) -> PyResult<Vec<bool>> {
        let mut found: Vec<bool> = zeros(self.rays.len())?;
        let ask = |batch: &Batch<'_>, rays: &[Ray], found: &mut [_]| batch.any_hits(rays, found);
        if let Some(window) = self.window() {
            let put = |part: &mut &mut [bool], place: usize, found| part[place] = found;
            self.in_windows(window, found.par_chunks_mut(window), ask, put)?;
        } else {
            self.in_chunks(found.par_chunks_mut(CHUNK), ask)?;
        }
        Ok(found)
    }

    pub(crate) fn count(&self) -> PyResult<Vec<i32>> {
        let mut counts: Vec<i32> = zeros(self.rays.len())?;
        self.in_chunks(counts.par_chunks_mut(CHUNK), |batch, rays, counts| {
            batch.count_hits(rays, bytemuck::cast_slice_mut(counts))
        })?;
        Ok(counts)
    }

    /// The first `limit` hits of every ray, one ray after the other, and where each ray's begin.
    pub(crate) fn all(&self, limit: usize) -> PyResult<(Vec<i64>, Columns)> {
        let size = self.share(LISTED);
        let mut offsets: Vec<i64> = zeros(self.rays.len() + 1)?;
        let mut found = vec![Vec::new(); self.rays.len().div_ceil(size)];
        let parts = offsets[1..].par_chunks_mut(size).zip(found.par_iter_mut());
        let list = |(part, (counts, found)): (usize, (&mut [i64], &mut Vec<Hit>))| {
            let range = self.range(size, part);
            let rays: Vec<Ray> = range.clone().map(|index| self.rays.get(index)).collect();
            let batch = self.batch_of(range, 1)?;
            let mut counts = counts.iter_mut();
            let take = |lists: Lists<'_, Hit>| {
                for (list, count) in lists.lists().zip(counts.by_ref()) {
                    *count = list.len() as i64;
                }
                found.extend_from_slice(lists.items);
                ControlFlow::Continue(())
            };
            batch.first_hits(&rays, limit, take)
        };
        parts.enumerate().try_for_each(list).map_err(|error: BatchError| error::value(error))?;
        let mut end = 0;
        for offset in &mut offsets {
            end += *offset;
            *offset = end;
        }
        Ok((offsets, Columns::of_lists(&found)?))
    }

    /// Rays that are worth being brought in order together, if that is worth it. Only for rays
    /// that see everything.
    fn window(&self) -> Option<usize> {
        let sees_all = self.rays.mask.is_none() && self.rays.except(0..0).is_none();
        let window = self.share(WINDOW);
        (sees_all && order::pays(self.rays, window, self.scene)).then_some(window)
    }

    /// Rays that a thread takes at a time, whole chunks of them: some times for each thread, so
    /// that all end at about the same time, and no more than `most`.
    fn share(&self, most: usize) -> usize {
        let share = self.rays.len() / (8 * rayon::current_num_threads());
        share.next_multiple_of(CHUNK).clamp(CHUNK, most)
    }

    /// Lets `ask` answer the rays chunk by chunk. There is a part of the answers for each.
    fn in_chunks<A: Send>(
        &self,
        answers: impl IndexedParallelIterator<Item = A>,
        ask: impl Fn(&Batch<'_>, &[Ray], A) -> Result<(), BatchError> + Sync,
    ) -> PyResult<()> {
        let of_chunk = |(chunk, answers): (usize, A)| {
            let range = self.range(CHUNK, chunk);
            let mut local = [NOTHING; CHUNK];
            let local = &mut local[..range.len()];
            self.rays.copy(range.clone(), local);
            ask(&self.batch(range)?, local, answers)
        };
        answers.enumerate().try_for_each(of_chunk).map_err(error::value)
    }

    /// Lets `ask` answer the rays window by window, those near each other one after the other, and
    /// `put` the answers into their places in the window's part of the answers.
    fn in_windows<A: Send, H: Copy + Default>(
        &self,
        window: usize,
        answers: impl IndexedParallelIterator<Item = A>,
        ask: impl Fn(&Batch<'_>, &[Ray], &mut [H]) -> Result<(), BatchError> + Sync,
        put: impl Fn(&mut A, usize, H) + Sync,
    ) -> PyResult<()> {
        let bounds = self.scene.tree.bounds();
        let of_window = |order: &mut Order, (index, mut answers): (usize, A)| {
            let range = self.range(window, index);
            let batch = self.batch(0..0)?;
            order.take(self.rays, range, bounds);
            for places in order.places().chunks(CHUNK) {
                let (mut rays, mut found) = ([NOTHING; CHUNK], [H::default(); CHUNK]);
                rays.iter_mut().zip(places).for_each(|(ray, place)| *ray = order.ray(*place));
                let found = &mut found[..places.len()];
                ask(&batch, &rays[..places.len()], found)?;
                for (place, found) in places.iter().zip(found) {
                    put(&mut answers, *place as usize, *found);
                }
            }
            Ok(())
        };
        let done = answers.enumerate().try_for_each_init(Order::default, of_window);
        done.map_err(|error: BatchError| error::value(error))
    }

    /// Which rays are in a part, of parts of `count`.
    fn range(&self, count: usize, part: usize) -> Range<usize> {
        count * part..self.rays.len().min(count * (part + 1))
    }

    /// What answers some of the rays.
    fn batch(&self, range: Range<usize>) -> Result<Batch<'_>, BatchError> {
        self.batch_of(range, 0)
    }

    /// The same on so many threads; 0 for all, and 1 for the one that asks.
    fn batch_of(&self, range: Range<usize>, threads: usize) -> Result<Batch<'_>, BatchError> {
        self.scene.tracer().batch(BatchOptions {
            threads,
            visible: self.rays.mask,
            except: self.rays.except(range),
            ..self.watch.batch_options()
        })
    }
}
