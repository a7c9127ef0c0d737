//! Queries with many rays.

use std::ops::Range;

use bytemuck::Zeroable;
use kdray::{Batch, BatchError, BatchOptions, Frame, Hit, Mesh, Ray, Tracer};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{Rows, Scalars, Values, Vectors, row, zeros};
use crate::error;
use crate::run::Watch;

/// Rays or points that a thread takes at a time, and looks whether to go on.
pub(crate) const CHUNK: usize = 256;

/// Rays or points that are in the core's form at a time.
const BLOCK: usize = 1 << 16;

/// What a query with rays is asked, as a tuple: origins, directions, the least and the largest `t`,
/// by ray a triangle that does not count, by triangle whether it counts at all, and threads.
#[derive(FromPyObject)]
pub(crate) struct Arguments<'py>(
    Vectors<'py>,
    Vectors<'py>,
    Scalars<'py>,
    Scalars<'py>,
    Option<PyReadonlyArray1<'py, i32>>,
    Option<PyReadonlyArray1<'py, bool>>,
    pub(crate) usize,
);

/// [`Arguments`] that fit together.
pub(crate) struct Rays<'a> {
    origins: Rows<'a>,
    directions: Rows<'a>,
    t_min: Values<'a>,
    t_max: Values<'a>,
    exclude: Option<&'a [i32]>,
    mask: Option<&'a [bool]>,
    frame: Frame,
}

/// Closest hits by column; `t` is infinite and `triangle` -1 where there is none.
pub(crate) struct Columns {
    pub(crate) t: Vec<f32>,
    pub(crate) triangle: Vec<i32>,
    pub(crate) u: Vec<f32>,
    pub(crate) v: Vec<f32>,
}

impl Arguments<'_> {
    /// The rays, over `mesh`.
    pub(crate) fn over(&self, mesh: &Mesh) -> PyResult<Rays<'_>> {
        let Self(origins, directions, t_min, t_max, exclude, mask, _) = self;
        let rays = Rays {
            origins: origins.rows()?,
            directions: directions.rows()?,
            t_min: t_min.values()?,
            t_max: t_max.values()?,
            exclude: exclude.as_ref().map(|array| array.as_slice()).transpose()?,
            mask: mask.as_ref().map(|array| array.as_slice()).transpose()?,
            frame: mesh.frame(),
        };
        let count = rays.len();
        let fits = rays.directions.len() == count
            && rays.t_min.fits(count)
            && rays.t_max.fits(count)
            && rays.exclude.is_none_or(|exclude| exclude.len() == count);
        if !fits {
            return Err(PyValueError::new_err("arrays of different lengths"));
        }
        let triangles = mesh.triangles().len();
        match rays.mask {
            Some(mask) if mask.len() != triangles => {
                let found = mask.len();
                let message = format!("mask has {found} values for {triangles} triangles");
                Err(PyValueError::new_err(message))
            }
            _ => Ok(rays),
        }
    }
}

