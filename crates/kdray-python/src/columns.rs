//! Hits as numpy has them: a column for each of their parts.

use kdray::Hit;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::zeros;

/// `t`, `triangle`, `u` and `v`.
pub(crate) type Hits<'py> = (
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<i32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<f32>>,
);

/// Hits by column; `t` is infinite and `triangle` -1 where there is none.
pub(crate) struct Columns {
    pub(crate) t: Vec<f32>,
    pub(crate) triangle: Vec<i32>,
    pub(crate) u: Vec<f32>,
    pub(crate) v: Vec<f32>,
}

/// A part of each column.
pub(crate) struct Part<'a> {
    t: &'a mut [f32],
    triangle: &'a mut [i32],
    u: &'a mut [f32],
    v: &'a mut [f32],
}

impl Columns {
    /// Zeros.
    pub(crate) fn new(count: usize) -> PyResult<Self> {
        Ok(Self { t: zeros(count)?, triangle: zeros(count)?, u: zeros(count)?, v: zeros(count)? })
    }

    /// The columns from front to back, in parts of `count` hits.
    pub(crate) fn parts(
        &mut self,
        count: usize,
    ) -> impl IndexedParallelIterator<Item = Part<'_>> + use<'_> {
        let Self { t, triangle, u, v } = self;
        let columns = (
            t.par_chunks_mut(count),
            triangle.par_chunks_mut(count),
            u.par_chunks_mut(count),
            v.par_chunks_mut(count),
        );
        columns.into_par_iter().map(|(t, triangle, u, v)| Part { t, triangle, u, v })
    }

    /// What lists of hits have one after the other.
    pub(crate) fn of_lists(lists: &[Vec<Hit>]) -> PyResult<Self> {
        let mut columns = Self::new(lists.iter().map(Vec::len).sum())?;
        let Self { t, triangle, u, v } = &mut columns;
        let mut rest = Part { t, triangle, u, v };
        let mut parts = Vec::with_capacity(lists.len());
        for hits in lists {
            let (part, after) = rest.split(hits.len());
            parts.push((hits, part));
            rest = after;
        }
        parts.into_par_iter().for_each(|(hits, part)| part.put(hits.iter().copied().map(Some)));
        Ok(columns)
    }

    pub(crate) fn push(&mut self, hit: Option<Hit>) {
        let (t, triangle, u, v) = parts_of(hit);
        self.t.push(t);
        self.triangle.push(triangle);
        self.u.push(u);
        self.v.push(v);
    }

    pub(crate) fn into_python(self, py: Python<'_>) -> Hits<'_> {
        (
            self.t.into_pyarray(py),
            self.triangle.into_pyarray(py),
            self.u.into_pyarray(py),
            self.v.into_pyarray(py),
        )
    }
}

impl<'a> Part<'a> {
    /// The first `count` places, and the others.
    fn split(self, count: usize) -> (Self, Self) {
        let Self { t, triangle, u, v } = self;
        let (t, triangle) = (t.split_at_mut(count), triangle.split_at_mut(count));
        let (u, v) = (u.split_at_mut(count), v.split_at_mut(count));
        let first = Part { t: t.0, triangle: triangle.0, u: u.0, v: v.0 };
        (first, Part { t: t.1, triangle: triangle.1, u: u.1, v: v.1 })
    }

    pub(crate) fn set(&mut self, place: usize, hit: Option<Hit>) {
        (self.t[place], self.triangle[place], self.u[place], self.v[place]) = parts_of(hit);
    }

    /// Puts hits into their places.
    pub(crate) fn put(self, hits: impl Iterator<Item = Option<Hit>>) {
        let Self { t, triangle, u, v } = self;
        let weights = u.iter_mut().zip(v);
        for (hit, ((t, triangle), (u, v))) in hits.zip(t.iter_mut().zip(triangle).zip(weights)) {
            (*t, *triangle, *u, *v) = parts_of(hit);
        }
    }
}

fn parts_of(hit: Option<Hit>) -> (f32, i32, f32, f32) {
    hit.map_or((f32::INFINITY, -1, 0.0, 0.0), |it| (it.t, it.triangle as i32, it.u, it.v))
}
