//! Queries for one ray.

use super::prepare::{Prepared, reach};
use super::traverse::{ENOUGH, Visitor, traverse};
use super::wide::Layout;
use crate::geometry::{Aabb, Hit, Mesh, Ray};
use crate::tree::Tree;

/// Answers queries over a mesh and its tree. Owns what it needs; share it between threads.
///
/// Takes about 40 bytes a reference: triangles are copied in leaf order, eight to a block.
pub struct Tracer {
    layout: Layout,
    bounds: Aabb,
    reach: f32,
}

/// What a ray met on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Wide nodes: three levels of the tree each.
    pub steps: u32,
    /// Leaves that have references.
    pub leaves: u32,
    /// Blocks of up to eight triangles.
    pub tests: u32,
}

impl Tracer {
    /// A tracer for `mesh` through its `tree`.
    ///
    /// # Panics
    ///
    /// If the tree is of another number of triangles.
    #[must_use]
    pub fn new(mesh: &Mesh, tree: &Tree) -> Self {
        assert_eq!(
            mesh.triangles().len(),
            tree.triangle_count(),
            "the tree is of another mesh"
        );
        let bounds = tree.bounds();
        Self {
            layout: Layout::new(mesh, tree),
            bounds,
            reach: reach(&bounds),
        }
    }

    /// The first triangle along the ray; of several at one `t` the one with the lowest index.
    ///
    /// Exactly the hit that [`intersect`](super::intersect()) gives for that triangle. Watertight: no ray
    /// slips between triangles that share an edge. [PH04], [WBA13]
    #[must_use]
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut closest = Closest::new(ray);
        self.visit(ray, &mut closest);
        closest.hit
    }

    /// [`Tracer::closest_hit`], and what it took.
    #[must_use]
    pub fn closest_hit_counted(&self, ray: &Ray) -> (Option<Hit>, Counts) {
        let mut counted = Counted {
            closest: Closest::new(ray),
            counts: Counts::default(),
        };
        self.visit(ray, &mut counted);
        (counted.closest.hit, counted.counts)
    }

    /// Whether anything is hit.
    #[must_use]
    pub fn any_hit(&self, ray: &Ray) -> bool {
        let mut any = Any {
            t_min: ray.t_min,
            t_max: ray.t_max,
            found: false,
        };
        self.visit(ray, &mut any);
        any.found
    }

    /// Bytes that the tracer holds.
    #[must_use]
    pub fn size_bytes(&self) -> usize {
        size_of_val(&self.layout.wides[..]) + size_of_val(&self.layout.blocks[..])
    }

    /// Shows what lies along the ray from front to back.
    fn visit(&self, ray: &Ray, visitor: &mut impl Visitor) {
        if ray.is_valid() {
            let prepared = Prepared::new(ray, self.reach);
            traverse(&self.layout, &self.bounds, &prepared, visitor);
        }
    }
}

/// Keeps the first hit.
struct Closest {
    t_min: f32,
    t_max: f32,
    hit: Option<Hit>,
}

impl Closest {
    fn new(ray: &Ray) -> Self {
        Self {
            t_min: ray.t_min,
            t_max: ray.t_max,
            hit: None,
        }
    }
}

impl Visitor for Closest {
    #[inline(always)]
    fn hit(&mut self, hit: Hit) -> f32 {
        let tie = || self.hit.is_none_or(|best| hit.triangle < best.triangle);
        if self.t_min <= hit.t && (hit.t < self.t_max || hit.t == self.t_max && tie()) {
            self.t_max = hit.t;
            self.hit = Some(hit);
        }
        self.t_max
    }
}

/// Counts while it looks for the first hit.
struct Counted {
    closest: Closest,
    counts: Counts,
}

impl Visitor for Counted {
    fn hit(&mut self, hit: Hit) -> f32 {
        self.closest.hit(hit)
    }

    fn step(&mut self) {
        self.counts.steps += 1;
    }

    fn leaf(&mut self) {
        self.counts.leaves += 1;
    }

    fn test(&mut self) {
        self.counts.tests += 1;
    }
}

/// Is content with any hit.
struct Any {
    t_min: f32,
    t_max: f32,
    found: bool,
}

impl Visitor for Any {
    #[inline(always)]
    fn hit(&mut self, hit: Hit) -> f32 {
        self.found = self.t_min <= hit.t && hit.t <= self.t_max;
        if self.found { ENOUGH } else { self.t_max }
    }
}
