//! Building.

use kdray::{BuildOptions, Builder, Cost};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::arrays::{Vectors, threes};
use crate::error;
use crate::run::run;
use crate::tree::Tree;

/// What a build is told, as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    builder: String,
    cost_traversal: f32,
    cost_intersect: f32,
    empty_bonus: f32,
    max_depth: Option<u32>,
    max_leaf: u32,
    clip: bool,
    threads: usize,
    memory_budget: Option<u64>,
    progress: Option<Py<PyAny>>,
}

#[pymethods]
impl Tree {
    /// The tree of `vertices` and `faces`.
    #[staticmethod]
    fn build(
        py: Python<'_>,
        vertices: Vectors<'_>,
        faces: PyReadonlyArray2<'_, u32>,
        options: Options,
    ) -> PyResult<Self> {
        let (vertices, faces) = (vertices.vertices()?, threes(&faces)?);
        let builder = options.builder()?;
        run(py, options.threads, options.progress.as_ref(), |watch| {
            let mesh = vertices.mesh(faces)?;
            let report = |fraction| watch.report(fraction);
            let build_options = BuildOptions {
                builder,
                cost: options.cost(),
                max_depth: options.max_depth,
                max_leaf: options.max_leaf,
                clip: options.clip,
                threads: rayon::current_num_threads(),
                memory_budget: options.memory_budget,
                progress: Some(&report),
                cancel: Some(watch.cancel()),
            };
            let tree = kdray::Tree::build(&mesh, &build_options).map_err(|e| error::build(&e))?;
            Ok(Self::new(mesh, tree))
        })?
    }
}

impl Options {
    fn builder(&self) -> PyResult<Builder> {
        match self.builder.as_str() {
            "exact" => Ok(Builder::Exact),
            "resort" => Ok(Builder::Resort),
            "naive" => Ok(Builder::Naive),
            other => Err(error::value(format!(
                "builder is {other:?}, which is none of 'exact', 'resort' and 'naive'"
            ))),
        }
    }

    fn cost(&self) -> Cost {
        Cost {
            traversal: self.cost_traversal,
            intersect: self.cost_intersect,
            empty_bonus: self.empty_bonus,
        }
    }
}
