//! Building.

use std::sync::Arc;

use kdray::{BuildOptions, Builder, Cost, Mesh};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::arrays::{Vectors, threes};
use crate::device::Choice;
use crate::error;
use crate::gpu::OnGpu;
use crate::run::run;
use crate::scene::Scene;
use crate::tree::Tree;

/// What a build is told, as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    device: String,
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
        let (builder, choice) = (options.builder()?, options.choice(py)?);
        let built = run(py, options.threads, options.progress.as_ref(), |watch| {
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
            built(mesh, &build_options, choice)
        })?;
        let (scene, gpu) = built?;
        let scene = Arc::new(scene);
        Self { scene, gpu }.ready(py, options.threads)
    }
}

/// The mesh with its tree, and what that has on a GPU.
fn built(
    mesh: Mesh,
    options: &BuildOptions<'_>,
    choice: Choice,
) -> PyResult<(Scene, Option<OnGpu>)> {
    if let Choice::Gpu(device) | Choice::Rather(device) = choice {
        match OnGpu::built(device, &mesh, options) {
            Ok((tree, gpu)) => return Ok((Scene::new(mesh, tree), Some(gpu))),
            Err(error) if choice.is_final() || error::is_of_build(&error) => {
                return Err(error::gpu(&error));
            }
            // There is still the CPU.
            Err(_) => {}
        }
    }
    let tree = kdray::Tree::build(&mesh, options).map_err(|error| error::build(&error))?;
    Ok((Scene::new(mesh, tree), None))
}

impl Options {
    /// Where to build. Only the CPU has a choice of builders.
    fn choice(&self, py: Python<'_>) -> PyResult<Choice> {
        match (self.device.as_str(), self.builder.as_str()) {
            ("auto", "resort" | "naive") => Ok(Choice::Cpu),
            (device, builder) => match Choice::of(py, device)? {
                Choice::Gpu(_) if builder != "exact" => Err(error::value(format!(
                    "builder is {builder:?}, which is for the CPU; device is {device:?}"
                ))),
                choice => Ok(choice),
            },
        }
    }

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
