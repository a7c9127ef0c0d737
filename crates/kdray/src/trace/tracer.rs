//! Queries for one ray.

use super::block::Block;
use super::leaves::Leaves;
use super::prepare::{Shear, Slabs, reach};
use super::traverse::{Next, traverse};
use crate::geometry::{Aabb, Hit, Mesh, Ray};
use crate::tree::Tree;

/// Answers queries over a mesh and its tree. Owns what it needs; share it between threads.
///
/// Takes about 40 bytes a reference: triangles are copied in leaf order, eight to a block.
pub struct Tracer {
    leaves: Leaves,
    bounds: Aabb,
    reach: f32,
}

/// What a ray met on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Inner nodes.
    pub steps: u32,
    /// Leaves, the empty ones included.
    pub leaves: u32,
    /// Blocks of up to eight triangles.
    pub tests: u32,
}

/// Sees what a query meets.
trait Observer {
    fn step(&mut self) {}
    fn leaf(&mut self, _blocks: usize) {}
}

impl Observer for () {}

impl Observer for Counts {
    fn step(&mut self) {
        self.steps += 1;
    }

    fn leaf(&mut self, blocks: usize) {
        self.leaves += 1;
        self.tests += blocks as u32;
    }
}

impl Tracer {
    /// A tracer for `mesh` through its `tree`.
    ///
    /// # Panics
    ///
    /// If the tree is of another number of triangles.
    #[must_use]
    pub fn new(mesh: &Mesh, tree: &Tree) -> Self {
        assert_eq!(mesh.triangles().len(), tree.triangle_count(), "the tree is of another mesh");
        let bounds = tree.bounds();
        Self { leaves: Leaves::new(mesh, tree), bounds, reach: reach(&bounds) }
    }

    /// The first triangle along the ray; of several at one `t` the one with the lowest index.
    ///
    /// Exactly the hit that [`intersect`](super::intersect()) gives for that triangle. Watertight: no ray
    /// slips between triangles that share an edge. [PH04], [WBA13]
    #[must_use]
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.find_closest(ray, &mut ())
    }

    /// [`Tracer::closest_hit`], and what it took.
    #[must_use]
    pub fn closest_hit_counted(&self, ray: &Ray) -> (Option<Hit>, Counts) {
        let mut counts = Counts::default();
        (self.find_closest(ray, &mut counts), counts)
    }

    /// Whether anything is hit.
    #[must_use]
    pub fn any_hit(&self, ray: &Ray) -> bool {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.any_avx2(ray) };
        }
        self.any_lanes(ray)
    }

    /// Bytes that the tracer holds.
    #[must_use]
    pub fn size_bytes(&self) -> usize {
        size_of_val(&self.leaves.nodes[..]) + size_of_val(&self.leaves.blocks[..])
    }

    fn find_closest(&self, ray: &Ray, observer: &mut impl Observer) -> Option<Hit> {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.closest_avx2(ray, observer) };
        }
        self.closest_lanes(ray, observer)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn closest_avx2(&self, ray: &Ray, observer: &mut impl Observer) -> Option<Hit> {
        self.closest_lanes(ray, observer)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn any_avx2(&self, ray: &Ray) -> bool {
        self.any_lanes(ray)
    }

    #[inline(always)]
    fn closest_lanes(&self, ray: &Ray, observer: &mut impl Observer) -> Option<Hit> {
        let mut closest: Option<Hit> = None;
        let mut t_max = ray.t_max;
        let observer = std::cell::RefCell::new(observer);
        self.visit(ray, || observer.borrow_mut().step(), |blocks, shear| {
            observer.borrow_mut().leaf(blocks.len());
            for block in blocks {
                block.intersect(shear, [ray.t_min, t_max], |hit| {
                    let first = |best: Hit| (hit.t, hit.triangle) < (best.t, best.triangle);
                    if closest.is_none_or(first) {
                        closest = Some(hit);
                        t_max = hit.t;
                    }
                });
            }
            Next::Until(t_max)
        });
        closest
    }

    #[inline(always)]
    fn any_lanes(&self, ray: &Ray) -> bool {
        let mut any = false;
        self.visit(ray, || (), |blocks, shear| {
            for block in blocks {
                block.intersect(shear, [ray.t_min, ray.t_max], |_| any = true);
                if any {
                    return Next::Stop;
                }
            }
            Next::Until(ray.t_max)
        });
        any
    }

    /// Visits the leaves along the ray from front to back.
    #[inline(always)]
    fn visit(&self, ray: &Ray, step: impl FnMut(), mut leaf: impl FnMut(&[Block], &Shear) -> Next) {
        if !ray.is_valid() {
            return;
        }
        let shear = Shear::new(ray);
        let slabs = Slabs::new(ray, self.reach);
        let Leaves { nodes, blocks } = &self.leaves;
        let interval = [ray.t_min, ray.t_max];
        traverse(nodes, &self.bounds, &slabs, interval, step, |first, count| {
            leaf(&blocks[first..first + count], &shear)
        });
    }
}