impl Rays<'_> {
    pub(crate) fn len(&self) -> usize {
        self.origins.len()
    }

    #[inline]
    fn get(&self, index: usize) -> Ray {
        let (t_min, t_max) = (self.t_min.get(index), self.t_max.get(index));
        match (&self.origins, &self.directions) {
            (Rows::Single(origins), Rows::Single(directions)) if self.frame == Frame::IDENTITY => {
                let (origin, direction) = (row(origins, index), row(directions, index));
                Ray { origin, t_min, direction, t_max }
            }
            (origins, directions) => {
                self.frame.local_ray(origins.world(index), directions.world(index), t_min, t_max)
            }
        }
    }

    /// Whether a triangle counts for a ray.
    #[inline]
    fn sees(&self, ray: usize, triangle: u32) -> bool {
        self.exclude.is_none_or(|exclude| exclude[ray] != triangle as i32)
            && self.mask.is_none_or(|mask| mask[triangle as usize])
    }

    pub(crate) fn closest(&self, tracer: &Tracer, watch: &Watch) -> PyResult<Columns> {
        let mut columns = Columns::new(self.len())?;
        let mut hits = vec![None; self.len().min(BLOCK)];
        self.in_blocks(tracer, watch, |block, batch, rays| {
            let hits = &mut hits[..rays.len()];
            batch.closest_hits(rays, hits)?;
            columns.put(block, hits);
            Ok(())
        })?;
        Ok(columns)
    }

    pub(crate) fn any(&self, tracer: &Tracer, watch: &Watch) -> PyResult<Vec<bool>> {
        let mut answers = zeros(self.len())?;
        self.in_blocks(tracer, watch, |block, batch, rays| {
            batch.any_hits(rays, &mut answers[block])
        })?;
        Ok(answers)
    }

    pub(crate) fn count(&self, tracer: &Tracer, watch: &Watch) -> PyResult<Vec<i32>> {
        let mut answers: Vec<i32> = zeros(self.len())?;
        self.in_blocks(tracer, watch, |block, batch, rays| {
            batch.count_hits(rays, bytemuck::cast_slice_mut(&mut answers[block]))
        })?;
        Ok(answers)
    }

    /// Lets `ask` ask for some rays after the others, which bounds the memory that they take in
    /// the core's form.
    fn in_blocks(
        &self,
        tracer: &Tracer,
        watch: &Watch,
        mut ask: impl FnMut(Range<usize>, &Batch<'_>, &[Ray]) -> Result<(), BatchError>,
    ) -> PyResult<()> {
        let mut rays = Vec::new();
        for block in blocks(self.len()) {
            (block.clone().into_par_iter().map(|index| self.get(index)))
                .collect_into_vec(&mut rays);
            let options = BatchOptions {
                visible: self.mask,
                except: self.exclude.map(|exclude| bytemuck::cast_slice(&exclude[block.clone()])),
                ..watch.batch_options()
            };
            let batch = tracer.batch(options).map_err(error::value)?;
            ask(block, &batch, &rays).map_err(error::value)?;
        }
        Ok(())
    }

    /// The first `limit` hits of every ray, one ray after the other, and where each ray's begin.
    pub(crate) fn all(
        &self,
        tracer: &Tracer,
        limit: usize,
        watch: &Watch,
    ) -> PyResult<(Vec<i64>, Columns)> {
        let (offsets, hits) = lists(self.len(), watch, |ray, hits: &mut Vec<Hit>| {
            tracer.only(|other| self.sees(ray, other)).first_hits(&self.get(ray), limit, hits);
        })?;
        let mut columns = Columns::new(hits.iter().map(Vec::len).sum())?;
        for (place, hit) in hits.iter().flatten().enumerate() {
            columns.t[place] = hit.t;
            columns.triangle[place] = hit.triangle as i32;
            columns.u[place] = hit.u;
            columns.v[place] = hit.v;
        }
        Ok((offsets, columns))
    }
}

impl Columns {
    /// Puts hits into their places.
    fn put(&mut self, block: Range<usize>, hits: &[Option<Hit>]) {
        let Self { t, triangle, u, v } = self;
        let columns = (&mut t[block.clone()], &mut triangle[block.clone()]);
        let weights = (&mut u[block.clone()], &mut v[block]);
        let places = (hits, columns.0, columns.1, weights.0, weights.1).into_par_iter();
        places.for_each(|(hit, t, triangle, u, v)| {
            (*t, *triangle, *u, *v) = match hit {
                Some(hit) => (hit.t, hit.triangle as i32, hit.u, hit.v),
                None => (f32::INFINITY, -1, 0.0, 0.0),
            };
        });
    }

    pub(crate) fn new(count: usize) -> PyResult<Self> {
        Ok(Self { t: zeros(count)?, triangle: zeros(count)?, u: zeros(count)?, v: zeros(count)? })
    }
}

/// The numbers below `count`, some at a time.
pub(crate) fn blocks(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count).step_by(BLOCK).map(move |start| start..count.min(start + BLOCK))
}

/// By item what `ask` says of it.
pub(crate) fn each<T: Send + Zeroable>(
    count: usize,
    watch: &Watch,
    ask: impl Fn(usize) -> T + Sync,
) -> PyResult<Vec<T>> {
    let mut answers = zeros(count)?;
    answers.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, answers)| {
        if !watch.is_cancelled() {
            for (index, answer) in answers.iter_mut().enumerate() {
                *answer = ask(CHUNK * chunk + index);
            }
        }
    });
    Ok(answers)
}

/// By item a list: where each list begins, and the lists of a chunk of items together. `ask`
/// leaves an item's list in the vector, whatever was in there.
pub(crate) fn lists<T: Send + Copy>(
    count: usize,
    watch: &Watch,
    ask: impl Fn(usize, &mut Vec<T>) + Sync,
) -> PyResult<(Vec<i64>, Vec<Vec<T>>)> {
    let mut offsets: Vec<i64> = zeros(count + 1)?;
    let of_chunk = |(chunk, lengths): (usize, &mut [i64])| {
        let (mut all, mut list) = (Vec::new(), Vec::new());
        if !watch.is_cancelled() {
            for (index, length) in lengths.iter_mut().enumerate() {
                ask(CHUNK * chunk + index, &mut list);
                *length = list.len() as i64;
                all.extend_from_slice(&list);
            }
        }
        all
    };
    let lists = offsets[1..].par_chunks_mut(CHUNK).enumerate().map(of_chunk).collect();
    let mut end = 0;
    for offset in &mut offsets {
        end += *offset;
        *offset = end;
    }
    Ok((offsets, lists))
}
