//! Errors of the core as exceptions of Python.

use std::io;
use std::path::Path;

use kdray::BuildError;
use kdray_mesh::{LoadError, Reason};
use pyo3::exceptions::{PyMemoryError, PyOSError, PyRuntimeError, PyValueError};
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

pub(crate) fn build(error: &BuildError) -> PyErr {
    match error {
        BuildError::MemoryBudget { .. } => PyMemoryError::new_err(error.to_string()),
        BuildError::Threads { .. } => PyRuntimeError::new_err(error.to_string()),
        _ => value(error),
    }
}
