//! Times a build and three kinds of rays.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::Context;
use kdray::{BuildError, BuildOptions, Mesh, Ray, Tracer, Tree};
use serde::Serialize;

use super::rays;
use crate::progress::Progress;

/// What one mesh gave on one number of threads. Speeds are in million rays a second by the wall
/// clock, the best of all passes; there are none if no ray hits the mesh.
#[derive(Serialize)]
pub(super) struct Measurement {
    pub(super) threads: usize,
    pub(super) build_best_s: f64,
    pub(super) build_median_s: f64,
    pub(super) peak_bytes: u64,
    pub(super) tree_bytes: usize,
    pub(super) primary: Option<f64>,
    pub(super) bounce: Option<f64>,
    pub(super) shadow: Option<f64>,
}

impl Measurement {
    pub(super) fn take(
        mesh: &Mesh,
        threads: usize,
        passes: usize,
        cancel: &AtomicBool,
    ) -> anyhow::Result<Self> {
        let progress = Progress::new("measuring");
        let options = BuildOptions { threads, cancel: Some(cancel), ..BuildOptions::default() };
        let mut seconds = Vec::new();
        let (mut tree, report) = Tree::build_reported(mesh, &options)?;
        for pass in 0..passes {
            let start = Instant::now();
            tree = Tree::build(mesh, &options)?;
            seconds.push(start.elapsed().as_secs_f64());
            progress.set(0.5 * (pass + 1) as f32 / passes as f32);
        }
        seconds.sort_by(f64::total_cmp);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.context("cannot start the threads")?;
        let tracer = Tracer::new(mesh, &tree);
        let [primary, bounce, shadow] = pool.install(|| speeds(mesh, &tracer, passes, cancel))?;
        Ok(Self {
            threads,
            build_best_s: seconds[0],
            build_median_s: seconds[passes / 2],
            peak_bytes: report.peak_bytes,
            tree_bytes: tree.size_bytes(),
            primary,
            bounce,
            shadow,
        })
    }
}

/// Speeds of camera rays, their diffuse reflections, and shadow rays from the same places.
fn speeds(
    mesh: &Mesh,
    tracer: &Tracer,
    passes: usize,
    cancel: &AtomicBool,
) -> Result<[Option<f64>; 3], BuildError> {
    let primary = rays::primary(mesh);
    let mut hits = vec![None; primary.len()];
    tracer.closest_hits(&primary, &mut hits);
    let starts = rays::starts(mesh, &primary, &hits);
    let (bounce, shadow) = (rays::bounce(&starts), rays::shadow(mesh, &starts));
    let closest = |rays: &[Ray]| {
        let mut hits = vec![None; rays.len()];
        best_speed(rays.len(), passes, cancel, || tracer.closest_hits(rays, &mut hits))
    };
    let mut blocked = vec![false; shadow.len()];
    let any = || tracer.any_hits(&shadow, &mut blocked);
    Ok([closest(&primary)?, closest(&bounce)?, best_speed(shadow.len(), passes, cancel, any)?])
}

/// Million rays a second in the best of some passes.
fn best_speed(
    rays: usize,
    passes: usize,
    cancel: &AtomicBool,
    mut trace: impl FnMut(),
) -> Result<Option<f64>, BuildError> {
    let mut best = f64::INFINITY;
    for _pass in 0..passes {
        if cancel.load(Ordering::Relaxed) {
            return Err(BuildError::Cancelled);
        }
        let start = Instant::now();
        trace();
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok((rays > 0).then(|| rays as f64 / best.max(1e-9) / 1e6))
}
