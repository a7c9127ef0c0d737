//! The tree as Python holds it: the mesh, its tree, and what traces them.

use std::sync::OnceLock;

use kdray::{Mesh, Sign, Stats, Tracer, Winding};
use numpy::{IntoPyArray, PyArray1, PyArray2, ndarray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Scalars, Vectors};
use crate::error;
use crate::near::{Points, within_boxes, within_spheres};
use crate::rays::{Arguments, Columns, each};
use crate::run::run;

/// A mesh, its kd-tree, and the queries they allow.
#[pyclass(frozen, module = "kdray._kdray")]
pub(crate) struct Tree {
    pub(crate) mesh: Mesh,
    pub(crate) tree: kdray::Tree,
    pub(crate) tracer: Tracer,
    /// Made when it is first asked for.
    winding: OnceLock<Winding>,
}

/// `t`, `triangle`, `u` and `v`.
type Hits<'py> = (
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<i32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<f32>>,
);

/// Where the lists begin, and the lists.
type Lists<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i32>>);

#[pymethods]
impl Tree {
    /// What is left of the tree in a pickle or a file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyBytes>> {
        let bytes = run(py, 0, None, |_| [self.mesh.to_bytes(), self.tree.to_bytes()])?;
        let length = bytes.iter().map(Vec::len).sum();
        pyo3::types::PyBytes::new_with(py, length, |target| {
            let (mesh, tree) = target.split_at_mut(bytes[0].len());
            mesh.copy_from_slice(&bytes[0]);
            tree.copy_from_slice(&bytes[1]);
            Ok(())
        })
    }

    fn closest_hit<'py>(&self, py: Python<'py>, rays: Arguments<'_>) -> PyResult<Hits<'py>> {
        let threads = rays.6;
        let rays = rays.over(&self.mesh)?;
        let columns = run(py, threads, None, |watch| rays.closest(&self.tracer, watch))??;
        Ok(columns.into_python(py))
    }

    fn any_hit<'py>(
        &self,
        py: Python<'py>,
        rays: Arguments<'_>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let threads = rays.6;
        let rays = rays.over(&self.mesh)?;
        let hit = run(py, threads, None, |watch| rays.any(&self.tracer, watch))??;
        Ok(hit.into_pyarray(py))
    }

    fn count_hits<'py>(
        &self,
        py: Python<'py>,
        rays: Arguments<'_>,
    ) -> PyResult<Bound<'py, PyArray1<i32>>> {
        let threads = rays.6;
        let rays = rays.over(&self.mesh)?;
        let counts = run(py, threads, None, |watch| rays.count(&self.tracer, watch))??;
        Ok(counts.into_pyarray(py))
    }

    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        rays: Arguments<'_>,
        max_hits: usize,
    ) -> PyResult<(Bound<'py, PyArray1<i64>>, Hits<'py>)> {
        let threads = rays.6;
        let rays = rays.over(&self.mesh)?;
        let (offsets, columns) =
            run(py, threads, None, |watch| rays.all(&self.tracer, max_hits, watch))??;
        Ok((offsets.into_pyarray(py), columns.into_python(py)))
    }

    fn contains<'py>(
        &self,
        py: Python<'py>,
        points: Vectors<'_>,
        winding: bool,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let points = self.asked(&points)?;
        let inside = run(py, threads, None, |watch| points.inside(self.sign(winding), watch))??;
        Ok(inside.into_pyarray(py))
    }

    /// Distances, negative inside; infinite where there is nothing.
    fn signed_distance<'py>(
        &self,
        py: Python<'py>,
        points: Vectors<'_>,
        winding: bool,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let points = self.asked(&points)?;
        let distances =
            run(py, threads, None, |watch| points.signed_distances(self.sign(winding), watch))??;
        Ok(distances.into_pyarray(py))
    }

    fn winding_number<'py>(
        &self,
        py: Python<'py>,
        points: Vectors<'_>,
        tolerance: f64,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let points = points.rows()?;
        let frame = self.mesh.frame();
        let numbers = run(py, threads, None, |watch| {
            let winding = self.winding();
            each(points.len(), watch, |index| {
                winding.number(points.local(index, &frame), tolerance)
            })
        })??;
        Ok(numbers.into_pyarray(py))
    }

    /// Points, distances, triangles, u and v.
    #[expect(clippy::type_complexity, reason = "five columns")]
    fn closest_point<'py>(
        &self,
        py: Python<'py>,
        points: Vectors<'_>,
        max_distance: f64,
        threads: usize,
    ) -> PyResult<(
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<i32>>,
        Bound<'py, PyArray1<f32>>,
        Bound<'py, PyArray1<f32>>,
    )> {
        let points = self.asked(&points)?;
        let (places, distances, Columns { triangle, u, v, .. }) =
            run(py, threads, None, |watch| points.closest(max_distance, watch))??;
        Ok((
            table(py, places),
            distances.into_pyarray(py),
            triangle.into_pyarray(py),
            u.into_pyarray(py),
            v.into_pyarray(py),
        ))
    }

    fn within_sphere<'py>(
        &self,
        py: Python<'py>,
        centers: Vectors<'_>,
        radius: Scalars<'_>,
        threads: usize,
    ) -> PyResult<Lists<'py>> {
        let (centers, radii) = (centers.rows()?, radius.values()?);
        if !radii.fits(centers.len()) {
            return Err(error::value("arrays of different lengths"));
        }
        let near = (&self.tracer, &self.mesh.frame());
        let (offsets, triangles) =
            run(py, threads, None, |watch| within_spheres(near, &centers, &radii, watch))??;
        Ok((offsets.into_pyarray(py), triangles.into_pyarray(py)))
    }

    fn within_box<'py>(
        &self,
        py: Python<'py>,
        lower: Vectors<'_>,
        upper: Vectors<'_>,
        threads: usize,
    ) -> PyResult<Lists<'py>> {
        let (lower, upper) = (lower.rows()?, upper.rows()?);
        if lower.len() != upper.len() {
            return Err(error::value("arrays of different lengths"));
        }
        let near = (&self.tracer, &self.mesh.frame());
        let (offsets, triangles) =
            run(py, threads, None, |watch| within_boxes(near, (&lower, &upper), watch))??;
        Ok((offsets.into_pyarray(py), triangles.into_pyarray(py)))
    }

    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let stats = run(py, 0, None, |_| self.tree.stats())?;
        let sah_cost = stats.sah_cost(&self.tree.cost());
        let Stats { nodes, leaves, empty_leaves, references, depth, .. } = stats;
        let Stats { leaf_histogram, e_inner, e_leaf, e_prim, bytes, .. } = stats;
        let dict = PyDict::new(py);
        dict.set_item("nodes", nodes)?;
        dict.set_item("leaves", leaves)?;
        dict.set_item("empty_leaves", empty_leaves)?;
        dict.set_item("references", references)?;
        dict.set_item("depth", depth)?;
        dict.set_item("leaf_histogram", leaf_histogram)?;
        dict.set_item("e_inner", e_inner)?;
        dict.set_item("e_leaf", e_leaf)?;
        dict.set_item("e_prim", e_prim)?;
        dict.set_item("sah_cost", sah_cost)?;
        dict.set_item("tree_bytes", bytes)?;
        dict.set_item("tracer_bytes", self.tracer.size_bytes())?;
        Ok(dict)
    }

    /// Raises a ValueError that tells the first violation.
    fn validate(&self, py: Python<'_>) -> PyResult<()> {
        run(py, 0, None, |_| self.tree.validate(&self.mesh))?.map_err(error::value)
    }
}

