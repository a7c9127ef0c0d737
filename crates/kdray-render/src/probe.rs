//! Rays that are asked for and counted.

use kdray::{Counts, Ray};

use crate::point::Point;
use crate::scene::Scene;

/// Asks the scene and counts what the tree was asked.
pub(crate) struct Probe<'a> {
    scene: &'a Scene<'a>,
    /// Rays that were traced through the tree.
    pub(crate) rays: u64,
    /// Those of them that hit a triangle.
    pub(crate) hits: u64,
}

impl<'a> Probe<'a> {
    pub(crate) fn new(scene: &'a Scene<'a>) -> Self {
        Self { scene, rays: 0, hits: 0 }
    }

    /// The first surface along the ray.
    pub(crate) fn closest(&mut self, ray: &Ray) -> Option<Point> {
        let hit = self.scene.tracer.closest_hit(ray);
        self.count(hit.is_some());
        let t_max = hit.map_or(ray.t_max, |hit| hit.t);
        let ground = self.scene.ground_point(&Ray { t_max, ..*ray });
        ground.or_else(|| Some(self.scene.mesh_point(ray, &hit?)))
    }

    /// Whether a surface is in the way.
    pub(crate) fn occluded(&mut self, ray: &Ray) -> bool {
        if self.scene.ground_point(ray).is_some() {
            return true;
        }
        let hit = self.scene.tracer.any_hit(ray);
        self.count(hit);
        hit
    }

    /// What the ray costs in the tree.
    pub(crate) fn cost(&mut self, ray: &Ray) -> Counts {
        let (hit, counts) = self.scene.tracer.closest_hit_counted(ray);
        self.count(hit.is_some());
        counts
    }

    fn count(&mut self, hit: bool) {
        self.rays += 1;
        self.hits += u64::from(hit);
    }
}
