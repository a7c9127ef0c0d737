//! Points and regions.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::fill::Chunk;
use super::options::Meter;
use super::{Batch, BatchError, CHUNK, Lists};
use crate::geometry::Aabb;
use crate::trace::closest::Seeds;
use crate::trace::grid::Grid;
use crate::trace::{ClosestPoint, Sign};

/// Queries of points. They panic if there are not as many answers as points, and see every
/// triangle.
impl Batch<'_> {
    /// Writes to `closest[i]` the [closest point](crate::Tracer::closest_point) of `points[i]`
    /// within `max_distance`. Points near each other are always asked one after the other.
    pub fn closest_points(
        &self,
        points: &[[f32; 3]],
        max_distance: f32,
        closest: &mut [Option<ClosestPoint>],
    ) -> Result<(), BatchError> {
        let ask = |seeds: &mut Seeds, _: usize, point: &_| {
            self.tracer.closest_near(*point, max_distance, seeds)
        };
        self.fill(points, closest, true, |point| self.key_of_point(point), ask)
    }

    /// Writes to `distances[i]` the [signed distance](crate::Tracer::signed_distance) of
    /// `points[i]`, as [`Batch::closest_points`].
    pub fn signed_distances(
        &self,
        points: &[[f32; 3]],
        sign: Sign,
        distances: &mut [Option<f32>],
    ) -> Result<(), BatchError> {
        let ask = |seeds: &mut Seeds, _: usize, point: &_| {
            Some(self.tracer.closest_near(*point, f32::INFINITY, seeds)?.distance)
        };
        let mut inside = vec![false; points.len()];
        let key = |point: &_| self.key_of_point(point);
        self.part(0.0..0.8).fill(points, distances, true, key, ask)?;
        self.part(0.8..1.0).contains(points, sign, &mut inside)?;
        for (distance, inside) in distances.iter_mut().zip(inside) {
            *distance = distance.map(|distance| if inside { -distance } else { distance });
        }
        Ok(())
    }

    /// Writes to `inside[i]` whether `points[i]` is inside. By parity, most points are looked up in
    /// cells of which it is known, as soon as enough have been asked; the answers are those of
    /// [`Tracer::contains`](crate::Tracer::contains).
    pub fn contains(
        &self,
        points: &[[f32; 3]],
        sign: Sign,
        inside: &mut [bool],
    ) -> Result<(), BatchError> {
        match sign {
            Sign::Parity => match self.team.run(|| self.tracer.grid_for(points.len())) {
                None => self.ask_ways_out(points, inside),
                Some(grid) => self.look_and_ask(grid, points, inside),
            },
            Sign::Winding(winding) => {
                let ask = |(): &mut (), _: usize, point: &[f32; 3]| winding.contains(*point);
                let reorder = self.options.reorder;
                self.fill(points, inside, reorder, |point| self.key_of_point(point), ask)
            }
        }
    }

    /// Writes to `inside[i]` whether `points[i]` is inside, as their rays say.
    fn ask_ways_out(&self, points: &[[f32; 3]], inside: &mut [bool]) -> Result<(), BatchError> {
        let ask = |chunk: &Chunk<[f32; 3]>, inside: &mut [bool]| {
            self.tracer.contain(chunk.queries, inside);
        };
        self.fill_chunks(points, inside, true, |point| self.key_across(point), ask)
    }

    /// The same; rays are asked where the grid does not tell.
    fn look_and_ask(
        &self,
        grid: &Grid,
        points: &[[f32; 3]],
        inside: &mut [bool],
    ) -> Result<(), BatchError> {
        assert_eq!(points.len(), inside.len(), "one answer a point");
        let meter = Meter::new(self, points.len());
        let look = |(chunk, (points, inside)): (usize, (&[[f32; 3]], &mut [bool]))| {
            meter.check()?;
            let mut open = Vec::new();
            for (place, (point, inside)) in points.iter().zip(inside).enumerate() {
                match self.tracer.look(grid, point) {
                    Some(answer) => *inside = answer,
                    None => open.push(chunk * CHUNK + place),
                }
            }
            meter.advance(points.len() - open.len());
            Ok(open)
        };
        let chunks = points.par_chunks(CHUNK).zip(inside.par_chunks_mut(CHUNK)).enumerate();
        let open: Vec<Vec<usize>> =
            self.team.run(|| chunks.map(look).collect::<Result<_, BatchError>>())?;
        let rest: Vec<[f32; 3]> = open.iter().flatten().map(|index| points[*index]).collect();
        let mut answers = vec![false; rest.len()];
        self.part(meter.so_far()..self.share.end).ask_ways_out(&rest, &mut answers)?;
        for (index, answer) in open.into_iter().flatten().zip(answers) {
            inside[index] = answer;
        }
        Ok(())
    }

    /// Gives `sink` the [triangles within](crate::Tracer::within_sphere) `radius` of each point,
    /// as [`Batch::first_hits`] gives hits.
    pub fn within_spheres(
        &self,
        centers: &[[f32; 3]],
        radius: f32,
        sink: impl FnMut(Lists<u32>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        let ask = |center: &_, triangles: &mut _| {
            self.tracer.within_sphere(*center, radius, triangles);
        };
        self.stream(centers, ask, sink)
    }

    /// Gives `sink` the [triangles within](crate::Tracer::within_box) each region, as
    /// [`Batch::first_hits`] gives hits.
    pub fn within_boxes(
        &self,
        regions: &[Aabb],
        sink: impl FnMut(Lists<u32>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        let ask = |region: &_, triangles: &mut _| {
            self.tracer.within_box(region, triangles);
        };
        self.stream(regions, ask, sink)
    }
}
