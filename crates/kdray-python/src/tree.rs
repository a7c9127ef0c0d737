//! The tree as Python holds it: the mesh, its tree, and what traces them.

use std::sync::Arc;

use kdray::{Mesh, Stats};
use numpy::{IntoPyArray, PyArray1, PyArray2, ndarray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Rows, Scalars, Vectors};
use crate::columns::{Columns, Hits};
use crate::cpu;
use crate::device::Choice;
use crate::each::each;
use crate::error;
use crate::gpu::{self, OnGpu};
use crate::near::{Points, within_boxes, within_spheres};
use crate::rays::{Arguments, Rays};
use crate::run::{Watch, run, run_owned};
use crate::scene::Scene;

/// A mesh, its kd-tree, and the queries they allow.
#[pyclass(frozen, module = "kdray._kdray")]
pub(crate) struct Tree {
    pub(crate) scene: Arc<Scene>,
    /// What answers rays, if that is not the CPU.
    pub(crate) gpu: Option<OnGpu>,
}

/// Where the lists begin, and the lists.
type Lists<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i32>>);

#[pymethods]
impl Tree {
    /// What is left of the tree in a pickle or a file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyBytes>> {
        let bytes = self.owned(py, |scene| [scene.mesh.to_bytes(), scene.tree.to_bytes()])?;
        let length = bytes.iter().map(Vec::len).sum();
        pyo3::types::PyBytes::new_with(py, length, |target| {
            let (mesh, tree) = target.split_at_mut(bytes[0].len());
            mesh.copy_from_slice(&bytes[0]);
            tree.copy_from_slice(&bytes[1]);
            Ok(())
        })
    }

    /// The same tree on another device.
    fn to(&self, py: Python<'_>, device: &str) -> PyResult<Self> {
        let gpu = match Choice::of(py, device)? {
            Choice::Cpu => None,
            Choice::Gpu(device) | Choice::Rather(device) => {
                let Scene { mesh, tree, .. } = &*self.scene;
                let brought = run(py, 0, None, |_| OnGpu::new(device, mesh, tree))?;
                Some(brought.map_err(|error| error::gpu(&error))?)
            }
        };
        Ok(Self { scene: Arc::clone(&self.scene), gpu })
    }

    /// Index and name of the GPU that answers rays, unless that is the CPU.
    #[getter]
    fn gpu(&self) -> Option<(usize, String)> {
        let adapter = self.gpu.as_ref().and_then(OnGpu::tracer)?.device().adapter();
        Some((adapter.index, adapter.name.clone()))
    }

    fn closest_hit<'py>(&self, py: Python<'py>, rays: Arguments<'_>) -> PyResult<Hits<'py>> {
        let threads = rays.6;
        let rays = rays.over(&self.scene.mesh)?;
        let columns = run(py, threads, None, |watch| match self.on_gpu(&rays) {
            Some(tracer) => gpu::closest(&rays, tracer, watch),
            None => self.on_cpu(&rays, watch).closest(),
        })??;
        Ok(columns.into_python(py))
    }

    fn any_hit<'py>(
        &self,
        py: Python<'py>,
        rays: Arguments<'_>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let threads = rays.6;
        let rays = rays.over(&self.scene.mesh)?;
        let hit = run(py, threads, None, |watch| match self.on_gpu(&rays) {
            Some(tracer) => gpu::any(&rays, tracer, watch),
            None => self.on_cpu(&rays, watch).any(),
        })??;
        Ok(hit.into_pyarray(py))
    }

    fn count_hits<'py>(
        &self,
        py: Python<'py>,
        rays: Arguments<'_>,
    ) -> PyResult<Bound<'py, PyArray1<i32>>> {
        let threads = rays.6;
        let rays = rays.over(&self.scene.mesh)?;
        let counts = run(py, threads, None, |watch| match self.on_gpu(&rays) {
            Some(tracer) => gpu::count(&rays, tracer, watch),
            None => self.on_cpu(&rays, watch).count(),
        })??;
        Ok(counts.into_pyarray(py))
    }

    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        rays: Arguments<'_>,
        max_hits: usize,
    ) -> PyResult<(Bound<'py, PyArray1<i64>>, Hits<'py>)> {
        let threads = rays.6;
        let rays = rays.over(&self.scene.mesh)?;
        let (offsets, columns) = run(py, threads, None, |watch| match self.on_gpu(&rays) {
            Some(tracer) => gpu::all(&rays, max_hits, tracer, watch),
            None => self.on_cpu(&rays, watch).all(max_hits),
        })??;
        Ok((offsets.into_pyarray(py), columns.into_python(py)))
    }

    fn contains<'py>(
        &self,
        py: Python<'py>,
        points: Vectors<'_>,
        winding: bool,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let points = points.rows()?;
        self.with_winding(py, winding)?;
        let inside = run(py, threads, None, |watch| {
            self.near(points).inside(self.scene.sign(winding), watch)
        })??;
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
        let points = points.rows()?;
        self.with_winding(py, winding)?;
        let distances = run(py, threads, None, |watch| {
            self.near(points).signed_distances(self.scene.sign(winding), watch)
        })??;
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
        self.with_winding(py, true)?;
        let frame = self.scene.mesh.frame();
        let numbers = run(py, threads, None, |watch| {
            let winding = self.scene.winding();
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
        let points = points.rows()?;
        let (places, distances, Columns { triangle, u, v, .. }) =
            run(py, threads, None, |watch| self.near(points).closest(max_distance, watch))??;
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
        let (offsets, triangles) = run(py, threads, None, |watch| {
            let near = (self.scene.tracer(), &self.scene.mesh.frame());
            within_spheres(near, &centers, &radii, watch)
        })??;
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
        let (offsets, triangles) = run(py, threads, None, |watch| {
            let near = (self.scene.tracer(), &self.scene.mesh.frame());
            within_boxes(near, (&lower, &upper), watch)
        })??;
        Ok((offsets.into_pyarray(py), triangles.into_pyarray(py)))
    }

    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (stats, tracer_bytes) =
            self.owned(py, |scene| (scene.tree.stats(), scene.tracer().size_bytes()))?;
        let sah_cost = stats.sah_cost(&self.scene.tree.cost());
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
        dict.set_item("tracer_bytes", tracer_bytes)?;
        Ok(dict)
    }

    /// Raises a ValueError that tells the first violation.
    fn validate(&self, py: Python<'_>) -> PyResult<()> {
        self.owned(py, |scene| scene.tree.validate(&scene.mesh))?.map_err(error::value)
    }
}

