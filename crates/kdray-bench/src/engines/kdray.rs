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

impl Index for Traced {
    fn closest(&self, _mode: Mode, rays: &[Ray], hits: &mut [Hit]) {
        for (ray, answer) in rays.iter().zip(hits) {
            *answer = match self.0.closest_hit(ray) {
                Some(hit) => Hit { t: hit.t, triangle: hit.triangle },
                None => Hit::MISS,
            };
        }
    }

    fn any(&self, _mode: Mode, rays: &[Ray], occluded: &mut [bool]) {
        for (ray, answer) in rays.iter().zip(occluded) {
            *answer = self.0.any_hit(ray);
        }
    }
}
