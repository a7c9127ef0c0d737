//! What a mesh takes: to build its tree, and to trace a picture of it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::Context;
use kdray::{BuildError, BuildOptions, Mesh, Tracer, Tree};
use kdray_gpu::{Device, Kind, TraceOptions};
use kdray_render::Camera;
use serde::Serialize;

use super::super::rays;
use super::published::BANDWIDTH;
use crate::commands::build::device;
use crate::commands::build::profile::{Profile, ProfileArguments};
use crate::commands::query::profile::PerRay;
use crate::progress::Progress;

/// Pixels along a side of the picture that is traced, as in the paper.
pub(super) const SIDE: u32 = 1024;

/// On the CPU. Times are the best of all passes, by the wall clock.
#[derive(Serialize)]
pub(super) struct CpuFigures {
    pub(super) build_s: f64,
    pub(super) peak_bytes: u64,
    pub(super) final_bytes: u64,
    /// The closest hits of 1024 x 1024 camera rays.
    pub(super) trace_s: f64,
    pub(super) hits: usize,
}

/// On a GPU, or on what behaves like one.
#[derive(Serialize)]
pub(super) struct GpuFigures {
    /// Without the profile, which takes time itself; the best of all passes, of which a software
    /// device has one.
    pub(super) build_s: f64,
    /// The closest hits of 1024 x 1024 camera rays, from the host's memory and back.
    pub(super) trace_s: f64,
    /// Whether the tree has the bytes of the CPU's, and the rays its hits.
    pub(super) same_tree: bool,
    pub(super) same_hits: bool,
    /// Of these rays.
    pub(super) rays: PerRay,
    pub(super) profile: Profile,
}

/// How it is measured.
pub(super) struct Plan<'a> {
    pub(super) passes: usize,
    pub(super) device: Option<&'a Device>,
    pub(super) cancel: &'a AtomicBool,
}

/// Measures a build on the CPU and a picture through its tree; gives the tree too.
pub(super) fn cpu(
    mesh: &Mesh,
    camera: &Camera,
    plan: &Plan,
    progress: &Progress,
) -> anyhow::Result<(Tree, CpuFigures)> {
    let options = BuildOptions { cancel: Some(plan.cancel), ..BuildOptions::default() };
    let (mut tree, report) = Tree::build_reported(mesh, &options)?;
    let mut build_s = f64::INFINITY;
    for pass in 0..plan.passes {
        let start = Instant::now();
        tree = Tree::build(mesh, &options)?;
        build_s = build_s.min(start.elapsed().as_secs_f64());
        progress.set(0.25 * (pass + 1) as f32 / plan.passes as f32);
    }
    let tracer = Tracer::new(mesh, &tree);
    let rays = rays::through(camera, SIDE);
    let mut hits = vec![None; rays.len()];
    let mut trace_s = f64::INFINITY;
    for _pass in 0..plan.passes {
        if plan.cancel.load(Ordering::Relaxed) {
            return Err(BuildError::Cancelled.into());
        }
        let start = Instant::now();
        tracer.closest_hits(&rays, &mut hits);
        trace_s = trace_s.min(start.elapsed().as_secs_f64());
    }
    let hits = hits.iter().flatten().count();
    let (peak_bytes, final_bytes) = (report.peak_bytes, tree.size_bytes() as u64);
    Ok((tree, CpuFigures { build_s, peak_bytes, final_bytes, trace_s, hits }))
}

/// Measures builds on `device`, beside `expected`, which the CPU built.
pub(super) fn gpu(
    (mesh, camera): (&Mesh, &Camera),
    device: &Device,
    expected: &Tree,
    plan: &Plan,
    progress: &Progress,
) -> anyhow::Result<GpuFigures> {
    let options = BuildOptions { cancel: Some(plan.cancel), ..BuildOptions::default() };
    kdray_gpu::prepare(device)?;
    let passes = if is_software(device) { 1 } else { plan.passes };
    let rays = rays::through(camera, SIDE);
    let (mut build_s, mut trace_s) = (f64::INFINITY, f64::INFINITY);
    let mut traced = None;
    for pass in 0..passes {
        let start = Instant::now();
        let (tracer, _) = kdray_gpu::Tracer::build(device, mesh, &options)?;
        build_s = build_s.min(start.elapsed().as_secs_f64());
        tracer.prepare()?;
        let batch = tracer.batch(TraceOptions::default());
        let mut hits = vec![None; rays.len()];
        let start = Instant::now();
        batch.closest_hits(&rays, &mut hits)?;
        trace_s = trace_s.min(start.elapsed().as_secs_f64());
        let report = batch.closest_hits_reported(&rays, &mut hits)?;
        traced = Some((hits, PerRay::of(&report, rays.len())));
        progress.set(0.25 + 0.25 * (pass + 1) as f32 / passes as f32);
    }
    let profile = ProfileArguments { profile: true, bandwidth: BANDWIDTH };
    let built = device::build(device, mesh, &options, &profile)?;
    let same_tree = built.tree.to_bytes() == expected.to_bytes();
    let profile = built.gpu.and_then(|gpu| gpu.profile).context("a profile was asked for")?;
    let (hits, of_rays) = traced.context("there is a pass at least")?;
    let mut of_cpu = vec![None; rays.len()];
    Tracer::new(mesh, expected).closest_hits(&rays, &mut of_cpu);
    let same_hits = hits == of_cpu;
    Ok(GpuFigures { build_s, trace_s, same_tree, same_hits, rays: of_rays, profile })
}

pub(super) fn is_software(device: &Device) -> bool {
    device.adapter().kind == Kind::Software
}