impl Tree {
    /// A tree on the CPU.
    pub(crate) fn new(mesh: Mesh, tree: kdray::Tree) -> Self {
        Self { scene: Arc::new(Scene::new(mesh, tree)), gpu: None }
    }

    /// With what the CPU needs to answer, if it is the one who answers.
    pub(crate) fn ready(self, py: Python<'_>, threads: usize) -> PyResult<Self> {
        if self.gpu.is_none() {
            let scene = Arc::clone(&self.scene);
            run_owned(py, threads, move || _ = scene.tracer())?;
        }
        Ok(self)
    }

    /// Makes what winding numbers need, if they are wanted.
    fn with_winding(&self, py: Python<'_>, wanted: bool) -> PyResult<()> {
        if wanted { self.owned(py, |scene| _ = scene.winding()) } else { Ok(()) }
    }

    /// What `work` gives, without its keeping a signal waiting.
    fn owned<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Scene) -> T + Send + 'static,
    ) -> PyResult<T> {
        let scene = Arc::clone(&self.scene);
        run_owned(py, 0, move || work(&scene))
    }

    /// What answers rays, if that is a GPU. It knows nothing of masks.
    fn on_gpu(&self, rays: &Rays) -> Option<&kdray_gpu::Tracer<'static>> {
        self.gpu.as_ref().filter(|_| rays.mask.is_none()).and_then(OnGpu::tracer)
    }

    fn on_cpu<'a, 'r>(&'a self, rays: &'a Rays<'r>, watch: &'a Watch) -> cpu::Asked<'a, 'r> {
        cpu::Asked { rays, scene: &self.scene, watch }
    }

    fn near<'a>(&'a self, points: Rows<'a>) -> Points<'a> {
        Points { tracer: self.scene.tracer(), frame: self.scene.mesh.frame(), points }
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
