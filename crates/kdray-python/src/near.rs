//! Queries with many points.

use std::ops::Range;

use kdray::{Aabb, Batch, BatchError, ClosestPoint, Frame, Sign, Tracer};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{Rows, Values, zeros};
use crate::columns::Columns;
use crate::each::lists;
use crate::error;
use crate::rays::blocks;
use crate::run::Watch;

/// Points that are in the core's form at a time.
const BLOCK: usize = 1 << 18;

/// What is asked for points, and where the mesh stands.
pub(crate) struct Points<'a> {
    pub(crate) tracer: &'a Tracer,
    pub(crate) frame: Frame,
    pub(crate) points: Rows<'a>,
}

impl Points<'_> {
    /// Whether each is inside.
    pub(crate) fn inside(&self, sign: Sign<'_>, watch: &Watch) -> PyResult<Vec<bool>> {
        let mut inside = zeros(self.points.len())?;
        self.in_blocks(watch, |block, batch, points| {
            batch.contains(points, sign, &mut inside[block])
        })?;
        Ok(inside)
    }

    /// Distances in world units, negative inside; infinite where there is nothing.
    pub(crate) fn signed_distances(&self, sign: Sign<'_>, watch: &Watch) -> PyResult<Vec<f64>> {
        let mut distances: Vec<f64> = zeros(self.points.len())?;
        self.in_blocks(watch, |block, batch, points| {
            let mut found = vec![None; points.len()];
            batch.signed_distances(points, sign, &mut found)?;
            for (distance, found) in distances[block].iter_mut().zip(found) {
                *distance = self.frame.scale * found.map_or(f64::INFINITY, f64::from);
            }
            Ok(())
        })?;
        Ok(distances)
    }

    /// Closest points: where they are, in world coordinates, how far away, and as hits on which
    /// triangle. Where there is none, the point is NaN.
    pub(crate) fn closest(
        &self,
        max_distance: f64,
        watch: &Watch,
    ) -> PyResult<(Vec<[f64; 3]>, Vec<f64>, Columns)> {
        let count = self.points.len();
        let (mut places, mut distances) = (zeros(count)?, zeros(count)?);
        let mut columns = Columns::new(count)?;
        let limit = (max_distance / self.frame.scale) as f32;
        self.in_blocks(watch, |block, batch, points| {
            let mut found = vec![None; points.len()];
            batch.closest_points(points, limit, &mut found)?;
            for (place, closest) in block.zip(found) {
                (places[place], distances[place]) = match closest {
                    Some(ClosestPoint { point, distance, .. }) => {
                        (self.frame.world_point(point), self.frame.scale * f64::from(distance))
                    }
                    None => ([f64::NAN; 3], f64::INFINITY),
                };
                let on = closest.map_or((-1, 0.0, 0.0), |it| (it.triangle as i32, it.u, it.v));
                (columns.triangle[place], columns.u[place], columns.v[place]) = on;
            }
            Ok(())
        })?;
        Ok((places, distances, columns))
    }

    /// Lets `ask` ask for some points after the others.
    fn in_blocks(
        &self,
        watch: &Watch,
        mut ask: impl FnMut(Range<usize>, &Batch<'_>, &[[f32; 3]]) -> Result<(), BatchError>,
    ) -> PyResult<()> {
        let local = |index| self.points.local(index, &self.frame);
        let batch = self.tracer.batch(watch.batch_options()).map_err(error::value)?;
        for block in blocks(self.points.len(), BLOCK) {
            let points: Vec<[f32; 3]> = block.clone().into_par_iter().map(local).collect();
            ask(block, &batch, &points).map_err(error::value)?;
        }
        Ok(())
    }
}

/// The triangles within a distance of each point: where each point's begin, and which they are.
pub(crate) fn within_spheres(
    (tracer, frame): (&Tracer, &Frame),
    centers: &Rows<'_>,
    radii: &Values<'_>,
    watch: &Watch,
) -> PyResult<(Vec<i64>, Vec<i32>)> {
    let (offsets, triangles) = lists(centers.len(), watch, |index, triangles| {
        let radius = (f64::from(radii.get(index)) / frame.scale) as f32;
        tracer.within_sphere(centers.local(index, frame), radius, triangles);
    })?;
    Ok((offsets, signed(triangles)))
}

/// The triangles that reach into each box: where each box's begin, and which they are.
pub(crate) fn within_boxes(
    (tracer, frame): (&Tracer, &Frame),
    (lower, upper): (&Rows<'_>, &Rows<'_>),
    watch: &Watch,
) -> PyResult<(Vec<i64>, Vec<i32>)> {
    let (offsets, triangles) = lists(lower.len(), watch, |index, triangles| {
        let region = Aabb { lower: lower.local(index, frame), upper: upper.local(index, frame) };
        tracer.within_box(&region, triangles);
    })?;
    Ok((offsets, signed(triangles)))
}

/// Triangles as Python has them, in one piece.
fn signed(triangles: Vec<Vec<u32>>) -> Vec<i32> {
    triangles.iter().flatten().map(|triangle| *triangle as i32).collect()
}
