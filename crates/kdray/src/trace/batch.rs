//! Queries for many rays, over the threads of the current `rayon` pool.

use rayon::prelude::*;

use super::Tracer;
use crate::geometry::{Hit, Ray};

/// Rays that a thread takes at a time: long enough to hide the hand-over, short enough to share
/// the last ones out.
const CHUNK: usize = 1024;

impl Tracer {
    /// Writes to `hits[i]` the closest hit of `rays[i]`.
    ///
    /// # Panics
    ///
    /// If there are not as many hits as rays.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.batch(rays, hits, |ray| self.closest_hit(ray));
    }

    /// Writes to `hits[i]` whether `rays[i]` hits anything.
    ///
    /// # Panics
    ///
    /// If there are not as many hits as rays.
    pub fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        self.batch(rays, hits, |ray| self.any_hit(ray));
    }

    fn batch<T: Send>(&self, rays: &[Ray], answers: &mut [T], ask: impl Fn(&Ray) -> T + Sync) {
        assert_eq!(rays.len(), answers.len(), "one answer a ray");
        rays.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).for_each(|(rays, answers)| {
            for (ray, answer) in rays.iter().zip(answers) {
                *answer = ask(ray);
            }
        });
    }
}
