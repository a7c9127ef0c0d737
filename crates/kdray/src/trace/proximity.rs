//! What is near a point: the closest point of the surface, and the triangles within a distance.

use super::Tracer;
use super::apart::apart;
use super::block::Block;
use super::closest::{Search, Seeds};
use super::eights::Eights;
use super::near::{NearVisitor, blocks_of, visit_box, visit_near};
use super::wide::Child;
use crate::geometry::Aabb;
use crate::geometry::nearest::nearest_on_triangle;
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
        self.closest_near(point, max_distance, &mut Seeds::default())
    }

    /// [`Tracer::closest_point`], with what the last ones have found.
    pub(super) fn closest_near(
        &self,
        point: [f32; 3],
        max_distance: f32,
        seeds: &mut Seeds,
    ) -> Option<ClosestPoint> {
        if !point.iter().all(|value| value.is_finite())
            || max_distance.is_nan()
            || max_distance < 0.0
        {
            return None;
        }
        let limit = f64::from(max_distance) * f64::from(max_distance);
        let mut search = Search::new(point, limit, seeds);
        visit_near(&self.trip, self.tilts(), point, &mut search);
        let found = search.end()?;
        seeds.add(found.triangle, &found.corners);
        Some(ClosestPoint {
            point: found.nearest.point.map(|value| value as f32),
            distance: found.nearest.squared_distance.sqrt() as f32,
            triangle: found.triangle,
            u: found.nearest.u as f32,
            v: found.nearest.v as f32,
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
        visit_near(&self.trip, self.tilts(), center, &mut within);
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
            for lane in block.places() {
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
pub(super) fn rounded_up(value: f64) -> f32 {
    let rounded = value as f32;
    if f64::from(rounded) < value { rounded.next_up() } else { rounded }
}

/// Collects the triangles within a sphere, some more than once.
struct Within<'a> {
    center: [f32; 3],
    limit: f64,
    triangles: &'a mut Vec<u32>,
}

impl<'a> NearVisitor<'a> for Within<'_> {
    #[inline(always)]
    fn start<E: Eights>(&mut self, _point: &[E; 3]) -> f32 {
        rounded_up(self.limit)
    }

    fn is_far(&self) -> bool {
        false
    }

    #[inline(always)]
    fn leaves<E: Eights>(&mut self, blocks: &'a [Block], leaves: &[Child], point: &[E; 3]) -> f32 {
        let until = rounded_up(self.limit);
        for block in leaves.iter().flat_map(|leaf| blocks_of(blocks, *leaf)) {
            let least = apart(block, point).least.numbers();
            for lane in block.places().filter(|lane| least[*lane] <= until) {
                let (triangle, corners) = block.triangle(lane);
                if nearest_on_triangle(self.center, &corners).squared_distance <= self.limit {
                    self.triangles.push(triangle);
                }
            }
        }
        until
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::noise::noise;
    use crate::trace::simd::Best;
    use crate::{BatchOptions, BuildOptions, Mesh, Tree};

    #[test]
    fn the_plain_way_and_batches_find_what_the_fast_way_finds() {
        let mut state = 9;
        let mut any = || noise(&mut state);
        let corner = |[x, y, z]: [f32; 3], any: &mut dyn FnMut() -> f32| {
            [x + 0.1 * any(), y + 0.1 * any(), z + 0.1 * any()]
        };
        let soup: Vec<[f32; 3]> = (0..2000)
            .flat_map(|_| {
                let place = [any(), any(), any()];
                [(); 3].map(|()| corner(place, &mut any))
            })
            .collect();
        let triangles: Vec<_> = (0..2000).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect();
        let mesh = Mesh::new(&soup, &triangles).expect("sound");
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let (fast, mut plain) = (Tracer::new(&mesh, &tree), Tracer::new(&mesh, &tree));
        plain.trip.simd = Best::Plain;
        let points = (0..1000).map(|_| [any(), any(), any()].map(|v| 1.6 * v - 0.3));
        let points: Vec<_> = points.chain(soup[..500].to_vec()).collect();
        let mut batched = vec![None; points.len()];
        let batch = fast.batch(BatchOptions::default()).expect("the threads are there");
        batch.closest_points(&points, f32::INFINITY, &mut batched).expect("nobody cancels");
        let (mut some, mut others) = (Vec::new(), Vec::new());
        for (point, batched) in points.iter().zip(batched) {
            let found = fast.closest_point(*point, f32::INFINITY);
            assert_eq!(found, plain.closest_point(*point, f32::INFINITY), "{point:?}");
            assert_eq!(found, batched, "{point:?}");
            fast.within_sphere(*point, 0.1, &mut some);
            plain.within_sphere(*point, 0.1, &mut others);
            assert_eq!(some, others, "{point:?}");
        }
    }
}
