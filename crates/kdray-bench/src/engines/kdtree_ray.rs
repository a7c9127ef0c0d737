//! kdtree-ray: an exact-SAH kd-tree without clipping, with its default costs.
//!
//! Its query returns every triangle of every leaf that the whole line of the ray passes; the
//! caller tests them all, here by the triangle test of obvhs.

use std::env;

use anyhow::Result;
use cgmath::Vector3;
use kdray::{Mesh, Ray};
use kdtree_ray::{AABB, Bounded, KDTree};
use obvhs::triangle::Triangle;

use super::obvhs::{obvhs_ray, triangles};
use crate::definition::Mode;
use crate::engine::{Builder, Engine, Hit, Index};

pub(crate) struct KdtreeRay;

impl Engine for KdtreeRay {
    fn builder(&self, threads: usize) -> Result<Box<dyn Builder>> {
        Ok(Box::new(Threads(threads)))
    }
}

struct Threads(usize);

impl Builder for Threads {
    fn build(&self, mesh: &Mesh) -> Result<Box<dyn Index>> {
        anyhow::ensure!(!mesh.triangles().is_empty(), "kdtree-ray cannot build an empty scene");
        let triangles: Vec<_> = triangles(mesh).into_iter().map(Shape).collect();
        // The crate makes its own thread pool, whose size only this variable sets.
        // SAFETY: builds run while no other thread does: tracing threads are joined, and the
        // workers of idle pools read no environment.
        unsafe { env::set_var("RAYON_NUM_THREADS", self.0.to_string()) };
        let tree = KDTree::build(&triangles);
        Ok(Box::new(Traced { tree, triangles }))
    }
}

struct Shape(Triangle);

impl Bounded for Shape {
    fn bound(&self) -> AABB {
        let bounds = self.0.aabb();
        AABB::new(vector(bounds.min.to_array()), vector(bounds.max.to_array()))
    }
}

struct Traced {
    tree: KDTree,
    triangles: Vec<Shape>,
}

impl Traced {
    /// Distances to the triangles of the candidate list that the ray hits.
    fn crossings(&self, ray: &Ray) -> impl Iterator<Item = Hit> {
        let candidates = self.tree.intersect(&vector(ray.origin), &vector(ray.direction));
        let ray = obvhs_ray(ray);
        let hit = move |index: usize| {
            let t = self.triangles[index].0.intersect(&ray);
            t.is_finite().then_some(Hit { t, triangle: index as u32 })
        };
        candidates.into_iter().filter_map(hit)
    }
}

impl Index for Traced {
    fn closest(&self, _mode: Mode, rays: &[Ray], hits: &mut [Hit]) {
        for (ray, answer) in rays.iter().zip(hits) {
            let nearer = |a: Hit, b: Hit| if b.t < a.t { b } else { a };
            *answer = self.crossings(ray).fold(Hit::MISS, nearer);
        }
    }

    fn any(&self, _mode: Mode, rays: &[Ray], occluded: &mut [bool]) {
        for (ray, answer) in rays.iter().zip(occluded) {
            *answer = self.crossings(ray).next().is_some();
        }
    }
}

fn vector(v: [f32; 3]) -> Vector3<f32> {
    v.into()
}
