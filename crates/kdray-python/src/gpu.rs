//! Trees on a GPU, and rays that are answered there.

use std::mem;
use std::ops::{ControlFlow, Range};
use std::process;

use kdray::{BuildOptions, Mesh, Ray};
use kdray_gpu::{Batch, Device, GpuError, Kind, TraceOptions, Tracer};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::zeros;
use crate::columns::Columns;
use crate::error;
use crate::rays::{Rays, blocks};
use crate::run::Watch;

/// Rays that are brought to a GPU at a time, and to a program that stands in for one: it is slow, and
/// between blocks Ctrl-C is heard.
const BLOCK: usize = 1 << 18;
const PROGRAM_BLOCK: usize = 1 << 13;

/// What a tree has on a GPU.
pub(crate) struct OnGpu {
    tracer: Option<Tracer<'static>>,
    process: u32,
}

impl OnGpu {
    /// Brings a tree to the device.
    pub(crate) fn new(
        device: &'static Device,
        mesh: &Mesh,
        tree: &kdray::Tree,
    ) -> Result<Self, GpuError> {
        Ok(Self { tracer: Some(Tracer::new(device, mesh, tree)?), process: process::id() })
    }

    /// The tree of `mesh`, built there.
    pub(crate) fn built(
        device: &'static Device,
        mesh: &Mesh,
        options: &BuildOptions<'_>,
    ) -> Result<(kdray::Tree, Self), GpuError> {
        let (tracer, _) = Tracer::build(device, mesh, options)?;
        let tree = tracer.tree(mesh)?;
        Ok((tree, Self { tracer: Some(tracer), process: process::id() }))
    }

    /// What answers there. Drivers do not live on in the child of a fork.
    pub(crate) fn tracer(&self) -> Option<&Tracer<'static>> {
        self.tracer.as_ref().filter(|_| self.process == process::id())
    }
}

impl Drop for OnGpu {
    fn drop(&mut self) {
        if self.process != process::id() {
            mem::forget(self.tracer.take());
        }
    }
}

pub(crate) fn closest(rays: &Rays, tracer: &Tracer<'static>, watch: &Watch) -> PyResult<Columns> {
    let mut columns = Columns::new(0)?;
    in_blocks(rays, tracer, watch, |_, batch, rays| {
        let mut hits = vec![None; rays.len()];
        batch.closest_hits(rays, &mut hits)?;
        hits.into_iter().for_each(|hit| columns.push(hit));
        Ok(())
    })?;
    Ok(columns)
}

pub(crate) fn any(rays: &Rays, tracer: &Tracer<'static>, watch: &Watch) -> PyResult<Vec<bool>> {
    let mut found = zeros(rays.len())?;
    in_blocks(rays, tracer, watch, |block, batch, rays| batch.any_hits(rays, &mut found[block]))?;
    Ok(found)
}

pub(crate) fn count(rays: &Rays, tracer: &Tracer<'static>, watch: &Watch) -> PyResult<Vec<i32>> {
    let mut counts: Vec<i32> = zeros(rays.len())?;
    in_blocks(rays, tracer, watch, |block, batch, rays| {
        batch.count_hits(rays, bytemuck::cast_slice_mut(&mut counts[block]))
    })?;
    Ok(counts)
}

/// The first `limit` hits of every ray, one ray after the other, and where each ray's begin.
pub(crate) fn all(
    rays: &Rays,
    limit: usize,
    tracer: &Tracer<'static>,
    watch: &Watch,
) -> PyResult<(Vec<i64>, Columns)> {
    let (mut offsets, mut columns) = (vec![0], Columns::new(0)?);
    in_blocks(rays, tracer, watch, |_, batch, rays| {
        batch.all_hits(rays, |lists| {
            for hits in lists.lists() {
                hits.iter().take(limit).for_each(|hit| columns.push(Some(*hit)));
                offsets.push(columns.t.len() as i64);
            }
            if watch.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    })?;
    Ok((offsets, columns))
}

/// Lets `ask` ask for some rays after the others, which bounds the memory that they take.
fn in_blocks(
    rays: &Rays,
    tracer: &Tracer<'static>,
    watch: &Watch,
    mut ask: impl FnMut(Range<usize>, &Batch<'_>, &[Ray]) -> Result<(), GpuError>,
) -> PyResult<()> {
    let is_program = tracer.device().adapter().kind == Kind::Software;
    let block = if is_program { PROGRAM_BLOCK } else { BLOCK };
    let mut local = Vec::new();
    for block in blocks(rays.len(), block) {
        block.clone().into_par_iter().map(|index| rays.get(index)).collect_into_vec(&mut local);
        let options = TraceOptions {
            except: rays.except(block.clone()),
            cancel: Some(watch.cancel()),
            ..TraceOptions::default()
        };
        ask(block, &tracer.batch(options), &local).map_err(|error| error::gpu(&error))?;
    }
    Ok(())
}
