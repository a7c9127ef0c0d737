//! The extension module of the Python package: converts, detaches from the interpreter, calls.
//!
//! What users see is in `python/kdray`, which brings arguments into the forms that are expected
//! here: C-contiguous arrays of rows, in f32 or f64.

mod arrays;
mod build;
mod columns;
mod cpu;
mod device;
mod each;
mod error;
mod file;
mod generate;
mod gpu;
mod mesh;
mod near;
mod order;
mod planes;
mod process;
mod rays;
mod render;
mod run;
mod scene;
mod tree;

use pyo3::prelude::*;

#[pymodule]
mod _kdray {
    use super::{Bound, PyModule, PyModuleMethods, PyResult, pyfunction};

    #[pymodule_export]
    use super::device::gpus;
    #[pymodule_export]
    use super::file::load;
    #[pymodule_export]
    use super::generate::{showcase, sphere, torus_knot};
    #[pymodule_export]
    use super::tree::Tree;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    /// The prices of a step and of a triangle, and the bonus for empty space, of a default build.
    #[pyfunction]
    fn default_cost() -> (f32, f32, f32) {
        let kdray::Cost { traversal, intersect, empty_bonus, .. } = kdray::Cost::default();
        (traversal, intersect, empty_bonus)
    }
}
