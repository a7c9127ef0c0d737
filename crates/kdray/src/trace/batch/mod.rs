//! Queries for many rays or points.
//!
//! `options` says how a batch is asked, `fill` gives one answer a query, `stream` lists of any
//! length, and `order` brings queries that are near each other together.

mod fill;
mod options;
mod order;
mod points;
mod rays;
mod stream;

use std::ops::Range;
use std::sync::Arc;

pub use options::{BatchError, BatchOptions};
pub use stream::Lists;

use super::Tracer;
use crate::geometry::{Hit, Ray};
use options::Team;

/// Asks a [`Tracer`] many things at once; made by [`Tracer::batch`].
pub struct Batch<'a> {
    tracer: &'a Tracer,
    options: BatchOptions<'a>,
    team: Arc<Team>,
    /// What of the progress that is reported is this batch's.
    share: Range<f32>,
}

impl<'a> Batch<'a> {
    /// The same batch, whose progress is a part of it.
    fn part(&self, share: Range<f32>) -> Self {
        Self { tracer: self.tracer, options: self.options, team: self.team.clone(), share }
    }
}

/// Queries that a thread takes at a time: long enough to hide the hand-over, short enough to share
/// the last ones out, and to notice a cancellation within a fraction of a second.
const CHUNK: usize = 1024;

impl Tracer {
    /// Asks with `options`.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use kdray::{BatchOptions, BuildOptions, Mesh, Ray, Tracer, Tree};
    ///
    /// let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
    /// let tracer = Tracer::new(&mesh, &Tree::build(&mesh, &BuildOptions::default())?);
    /// let rays = [0.25, 0.75].map(|x| Ray::new([x, 0.5, 1.0], [0.0, 0.0, -1.0]));
    /// let batch = tracer.batch(BatchOptions { threads: 2, ..BatchOptions::default() })?;
    ///
    /// let mut hits = [None; 2];
    /// batch.closest_hits(&rays, &mut hits)?;
    /// assert_eq!(hits.map(|hit| hit.map(|hit| hit.t)), [Some(1.0), None]);
    ///
    /// let mut count = 0;
    /// batch.all_hits(&rays, |lists| {
    ///     count += lists.items.len();
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert_eq!(count, 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the threads cannot be started.
    ///
    /// # Panics
    ///
    /// If `options.visible` is not of as many triangles as the mesh.
    pub fn batch<'a>(&'a self, options: BatchOptions<'a>) -> Result<Batch<'a>, BatchError> {
        if let Some(visible) = options.visible {
            assert_eq!(visible.len(), self.triangle_count, "one answer a triangle");
        }
        let team = Team::new(options.threads)?;
        Ok(Batch { tracer: self, options, team: Arc::new(team), share: 0.0..1.0 })
    }

    /// Writes to `hits[i]` the closest hit of `rays[i]`, over the threads of the current `rayon`
    /// pool; [`Tracer::batch`] has more to say.
    ///
    /// # Panics
    ///
    /// If there are not as many hits as rays.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let done = self.batch(BatchOptions::default()).and_then(|it| it.closest_hits(rays, hits));
        done.expect("no threads are started, and nobody cancels");
    }

    /// Writes to `hits[i]` whether `rays[i]` hits anything, over the threads of the current `rayon`
    /// pool; [`Tracer::batch`] has more to say.
    ///
    /// # Panics
    ///
    /// If there are not as many hits as rays.
    pub fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        let done = self.batch(BatchOptions::default()).and_then(|it| it.any_hits(rays, hits));
        done.expect("no threads are started, and nobody cancels");
    }
}
