//! Generated meshes.

use kdray_mesh::{Loaded, generate};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::run::run_owned;
use crate::tree::table;

/// Vertices and faces.
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i32>>);

#[pyfunction]
pub(crate) fn sphere(py: Python<'_>, subdivisions: u32) -> PyResult<Arrays<'_>> {
    made(py, move || generate::sphere(subdivisions))
}

#[pyfunction]
pub(crate) fn torus_knot(
    py: Python<'_>,
    windings: [u32; 2],
    segments: usize,
    sides: usize,
) -> PyResult<Arrays<'_>> {
    made(py, move || generate::torus_knot(windings, segments, sides))
}

#[pyfunction]
pub(crate) fn showcase(py: Python<'_>, triangles: usize) -> PyResult<Arrays<'_>> {
    made(py, move || generate::showcase(triangles))
}

fn made(py: Python<'_>, make: impl FnOnce() -> Loaded + Send + 'static) -> PyResult<Arrays<'_>> {
    let Loaded { positions, triangles, .. } = run_owned(py, 0, make)?;
    let faces = triangles.into_iter().map(|face| face.map(|index| index as i32)).collect();
    Ok((table(py, positions), table(py, faces)))
}
