//! Errors of the core as exceptions of Python.

use std::io;
use std::path::Path;

use kdray::{BuildError, MeshError};
use kdray_gpu::GpuError;
use kdray_mesh::{LoadError, Reason};
use pyo3::exceptions::{PyMemoryError, PyOSError, PyValueError};
use pyo3::prelude::*;

/// A ValueError that says `error`.
pub(crate) fn value(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// What the system said of the file at `path`; Python picks the kind of OSError by its number.
pub(crate) fn system(error: &io::Error, path: &Path) -> PyErr {
    match error.raw_os_error() {
        Some(number) => PyOSError::new_err((number, error.to_string(), path.to_path_buf())),
        None => PyOSError::new_err(format!("{}: {error}", path.display())),
    }
}

pub(crate) fn load(error: &LoadError, path: &Path) -> PyErr {
    match &error.reason {
        Reason::Io(reason) => system(reason, path),
        _ => value(error),
    }
}

pub(crate) fn mesh(error: &MeshError) -> PyErr {
    match error {
        MeshError::NonFinite { vertex, position } => {
            value(format!("vertices[{vertex}] is not finite: {position:?}"))
        }
        MeshError::IndexOutOfRange { .. } | MeshError::TooLarge { .. } => {
            value(format!("faces: {error}"))
        }
    }
}

pub(crate) fn build(error: &BuildError) -> PyErr {
    match error {
        BuildError::MemoryBudget { .. } => PyMemoryError::new_err(error.to_string()),
        BuildError::Threads { .. } => PyOSError::new_err(error.to_string()),
        BuildError::Option { option, value: given, expected } => {
            let name = match *option {
                "traversal" => "cost_traversal",
                "intersect" => "cost_intersect",
                other => other,
            };
            value(format!("{name} is {given}, which is not {expected}"))
        }
        _ => value(error),
    }
}

pub(crate) fn gpu(error: &GpuError) -> PyErr {
    let message = format!("device: {error}");
    match error {
        GpuError::Build(error) => build(error),
        GpuError::NoAdapter { .. } | GpuError::UnknownAdapter { .. } | GpuError::Batch(_) => {
            PyValueError::new_err(message)
        }
        GpuError::Limit { .. } | GpuError::OutOfMemory { .. } => PyMemoryError::new_err(message),
        GpuError::Refused { .. } | GpuError::Lost { .. } | GpuError::Driver { .. } => {
            PyOSError::new_err(message)
        }
    }
}

/// Whether a build would fail on every device.
pub(crate) fn is_of_build(error: &GpuError) -> bool {
    matches!(error, GpuError::Build(_))
}
