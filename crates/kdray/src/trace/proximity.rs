//! What is near a point: the closest point of the surface, and the triangles within a distance.

use super::Tracer;
use super::apart::squared_bounds;
use super::block::{Block, LANES};
use super::near::{NearVisitor, visit_box, visit_near};
use crate::geometry::Aabb;
use crate::geometry::nearest::{Nearest, nearest_on_triangle};
use crate::geometry::overlap::overlaps;

/// The point of the surface closest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Where it is.
    pub point: [f32; 3],
    /// How far away it is.
    pub distance: f32,
    /// The triangle it is on; of several at the same distance the lowest.
    pub triangle: u32,
    /// Weight of the second vertex: `P = (1 - u - v) v0 + u v1 + v v2`.
    pub u: f32,
    /// Weight of the third vertex.
    pub v: f32,
}

impl Tracer {
    /// The point of the surface closest to `point`, if there is one within `max_distance`
    /// (which may be infinite). A point that is not finite has none.
    ///
    /// Worked out in double precision and rounded once. Degenerate triangles count as the
    /// segments and points that they are.
    ///
    /// ```
    /// use kdray::{BuildOptions, Mesh, Tracer, Tree};
    ///
    /// let mesh = Mesh::new(&[[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[[0, 1, 2]])?;
    /// let tracer = Tracer::new(&mesh, &Tree::build(&mesh, &BuildOptions::default())?);
    /// let closest = tracer.closest_point([3.0, 3.0, 1.0], f32::INFINITY).unwrap();
    /// assert_eq!((closest.point, closest.distance), ([2.0, 2.0, 0.0], 3_f32.sqrt()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn closest_point(&self, point: [f32; 3], max_distance: f32) -> Option<ClosestPoint> {
        if !point.iter().all(|value| value.is_finite())
            || max_distance.is_nan()
            || max_distance < 0.0
        {
            return None;
        }
        let limit = f64::from(max_distance) * f64::from(max_distance);
        let mut search = Search { point, limit, best: None };
        let until = rounded_up(limit);
        visit_near(&self.trip.layout, point, until, &mut search);
        let (triangle, nearest) = search.best?;
        Some(ClosestPoint {
            point: nearest.point.map(|value| value as f32),
            distance: nearest.squared_distance.sqrt() as f32,
            triangle,
            u: nearest.u as f32,
            v: nearest.v as f32,
        })
    }

    /// The triangles of which some point is within `radius` of `center`, in ascending order, in
    /// `triangles`. What was there before is lost; its memory is used again.
    pub fn within_sphere(&self, center: [f32; 3], radius: f32, triangles: &mut Vec<u32>) {
        triangles.clear();
        if !center.iter().all(|value| value.is_finite()) || radius.is_nan() || radius < 0.0 {
            return;
        }
        let limit = f64::from(radius) * f64::from(radius);
        let mut within = Within { center, limit, triangles };
        visit_near(&self.trip.layout, center, rounded_up(limit), &mut within);
        triangles.sort_unstable();
        triangles.dedup();
    }
}

impl Tracer {
    /// The triangles that have a point in common with `region`, touching included, in ascending
    /// order, in `triangles`. What was there before is lost; its memory is used again.
    ///
    /// The triangles themselves are tested, not only their bounds. \[AM01]
    pub fn within_box(&self, region: &Aabb, triangles: &mut Vec<u32>) {
        triangles.clear();
        if region.is_empty() || !(0..3).all(|axis| region.extent()[axis] >= 0.0) {
            return;
        }
        visit_box(&self.trip.layout, region, &mut |block| {
            for lane in 0..LANES {
                let (triangle, corners) = block.triangle(lane);
                if overlaps(&corners, region) {
                    triangles.push(triangle);
                }
            }
        });
        triangles.sort_unstable();
        triangles.dedup();
    }
}

/// A single-precision number that is not below `value`.
fn rounded_up(value: f64) -> f32 {
    let rounded = value as f32;
    if f64::from(rounded) < value { rounded.next_up() } else { rounded }
}

/// Looks for the closest point.
struct Search {
    point: [f32; 3],
    limit: f64,
    best: Option<(u32, Nearest)>,
}

impl NearVisitor for Search {
    #[inline(always)]
    fn block(&mut self, block: &Block) -> f32 {
        let bounds = squared_bounds(block, self.point);
        for lane in 0..LANES {
            // Of a free lane not even an infinite limit is in reach.
            if bounds[lane] <= rounded_up(self.limit) && bounds[lane] < f32::INFINITY {
                self.look(block.triangle(lane));
            }
        }
        rounded_up(self.limit)
    }
}

impl Search {
    #[inline]
    fn look(&mut self, (triangle, corners): (u32, [[f32; 3]; 3])) {
        let best = self.best.map(|(best, _)| best);
        if best == Some(triangle) {
            return;
        }
        let nearest = nearest_on_triangle(self.point, &corners);
        let tie = || best.is_none_or(|best| triangle < best);
        let distance = nearest.squared_distance;
        if distance < self.limit || distance == self.limit && tie() {
            self.limit = distance;
            self.best = Some((triangle, nearest));
        }
    }
}

/// Collects the triangles within a sphere, some more than once.
struct Within<'a> {
    center: [f32; 3],
    limit: f64,
    triangles: &'a mut Vec<u32>,
}

impl NearVisitor for Within<'_> {
    fn block(&mut self, block: &Block) -> f32 {
        let until = rounded_up(self.limit);
        let bounds = squared_bounds(block, self.center);
        for lane in (0..LANES).filter(|lane| bounds[*lane] <= until) {
            let (triangle, corners) = block.triangle(lane);
            if nearest_on_triangle(self.center, &corners).squared_distance <= self.limit {
                self.triangles.push(triangle);
            }
        }
        until
    }
}
