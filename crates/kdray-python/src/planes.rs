//! Where rays meet the planes of triangles, in double precision.

use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{Rows, Vectors, threes};
use crate::each::each;
use crate::error;
use crate::run::run;
use crate::tree::{Tree, table};

/// Vertices and faces in double precision, of which the tree has been built.
type Mesh<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, i64>);

/// By hit the ray, when it is, the triangle and where on it.
type Hits<'py> = (
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, f32>,
    PyReadonlyArray1<'py, i32>,
    PyReadonlyArray1<'py, f32>,
    PyReadonlyArray1<'py, f32>,
);

#[pymethods]
impl Tree {
    /// By hit the place where its ray meets the plane of its triangle; what is known of the place
    /// by `u` and `v` where that is farther away than `reach` along an axis.
    fn meet_planes<'py>(
        &self,
        py: Python<'py>,
        mesh: Mesh<'_>,
        rays: (Vectors<'_>, Vectors<'_>),
        hits: Hits<'_>,
        reach: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (vertices, faces) = (threes(&mesh.0)?, threes(&mesh.1)?);
        let (origins, directions) = (rays.0.rows()?, rays.1.rows()?);
        let (ray, t, triangle) = (hits.0.as_slice()?, hits.1.as_slice()?, hits.2.as_slice()?);
        let (u, v) = (hits.3.as_slice()?, hits.4.as_slice()?);
        let count = ray.len();
        let are_even = [t.len(), triangle.len(), u.len(), v.len()] == [count; 4];
        let fits = faces.len() == self.triangle_count() && origins.len() == directions.len();
        let is_ray = |index: &i64| usize::try_from(*index).is_ok_and(|index| index < origins.len());
        if !are_even || !fits || !ray.iter().all(is_ray) {
            return Err(error::value("arrays of different lengths"));
        }
        let corners = |triangle: i32| -> Option<[[f64; 3]; 3]> {
            let face = faces.get(usize::try_from(triangle).ok()?)?;
            let [a, b, c] = face.map(|index| vertices.get(usize::try_from(index).ok()?).copied());
            Some([a?, b?, c?])
        };
        let place = |hit: usize| {
            let [origin, direction] = [&origins, &directions].map(|rows| world(rows, ray[hit]));
            let at = |t: f64| [0, 1, 2].map(|axis| origin[axis] + t * direction[axis]);
            let met = corners(triangle[hit]).map(|corners| at(meet(&corners, origin, direction)));
            let is_near = |one: &[f64; 3], other: [f64; 3]| {
                (0..3).all(|axis| (one[axis] - other[axis]).abs() <= reach)
            };
            // Mostly `t` tells, and the tree's own triangle need not be looked up.
            let known = || self.point(triangle[hit], [u[hit], v[hit]]);
            met.filter(|met| is_near(met, at(f64::from(t[hit]))) || is_near(met, known()))
                .unwrap_or_else(known)
        };
        let places = run(py, 0, None, |watch| each(count, watch, place))??;
        Ok(table(py, places))
    }
}

fn world(rows: &Rows<'_>, index: i64) -> [f64; 3] {
    rows.world(index as usize)
}

/// When a line meets a plane; not finite if it does not.
fn meet([a, b, c]: &[[f64; 3]; 3], origin: [f64; 3], direction: [f64; 3]) -> f64 {
    let minus = |p: &[f64; 3], q: &[f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let ([d, e, f], [g, h, i]) = (minus(b, a), minus(c, a));
    let normal = [e * i - f * h, f * g - d * i, d * h - e * g];
    dot(minus(a, &origin), normal) / dot(direction, normal)
}
