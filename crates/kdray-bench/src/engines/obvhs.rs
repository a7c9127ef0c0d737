//! obvhs: a binary BVH and a compressed wide BVH, built by PLOC with reinsertion.
//!
//! Rays go through the crate's own traversals and its own triangle test. Triangles are put in
//! the order of the leaves after the build, as the crate's documentation advises.

use std::time::Duration;

use anyhow::Result;
use glam::Vec3A;
use kdray::{Mesh, Ray};
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::triangle::Triangle;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::definition::{Mode, ObvhsTree};
use crate::engine::{Builder, Engine, Hit, Index};

pub(crate) struct Obvhs {
    tree: ObvhsTree,
}

impl Obvhs {
    pub(crate) fn new(tree: ObvhsTree) -> Self {
        Self { tree }
    }
}

impl Engine for Obvhs {
    fn builder(&self, threads: usize) -> Result<Box<dyn Builder>> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
        Ok(Box::new(PoolBuilder { tree: self.tree, pool }))
    }
}

struct PoolBuilder {
    tree: ObvhsTree,
    pool: ThreadPool,
}

impl Builder for PoolBuilder {
    fn build(&self, mesh: &Mesh) -> Result<Box<dyn Index>> {
        let triangles = triangles(mesh);
        Ok(self.pool.install(|| build(self.tree, &triangles)))
    }
}

fn build(tree: ObvhsTree, triangles: &[Triangle]) -> Box<dyn Index> {
    let parameters = BvhBuildParams::medium_build();
    let mut time = Duration::ZERO;
    match tree {
        ObvhsTree::Bvh2Medium => {
            let bvh = build_bvh2_from_tris(triangles, parameters, &mut time);
            let triangles = in_order(triangles, &bvh.primitive_indices);
            Box::new(Traced { bvh, triangles })
        }
        ObvhsTree::CwbvhMedium => {
            let bvh = build_cwbvh_from_tris(triangles, parameters, &mut time);
            let triangles = in_order(triangles, &bvh.primitive_indices);
            Box::new(Traced { bvh, triangles })
        }
    }
}

/// The mesh's triangles with 16-byte vertices.
pub(super) fn triangles(mesh: &Mesh) -> Vec<Triangle> {
    let triangle = |index| {
        let [v0, v1, v2] = mesh.triangle(index).map(Vec3A::from_array);
        Triangle { v0, v1, v2 }
    };
    (0..mesh.triangles().len()).map(triangle).collect()
}

/// The ray in the form that [`Triangle::intersect`] takes.
pub(super) fn obvhs_ray(ray: &Ray) -> obvhs::ray::Ray {
    let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
    obvhs::ray::Ray::new(origin, direction, ray.t_min, ray.t_max)
}

fn in_order(triangles: &[Triangle], order: &[u32]) -> Vec<Triangle> {
    order.iter().map(|&index| triangles[index as usize]).collect()
}

struct Traced<T> {
    bvh: T,
    /// In the order of the leaves.
    triangles: Vec<Triangle>,
}

/// What the two trees of obvhs offer alike.
trait Traverse: Send + Sync {
    fn closest(
        &self,
        ray: obvhs::ray::Ray,
        hit: &mut RayHit,
        test: impl FnMut(&obvhs::ray::Ray, usize) -> f32,
    ) -> bool;
    fn misses(
        &self,
        ray: obvhs::ray::Ray,
        test: impl FnMut(&obvhs::ray::Ray, usize) -> f32,
    ) -> bool;
    fn triangle(&self, slot: u32) -> u32;
}

macro_rules! traverse {
    ($tree:ty) => {
        impl Traverse for $tree {
            fn closest(
                &self,
                ray: obvhs::ray::Ray,
                hit: &mut RayHit,
                test: impl FnMut(&obvhs::ray::Ray, usize) -> f32,
            ) -> bool {
                self.ray_traverse(ray, hit, test)
            }
            fn misses(
                &self,
                ray: obvhs::ray::Ray,
                test: impl FnMut(&obvhs::ray::Ray, usize) -> f32,
            ) -> bool {
                self.ray_traverse_miss(ray, test)
            }
            fn triangle(&self, slot: u32) -> u32 {
                self.primitive_indices[slot as usize]
            }
        }
    };
}

traverse!(Bvh2);
traverse!(CwBvh);

impl<T: Traverse> Index for Traced<T> {
    fn closest(&self, _mode: Mode, rays: &[Ray], hits: &mut [Hit]) {
        for (ray, answer) in rays.iter().zip(hits) {
            let mut hit = RayHit::none();
            let test = |ray: &obvhs::ray::Ray, slot: usize| self.triangles[slot].intersect(ray);
            let found = self.bvh.closest(obvhs_ray(ray), &mut hit, test);
            *answer = match found {
                true => Hit { t: hit.t, triangle: self.bvh.triangle(hit.primitive_id) },
                false => Hit::MISS,
            };
        }
    }

    fn any(&self, _mode: Mode, rays: &[Ray], occluded: &mut [bool]) {
        for (ray, answer) in rays.iter().zip(occluded) {
            let test = |ray: &obvhs::ray::Ray, slot: usize| self.triangles[slot].intersect(ray);
            *answer = !self.bvh.misses(obvhs_ray(ray), test);
        }
    }
}
