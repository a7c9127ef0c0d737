//! The mesh of a tree, in world coordinates.

use numpy::{PyArray2, PyReadonlyArrayDyn};
use pyo3::prelude::*;

use crate::arrays::flat;
use crate::each::each;
use crate::error;
use crate::run::run;
use crate::tree::{Tree, table};

#[pymethods]
impl Tree {
    /// World coordinates of places on triangles; NaN where the triangle is -1.
    fn points<'py>(
        &self,
        py: Python<'py>,
        triangle: PyReadonlyArrayDyn<'_, i32>,
        u: PyReadonlyArrayDyn<'_, f32>,
        v: PyReadonlyArrayDyn<'_, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (triangle, u, v) = (flat(&triangle)?, flat(&u)?, flat(&v)?);
        if u.len() != triangle.len() || v.len() != triangle.len() {
            return Err(error::value("arrays of different lengths"));
        }
        let point = |index| self.point(triangle[index], [u[index], v[index]]);
        let points = run(py, 0, None, |watch| each(triangle.len(), watch, point))??;
        Ok(table(py, points))
    }

    /// Unit normals of triangles: zero without area, NaN where the triangle is -1.
    fn normals<'py>(
        &self,
        py: Python<'py>,
        triangle: PyReadonlyArrayDyn<'_, i32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let triangle = flat(&triangle)?;
        let normal_of = |index| self.scene.mesh.normal(index).unwrap_or_default();
        let normal = |index| self.index(triangle[index]).map_or([f32::NAN; 3], normal_of);
        let normals = run(py, 0, None, |watch| each(triangle.len(), watch, normal))??;
        Ok(table(py, normals))
    }

    /// World coordinates of the vertices.
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let frame = self.scene.mesh.frame();
        table(
            py,
            self.scene.mesh.positions().iter().map(|point| frame.world_point(*point)).collect(),
        )
    }

    fn faces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i32>> {
        table(
            py,
            self.scene.mesh.triangles().iter().map(|face| face.map(|index| index as i32)).collect(),
        )
    }

    #[getter]
    pub(crate) fn triangle_count(&self) -> usize {
        self.scene.mesh.triangles().len()
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.scene.mesh.positions().len()
    }

    /// Lower and upper corner of the mesh's box.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let kdray::Aabb { lower, upper } = self.scene.mesh.bounds();
        table(py, [lower, upper].map(|corner| self.scene.mesh.frame().world_point(corner)).to_vec())
    }
}

impl Tree {
    /// World coordinates of a place on a triangle; NaN without one.
    pub(crate) fn point(&self, triangle: i32, place: [f32; 2]) -> [f64; 3] {
        let [u, v] = place.map(f64::from);
        self.corners(triangle).map_or([f64::NAN; 3], |[a, b, c]| {
            [0, 1, 2].map(|axis| (1.0 - u - v) * a[axis] + u * b[axis] + v * c[axis])
        })
    }

    /// World coordinates of a triangle's corners, if there is such a triangle.
    fn corners(&self, triangle: i32) -> Option<[[f64; 3]; 3]> {
        let corners = self.scene.mesh.triangle(self.index(triangle)?);
        Some(corners.map(|corner| self.scene.mesh.frame().world_point(corner)))
    }

    /// A triangle of the mesh, if it is one.
    fn index(&self, triangle: i32) -> Option<usize> {
        usize::try_from(triangle).ok().filter(|index| *index < self.triangle_count())
    }
}
