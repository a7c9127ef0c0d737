//! The devices of this machine, and which of them is meant.

use std::collections::HashMap;

use kdray_gpu::{Adapter, Device, GpuError, Kind, Selection};
use pyo3::prelude::*;

use crate::error;
use crate::process::OfProcess;
use crate::run::run;

/// Index, name, kind, backend and driver of a GPU.
type Described = (usize, String, String, String, String);

/// Where a tree is to be.
#[derive(Clone, Copy)]
pub(crate) enum Choice {
    Cpu,
    Gpu(&'static Device),
    /// There if it can be, and otherwise on the CPU.
    Rather(&'static Device),
}

/// What a process knows of its devices. They are never closed: opening one and compiling its kernels
/// takes long, and trees hold on to them.
#[derive(Default)]
struct Known {
    /// Whether there is a GPU that is not a program.
    has_real: Option<bool>,
    by_word: HashMap<String, &'static Device>,
}

static KNOWN: OfProcess<Known> = OfProcess::new();

/// The GPUs of this machine.
#[pyfunction]
pub(crate) fn gpus(py: Python<'_>) -> PyResult<Vec<Described>> {
    let described = |adapter: Adapter| {
        let Adapter { index, name, backend, driver, kind, .. } = adapter;
        (index, name, kind.to_string(), backend, driver)
    };
    let adapters = run(py, 0, None, |_| kdray_gpu::devices())?;
    Ok(adapters.into_iter().map(described).collect())
}

impl Choice {
    /// What `word` means: `cpu`, `auto`, `gpu`, or a GPU by its index or a part of its name.
    pub(crate) fn of(py: Python<'_>, word: &str) -> PyResult<Self> {
        match word {
            "cpu" => Ok(Self::Cpu),
            "auto" if !has_real(py)? => Ok(Self::Cpu),
            "auto" => Ok(open(py, "gpu")?.map_or(Self::Cpu, Self::Rather)),
            word => open(py, word)?.map(Self::Gpu).map_err(|error| error::gpu(&error)),
        }
    }

    /// Whether it has to be that device.
    pub(crate) fn is_final(self) -> bool {
        !matches!(self, Self::Rather(_))
    }
}

fn has_real(py: Python<'_>) -> PyResult<bool> {
    if let Some(has_real) = KNOWN.with(|known| known.has_real) {
        return Ok(has_real);
    }
    let is_real = |adapter: &Adapter| adapter.kind != Kind::Software;
    let has_real = run(py, 0, None, |_| kdray_gpu::devices().iter().any(is_real))?;
    KNOWN.with(|known| known.has_real = Some(has_real));
    Ok(has_real)
}

/// The GPU that `word` means. One that has failed is opened anew.
fn open(py: Python<'_>, word: &str) -> PyResult<Result<&'static Device, GpuError>> {
    let ready = KNOWN.with(|known| known.by_word.get(word).copied());
    if let Some(device) = ready.filter(|device| device.check().is_ok()) {
        return Ok(Ok(device));
    }
    let selection: Selection = word.parse().unwrap_or_else(|never| match never {});
    let opened = match run(py, 0, None, |_| Device::open_with_large_buffers(&selection))? {
        Ok(opened) => opened,
        Err(error) => return Ok(Err(error)),
    };
    let index = opened.adapter().index;
    Ok(Ok(KNOWN.with(|known| {
        let same =
            |device: &&&'static Device| device.adapter().index == index && device.check().is_ok();
        let other = known.by_word.values().find(same).copied();
        let device = other.unwrap_or_else(|| Box::leak(Box::new(opened)));
        known.by_word.insert(word.to_owned(), device);
        device
    })))
}
