//! Show the leaves along a ray to whoever asks.

use std::ops::ControlFlow;

use super::Tracer;
use super::block::Block;
use super::pending::{Pending, Visit};
use super::prepare::{Slabs, greater, lesser};
use super::wide::Wide;
use crate::geometry::Ray;

/// A leaf that a ray passes through, or a part of it: a leaf of more than eight triangles comes as
/// parts that lie apart, each with its own interval, if that keeps rays away from some of them.
#[derive(Clone, Copy)]
pub struct Leaf<'a> {
    /// Where the ray enters it; no later leaf is entered before.
    pub t_min: f32,
    /// Where the ray leaves it.
    pub t_max: f32,
    blocks: &'a [Block],
}

impl Leaf<'_> {
    /// The triangles that have a part in the leaf, each once.
    pub fn triangles(&self) -> impl Iterator<Item = u32> + '_ {
        self.blocks.iter().flat_map(Block::triangles)
    }
}

impl Tracer {
    /// Shows the leaves along the ray to `visit`, front to back, until it breaks: what the other
    /// queries are made of.
    ///
    /// Their `t_min` never falls. Every hit of the ray is in the interval of some leaf that holds
    /// its triangle; in the intervals of others its triangle may have no part. Intervals are a few
    /// roundings longer than the part of the ray in the leaf, so those of neighbours overlap by
    /// that much, and a ray along the face between two leaves comes to both.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use kdray::trace::intersect;
    /// use kdray::{BuildOptions, Hit, Mesh, Ray, Tracer, Tree};
    ///
    /// let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
    /// let tracer = Tracer::new(&mesh, &Tree::build(&mesh, &BuildOptions::default())?);
    /// let ray = Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
    /// let mut closest: Option<Hit> = None;
    /// tracer.visit_leaves(&ray, |leaf| {
    ///     if closest.is_some_and(|hit| hit.t < leaf.t_min) {
    ///         return ControlFlow::Break(());
    ///     }
    ///     for triangle in leaf.triangles() {
    ///         let hit = intersect(&ray, triangle, &mesh.triangle(triangle as usize));
    ///         closest = closest.into_iter().chain(hit).min_by(|a, b| a.t.total_cmp(&b.t));
    ///     }
    ///     ControlFlow::Continue(())
    /// });
    /// assert_eq!(closest.map(|hit| hit.t), Some(1.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn visit_leaves<'a>(
        &'a self,
        ray: &Ray,
        mut visit: impl FnMut(Leaf<'a>) -> ControlFlow<()>,
    ) {
        if !ray.is_valid() {
            return;
        }
        let slabs = Slabs::new(ray, self.trip.hull.reach);
        let mut pending = Pending::root();
        while let Some(Visit { child, near, far }) = pending.pop() {
            let Some(first) = child.block() else {
                push_met(&self.trip.layout.wides[child.0 as usize], &slabs, ray, &mut pending);
                continue;
            };
            let blocks = self.trip.layout.blocks_of(child, first);
            if visit(Leaf { t_min: near, t_max: far, blocks }).is_break() {
                return;
            }
        }
    }
}

/// Pushes the children of a wide node that the ray meets.
fn push_met(wide: &Wide, slabs: &Slabs, ray: &Ray, pending: &mut Pending) {
    let (mut near, mut far) = ([ray.t_min; 8], [ray.t_max; 8]);
    for axis in 0..3 {
        let backward = slabs.backward[axis];
        for child in 0..8 {
            let first = wide.bounds[backward][axis][child] * slabs.inverse[axis];
            let last = wide.bounds[1 - backward][axis][child] * slabs.inverse[axis];
            near[child] = greater(near[child], first - slabs.enter[axis]);
            far[child] = lesser(far[child], last - slabs.leave[axis]);
        }
    }
    for child in (0..8).filter(|child| near[*child] <= far[*child]) {
        let (near, far) = (near[child], far[child]);
        pending.push_in_order(Visit { child: wide.children[child], near, far });
    }
}
