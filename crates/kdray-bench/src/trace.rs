//! Tracing a ray set on the runner's own threads, and comparing what engines answer.

use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use kdray::Ray;

use crate::definition::{Mode, Query};
use crate::engine::{Hit, Index};

/// Rays a thread takes at a time: a multiple of every packet size, and long enough that threads
/// seldom meet at the queue or at the ends of each other's answers.
const RUN: usize = 4096;

/// Distances that differ by more than this share are different hits.
const TOLERANCE: f32 = 1e-4;

/// One answer per ray.
#[derive(Clone, Debug)]
pub(crate) enum Answers {
    Closest(Vec<Hit>),
    Any(Vec<bool>),
}

impl Answers {
    /// Room for `count` answers.
    pub(crate) fn new(query: Query, count: usize) -> Answers {
        match query {
            Query::Closest => Answers::Closest(vec![Hit::MISS; count]),
            Query::Any => Answers::Any(vec![false; count]),
        }
    }

    /// Rays that hit something.
    pub(crate) fn hits(&self) -> usize {
        match self {
            Answers::Closest(hits) => hits.iter().filter(|hit| hit.is_hit()).count(),
            Answers::Any(occluded) => occluded.iter().filter(|occluded| **occluded).count(),
        }
    }

    /// Share of the rays on which two engines disagree: one hits and the other does not, or
    /// their distances differ by more than 1e-4 of the greater.
    pub(crate) fn disagreement(&self, other: &Answers) -> f64 {
        match (self, other) {
            (Answers::Closest(a), Answers::Closest(b)) => share(a, b, differ),
            (Answers::Any(a), Answers::Any(b)) => share(a, b, |a, b| a != b),
            _ => 1.0,
        }
    }
}

fn share<T: Copy>(a: &[T], b: &[T], differ: impl Fn(T, T) -> bool) -> f64 {
    let count = a.iter().zip(b).filter(|(a, b)| differ(**a, **b)).count();
    count as f64 / a.len().max(1) as f64
}

fn differ(a: Hit, b: Hit) -> bool {
    match (a.is_hit(), b.is_hit()) {
        (true, true) => (a.t - b.t).abs() > TOLERANCE * a.t.abs().max(b.t.abs()),
        (false, false) => false,
        _ => true,
    }
}

/// Traces all rays on `threads` threads and returns the wall time.
pub(crate) fn trace(
    index: &dyn Index,
    mode: Mode,
    rays: &[Ray],
    threads: usize,
    answers: &mut Answers,
) -> Duration {
    match answers {
        Answers::Closest(hits) => {
            in_parallel(rays, hits, threads, |rays, hits| index.closest(mode, rays, hits))
        }
        Answers::Any(occluded) => {
            in_parallel(rays, occluded, threads, |rays, occluded| index.any(mode, rays, occluded))
        }
    }
}

fn in_parallel<T: Send>(
    rays: &[Ray],
    answers: &mut [T],
    threads: usize,
    work: impl Fn(&[Ray], &mut [T]) + Sync,
) -> Duration {
    let runs = Mutex::new(rays.chunks(RUN).zip(answers.chunks_mut(RUN)));
    let next = || runs.lock().unwrap_or_else(PoisonError::into_inner).next();
    let start = Instant::now();
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((rays, answers)) = next() {
                    work(rays, answers);
                }
            });
        }
    });
    start.elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(t: f32) -> Hit {
        Hit { t, triangle: 0 }
    }

    #[test]
    fn disagreement_is_a_share_of_the_rays() {
        let a = Answers::Closest(vec![hit(1.0), hit(1.0), hit(1.0), Hit::MISS]);
        let b = Answers::Closest(vec![hit(1.000_01), hit(1.001), Hit::MISS, Hit::MISS]);
        assert_eq!(a.disagreement(&b), 0.5);
        assert_eq!(a.disagreement(&a), 0.0);
        let (c, d) = (Answers::Any(vec![true, false]), Answers::Any(vec![true, true]));
        assert_eq!(c.disagreement(&d), 0.5);
    }

    #[test]
    fn every_ray_is_answered_in_its_place_on_any_number_of_threads() {
        let ray = |i: usize| Ray::new([i as f32, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let rays: Vec<_> = (0..3 * RUN + 7).map(ray).collect();
        for threads in [1, 2, 5] {
            let mut answers = vec![0.0; rays.len()];
            in_parallel(&rays, &mut answers, threads, |rays, answers| {
                rays.iter().zip(answers).for_each(|(ray, answer)| *answer = ray.origin[0]);
            });
            assert!(answers.iter().enumerate().all(|(i, answer)| *answer == i as f32));
        }
    }
}
