//! What rays take on a GPU, beside the tracer on the CPU.

use std::time::Instant;

use kdray::{BatchOptions, Mesh, Ray, Tree};
use kdray_gpu::TraceReport;
use serde::Serialize;

use crate::output;
use crate::sizes::count;

/// What the closest hits of a batch of rays took. Rates are in millions of rays a second.
#[derive(Serialize)]
pub(super) struct Profile {
    rays: usize,
    /// With rays on their way to the device and answers on their way back.
    million_rays_per_s: f64,
    /// Of the tracer on the CPU, which answers the same rays in the same run.
    cpu_million_rays_per_s: f64,
    #[serde(flatten)]
    each: PerRay,
    kernels: Vec<KernelTime>,
}

/// What a ray visits and tests on a GPU, and what it has there.
#[derive(Serialize)]
pub(crate) struct PerRay {
    pub(crate) nodes_per_ray: f64,
    pub(crate) leaves_per_ray: f64,
    pub(crate) triangle_tests_per_ray: f64,
    /// Memory that a ray has for itself, in the kernel that follows it and in the one that works out
    /// where it hits.
    pub(crate) private_bytes: [u32; 2],
}

impl PerRay {
    /// Of the closest hits of so many rays.
    pub(crate) fn of(report: &TraceReport, rays: usize) -> Self {
        let each = |count: u64| count as f64 / rays.max(1) as f64;
        Self {
            nodes_per_ray: each(report.steps),
            leaves_per_ray: each(report.leaves),
            triangle_tests_per_ray: each(report.tests),
            private_bytes: report.private_bytes,
        }
    }
}

#[derive(Serialize)]
struct KernelTime {
    kernel: &'static str,
    ms: f64,
}

impl Profile {
    /// Asks once more, and counts; `seconds` is what it took without that.
    pub(super) fn of(
        batch: &kdray_gpu::Batch,
        (mesh, tree): (&Mesh, &Tree),
        rays: &[Ray],
        (seconds, threads): (f64, usize),
    ) -> anyhow::Result<Self> {
        let mut hits = vec![None; rays.len()];
        let report = batch.closest_hits_reported(rays, &mut hits)?;
        let tracer = kdray::Tracer::new(mesh, tree);
        let cpu = tracer.batch(BatchOptions { threads, ..BatchOptions::default() })?;
        let start = Instant::now();
        let mut expected = vec![None; rays.len()];
        cpu.closest_hits(rays, &mut expected)?;
        let cpu_seconds = start.elapsed().as_secs_f64();
        anyhow::ensure!(hits == expected, "the GPU's hits are not those of the CPU");
        let rate = |seconds: f64| rays.len() as f64 / seconds.max(1e-9) * 1e-6;
        let mut kernels: Vec<KernelTime> = Vec::new();
        for stage in &report.profile.stages {
            match kernels.iter_mut().find(|time| time.kernel == stage.name) {
                Some(time) => time.ms += 1e3 * stage.seconds,
                None => kernels.push(KernelTime { kernel: stage.name, ms: 1e3 * stage.seconds }),
            }
        }
        Ok(Self {
            rays: rays.len(),
            million_rays_per_s: rate(seconds),
            cpu_million_rays_per_s: rate(cpu_seconds),
            each: PerRay::of(&report, rays.len()),
            kernels,
        })
    }

    pub(super) fn text(&self) -> String {
        let each = &self.each;
        let [walk, locate] = each.private_bytes;
        let mut rows = vec![
            ("rays", count(self.rays)),
            ("GPU", format!("{:.3} million a second", self.million_rays_per_s)),
            ("CPU", format!("{:.3} million a second, the same hits", self.cpu_million_rays_per_s)),
            (
                "a ray",
                format!(
                    "visits {:.1} nodes and {:.1} leaves, tests {:.1} triangles",
                    each.nodes_per_ray, each.leaves_per_ray, each.triangle_tests_per_ray
                ),
            ),
            ("memory", format!("{walk} bytes a ray on its way, {locate} to locate its hit")),
        ];
        rows.extend(self.kernels.iter().map(|time| (time.kernel, format!("{:.1} ms", time.ms))));
        output::table(&rows)
    }
}
