//! A tree a frame, on the CPU or on a device that keeps its memory.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use kdray::{BuildOptions, Mesh, Tree};
use kdray_gpu::{Device, GpuError, Rebuilder};
use serde::Serialize;

/// Builds every frame's tree from nothing.
pub(super) struct Builder<'a> {
    gpu: Option<(&'a Device, Rebuilder<'a>)>,
    options: BuildOptions<'a>,
}

/// A frame's tree, and what it took.
pub(super) struct Built {
    pub(super) tree: Tree,
    pub(super) build_s: f64,
    pub(super) peak_bytes: u64,
}

/// What the device has, and had to do for that since it was opened.
#[derive(Serialize)]
pub(super) struct DeviceMemory {
    device_bytes: u64,
    allocations: u64,
    compiled_kernels: usize,
}

impl<'a> Builder<'a> {
    pub(super) fn new(
        device: Option<&'a Device>,
        threads: usize,
        cancel: &'a AtomicBool,
    ) -> Result<Self, GpuError> {
        let gpu = device.map(|device| Ok::<_, GpuError>((device, Rebuilder::new(device)?)));
        let options = BuildOptions { threads, cancel: Some(cancel), ..BuildOptions::default() };
        Ok(Self { gpu: gpu.transpose()?, options })
    }

    pub(super) fn build(&mut self, mesh: &Mesh) -> anyhow::Result<Built> {
        let start = Instant::now();
        let Some((_, rebuilder)) = &mut self.gpu else {
            let (tree, report) = Tree::build_reported(mesh, &self.options)?;
            let build_s = start.elapsed().as_secs_f64();
            return Ok(Built { tree, build_s, peak_bytes: report.peak_bytes });
        };
        let (tree, report) = rebuilder.build(mesh, &self.options)?;
        let build_s = start.elapsed().as_secs_f64();
        Ok(Built { tree, build_s, peak_bytes: report.peak_bytes })
    }

    /// What the device has by now.
    pub(super) fn device_memory(&self) -> Option<DeviceMemory> {
        self.gpu.as_ref().map(|(device, _)| DeviceMemory {
            device_bytes: device.memory().bytes(),
            allocations: device.memory().allocations(),
            compiled_kernels: device.compiled(),
        })
    }
}
