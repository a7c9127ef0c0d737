//! Building on a GPU.

use std::time::Instant;

use kdray::{BuildOptions, Mesh};
use kdray_gpu::Device;
use serde::Serialize;

use super::Built;
use super::profile::{self, Profile};

/// What is known of a build on a GPU.
#[derive(Serialize)]
pub(crate) struct GpuFigures {
    pub(crate) adapter: String,
    pub(crate) driver: String,
    /// Nodes near the root that the CPU made, because the device cannot bind what they take.
    pub(crate) crown: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) profile: Option<Profile>,
}

/// Builds the tree of `mesh` on `device`; the time is without the kernels' compilation.
pub(crate) fn build(
    device: &Device,
    mesh: &Mesh,
    options: &BuildOptions,
    arguments: &profile::ProfileArguments,
) -> anyhow::Result<Built> {
    kdray_gpu::prepare(device)?;
    let start = Instant::now();
    let (tree, mut report) = kdray_gpu::build_reported(device, mesh, options, arguments.profile)?;
    let build_s = start.elapsed().as_secs_f64();
    let kernels = report.profile.take();
    let adapter = device.adapter();
    let gpu = GpuFigures {
        adapter: adapter.name.clone(),
        driver: adapter.driver.clone(),
        crown: report.crown,
        profile: kernels.map(|kernels| Profile::new(&report, &kernels, arguments.bandwidth)),
    };
    Ok(Built { tree, build_s, peak_bytes: report.peak_bytes, gpu: Some(gpu) })
}