impl Tree {
    pub(crate) fn new(mesh: Mesh, tree: kdray::Tree) -> Self {
        let tracer = Tracer::new(&mesh, &tree);
        Self { mesh, tree, tracer, winding: OnceLock::new() }
    }

    fn asked<'a>(&'a self, points: &'a Vectors<'_>) -> PyResult<Points<'a>> {
        Ok(Points { tracer: &self.tracer, frame: self.mesh.frame(), points: points.rows()? })
    }

    fn winding(&self) -> &Winding {
        self.winding.get_or_init(|| Winding::new(&self.mesh))
    }

    fn sign(&self, winding: bool) -> Sign<'_> {
        if winding { Sign::Winding(self.winding()) } else { Sign::Parity }
    }
}

impl Columns {
    fn into_python(self, py: Python<'_>) -> Hits<'_> {
        (
            self.t.into_pyarray(py),
            self.triangle.into_pyarray(py),
            self.u.into_pyarray(py),
            self.v.into_pyarray(py),
        )
    }
}

/// Rows of three as an array; hands them over.
pub(crate) fn table<T: numpy::Element + bytemuck::Pod>(
    py: Python<'_>,
    rows: Vec<[T; 3]>,
) -> Bound<'_, PyArray2<T>> {
    let shape = (rows.len(), 3);
    let flat = rows.into_flattened();
    ndarray::Array2::from_shape_vec(shape, flat).expect("three numbers a row").into_pyarray(py)
}
