//! A tree a frame, on the CPU or on a device that keeps its memory.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use kdray::{BuildOptions, Mesh, Tree};
use kdray_gpu::{Device, GpuError, Rebuilder};
use serde::Serialize;

use crate::device::Place;

/// Builds every frame's tree from nothing.
pub(super) struct Builder<'a> {
    gpu: Option<(&'a Device, Rebuilder<'a>)>,
    options: BuildOptions<'a>,
}

/// A frame's tree, and what it took.
pub(super) struct Built<'a> {
    pub(super) place: Place<'a>,
    pub(super) build_s: f64,
    pub(super) peak_bytes: u64,
    pub(super) tree_bytes: u64,
}

/// What the device has, and what it had to do and to move for that since it was opened.
#[derive(Serialize)]
pub(super) struct DeviceMemory {
    device_bytes: u64,
    allocations: u64,
    compiled_kernels: usize,
    uploaded_bytes: u64,
    downloaded_bytes: u64,
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

    pub(super) fn build(&mut self, mesh: &Mesh) -> anyhow::Result<Built<'a>> {
        let start = Instant::now();
        let Some((_, rebuilder)) = &mut self.gpu else {
            let (tree, report) = Tree::build_reported(mesh, &self.options)?;
            let build_s = start.elapsed().as_secs_f64();
            let (tree_bytes, peak_bytes) = (tree.size_bytes() as u64, report.peak_bytes);
            return Ok(Built { place: Place::Cpu(tree), build_s, peak_bytes, tree_bytes });
        };
        let (tracer, report) = rebuilder.build(mesh, &self.options)?;
        let build_s = start.elapsed().as_secs_f64();
        let kdray_gpu::BuildReport { peak_bytes, tree_bytes, .. } = report;
        Ok(Built { place: Place::Gpu(tracer), build_s, peak_bytes, tree_bytes })
    }

    /// What the device has by now.
    pub(super) fn device_memory(&self) -> Option<DeviceMemory> {
        self.gpu.as_ref().map(|(device, _)| DeviceMemory {
            device_bytes: device.memory().bytes(),
            allocations: device.memory().allocations(),
            compiled_kernels: device.compiled(),
            uploaded_bytes: device.traffic().up_bytes(),
            downloaded_bytes: device.traffic().down_bytes(),
        })
    }
}
