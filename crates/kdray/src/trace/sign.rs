//! Inside or outside, and distances that say which.

use std::sync::atomic::Ordering::Relaxed;

use super::Tracer;
use super::grid::Grid;
use super::hits::Crossings;
use super::stream::in_packets;
use crate::geometry::{Aabb, Ray};
use crate::winding::Winding;

/// How inside is told from outside.
#[derive(Clone, Copy, Default)]
pub enum Sign<'a> {
    /// By [`Tracer::contains`], the parity of crossings: right for every closed mesh, however its
    /// triangles are wound, and fast. A mesh with a hole leaks.
    #[default]
    Parity,
    /// By [`Winding::contains`]: for meshes that are not closed but wound consistently. A hole is
    /// bridged by where the mesh winds half a time around.
    Winding(&'a Winding),
}

/// The grid is made when so many points have been asked for every triangle. About then rays have
/// taken half as long as it takes: sooner, few points would pay for it, and later, many would wait
/// for it.
const POINTS_PER_TRIANGLE: usize = 2;

impl Sign<'_> {
    pub(super) fn is_inside(self, tracer: &Tracer, point: [f32; 3]) -> bool {
        match self {
            Self::Parity => tracer.contains(point),
            Self::Winding(winding) => winding.contains(point),
        }
    }

    /// The distance of a point, negative inside.
    pub(super) fn of(self, tracer: &Tracer, point: [f32; 3], distance: f32) -> f32 {
        if self.is_inside(tracer, point) { -distance } else { distance }
    }
}

impl Tracer {
    /// Whether `point` is inside: whether a line from it to infinity crosses the surface an odd
    /// number of times. The line goes along the shortest side of the bounds, to the nearer end;
    /// points beyond the bounds are outside. Right for every closed mesh, because every crossing
    /// counts exactly once; for a mesh that is not closed there is no right answer, and points on
    /// the surface may get either.
    #[must_use]
    pub fn contains(&self, point: [f32; 3]) -> bool {
        self.way_out(point).is_some_and(|ray| self.count_hits(&ray) % 2 == 1)
    }

    /// A ray from a point to infinity along the shortest side of the bounds, to the nearer end: it
    /// meets the fewest boxes. `None` for points beyond the bounds, which are outside.
    pub(super) fn way_out(&self, point: [f32; 3]) -> Option<Ray> {
        let Aabb { lower, upper } = self.bounds;
        let axis = self.shortest_side();
        let is_below = point[axis] - lower[axis] < upper[axis] - point[axis];
        let mut direction = [0.0; 3];
        direction[axis] = if is_below { -1.0 } else { 1.0 };
        self.is_within(&point).then(|| Ray::new(point, direction))
    }

    /// Whether a point is in the bounds.
    #[inline]
    fn is_within(&self, point: &[f32; 3]) -> bool {
        let Aabb { lower, upper } = &self.bounds;
        (0..3).all(|axis| lower[axis] <= point[axis] && point[axis] <= upper[axis])
    }

    /// The grid that tells of most points whether they are inside, if there is one, or if it is
    /// worth being made, now that so many points more are asked.
    pub(super) fn grid_for(&self, points: usize) -> Option<&Grid> {
        let asked = self.points_asked.fetch_add(points, Relaxed).saturating_add(points);
        if self.grid.get().is_none() && asked >= POINTS_PER_TRIANGLE * self.triangle_count {
            let made =
                Grid::new(&self.trip, self.bounds, self.shortest_side(), self.triangle_count);
            // Threads that come here at the same time all make it: one of a pool that waits takes
            // up other work, which could be to wait for what it is making.
            self.grid.get_or_init(|| made);
        }
        self.grid.get()?.as_ref()
    }

    /// Whether a point is [inside](Tracer::contains), if the grid tells.
    #[inline]
    pub(super) fn look(&self, grid: &Grid, point: &[f32; 3]) -> Option<bool> {
        if self.is_within(point) { grid.look(point) } else { Some(false) }
    }

    /// The axis along which the bounds are shortest.
    pub(super) fn shortest_side(&self) -> usize {
        let [x, y, z] = self.bounds.extent();
        if x <= y && x <= z { 0 } else { 1 + usize::from(z < y) }
    }

    /// Writes to `inside[i]` whether `points[i]` is [inside](Tracer::contains). Points whose ways
    /// out are beside each other should follow each other.
    pub(super) fn contain(&self, points: &[[f32; 3]], inside: &mut [bool]) {
        inside.fill(false);
        let ways: Vec<Option<Ray>> = points.iter().map(|point| self.way_out(*point)).collect();
        // One that goes along with the others and sees nothing.
        let nowhere = ways.iter().flatten().next().copied().unwrap_or(Ray::new([0.0; 3], [1.0; 3]));
        let rays: Vec<Ray> = ways.iter().map(|way| way.unwrap_or(nowhere)).collect();
        let begin =
            |index: usize, ray: &Ray| ways[index].is_some().then(|| Crossings::new(ray, |_| true));
        in_packets(&self.trip, &rays, begin, |index, crossings: &mut Crossings<_>| {
            inside[index] = crossings.count() % 2 == 1;
        });
    }

    /// The distance of `point` from the surface, negative inside. `None` where
    /// [`Tracer::closest_point`] finds nothing at any distance: without triangles, or for a point
    /// that is not finite.
    ///
    /// ```
    /// use kdray::{BuildOptions, Mesh, Sign, Tracer, Tree, Winding};
    ///
    /// // A tetrahedron without its floor.
    /// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let mesh = Mesh::new(&corners, &[[0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
    /// let tracer = Tracer::new(&mesh, &Tree::build(&mesh, &BuildOptions::default())?);
    /// let winding = Winding::new(&mesh);
    /// let distance = |point| tracer.signed_distance(point, Sign::Winding(&winding));
    /// assert_eq!(distance([0.125, 0.25, 0.25]), Some(-0.125));
    /// assert_eq!(distance([-0.5, 0.25, 0.25]), Some(0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn signed_distance(&self, point: [f32; 3], sign: Sign) -> Option<f32> {
        let distance = self.closest_point(point, f32::INFINITY)?.distance;
        Some(sign.of(self, point, distance))
    }
}
