//! Rays that are asked for and counted.

use kdray::{Counts, Ray, Tracer};

use crate::point::Point;
use crate::scene::Scene;

/// Asks the scene and counts what the tree was asked.
pub(crate) struct Probe<'a> {
    scene: &'a Scene<'a>,
    tracer: &'a Tracer,
    /// Rays that were traced through the tree.
    pub(crate) rays: u64,
    /// Those of them that hit a triangle.
    pub(crate) hits: u64,
}

impl<'a> Probe<'a> {
    pub(crate) fn new(scene: &'a Scene<'a>, tracer: &'a Tracer) -> Self {
        Self { scene, tracer, rays: 0, hits: 0 }
    }

    /// The first surface along the ray.
    pub(crate) fn closest(&mut self, ray: &Ray) -> Option<Point> {
        let hit = self.tracer.closest_hit(ray);
        self.count(hit.is_some());
        self.scene.point(ray, hit.as_ref())
    }

    /// Whether a surface is in the way.
    pub(crate) fn occluded(&mut self, ray: &Ray) -> bool {
        if self.scene.ground_point(ray).is_some() {
            return true;
        }
        let hit = self.tracer.any_hit(ray);
        self.count(hit);
        hit
    }

    /// What the ray costs in the tree.
    pub(crate) fn cost(&mut self, ray: &Ray) -> Counts {
        let (hit, counts) = self.tracer.closest_hit_counted(ray);
        self.count(hit.is_some());
        counts
    }

    fn count(&mut self, hit: bool) {
        self.rays += 1;
        self.hits += u64::from(hit);
    }
}
