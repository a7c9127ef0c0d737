//! kdray itself, by its exact builder.

use anyhow::Result;
use kdray::{BuildOptions, Cost, Mesh, Ray, Tracer, Tree};

use crate::definition::{KdrayOptions, Mode};
use crate::engine::{Builder, Engine, Hit, Index};

pub(crate) struct Kdray {
    cost: Cost,
}

impl Kdray {
    pub(crate) fn new(options: &KdrayOptions) -> Self {
        let cost = Cost::default();
        Self {
            cost: Cost {
                traversal: options.traversal.unwrap_or(cost.traversal),
                intersect: options.intersect.unwrap_or(cost.intersect),
                empty_bonus: options.empty_bonus.unwrap_or(cost.empty_bonus),
            },
        }
    }
}

impl Engine for Kdray {
    fn builder(&self, threads: usize) -> Result<Box<dyn Builder>> {
        Ok(Box::new(TreeBuilder { cost: self.cost, threads }))
    }
}

struct TreeBuilder {
    cost: Cost,
    threads: usize,
}

impl Builder for TreeBuilder {
    fn build(&self, mesh: &Mesh) -> Result<Box<dyn Index>> {
        let options =
            BuildOptions { cost: self.cost, threads: self.threads, ..BuildOptions::default() };
        let tree = Tree::build(mesh, &options)?;
        // The tracer takes the threads of the pool that it is made in.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?;
        Ok(Box::new(Traced(pool.install(|| Tracer::new(mesh, &tree)))))
    }
}

struct Traced(Tracer);

/// Rays of a batch: as many as kdray gives one thread at a time, so that the runner's threads are
/// all there are.
const BATCH: usize = 1024;

impl Index for Traced {
    fn closest(&self, mode: Mode, rays: &[Ray], hits: &mut [Hit]) {
        if mode == Mode::Batch {
            return self.closest_in_batches(rays, hits);
        }
        for (ray, answer) in rays.iter().zip(hits) {
            *answer = hit(self.0.closest_hit(ray));
        }
    }

    fn any(&self, mode: Mode, rays: &[Ray], occluded: &mut [bool]) {
        if mode == Mode::Batch {
            let batches = rays.chunks(BATCH).zip(occluded.chunks_mut(BATCH));
            return batches.for_each(|(rays, occluded)| self.0.any_hits(rays, occluded));
        }
        for (ray, answer) in rays.iter().zip(occluded) {
            *answer = self.0.any_hit(ray);
        }
    }
}

impl Traced {
    fn closest_in_batches(&self, rays: &[Ray], hits: &mut [Hit]) {
        let mut found = [None; BATCH];
        for (rays, answers) in rays.chunks(BATCH).zip(hits.chunks_mut(BATCH)) {
            let found = &mut found[..rays.len()];
            self.0.closest_hits(rays, found);
            for (found, answer) in found.iter().zip(answers) {
                *answer = hit(*found);
            }
        }
    }
}

fn hit(found: Option<kdray::Hit>) -> Hit {
    found.map_or(Hit::MISS, |hit| Hit { t: hit.t, triangle: hit.triangle })
}
