//! Where the rays of a picture are traced.

use std::error::Error;
use std::sync::{Mutex, PoisonError};

use kdray::{Hit, Ray, Tracer};

use crate::Cancelled;

/// What goes wrong in a [`Caster`].
pub type CasterError = Box<dyn Error + Send + Sync>;

/// Answers rays, many at a time: a tracer on another device.
pub trait Caster: Sync {
    /// Writes to `hits[i]` the closest hit of `rays[i]`.
    ///
    /// # Errors
    ///
    /// Whatever keeps it from doing so.
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<(), CasterError>;

    /// Writes to `found[i]` whether `rays[i]` hits anything.
    ///
    /// # Errors
    ///
    /// Whatever keeps it from doing so.
    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) -> Result<(), CasterError>;
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The caller asked the picture to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The rays got no answers.
    #[error(transparent)]
    Caster(CasterError),
}

/// What answers the rays of a scene.
pub(crate) enum Source<'a> {
    /// One after the other, on the thread that asks.
    Tracer(&'a Tracer),
    /// Many at a time.
    Caster(Casting<'a>),
}

/// A caster, and what went wrong with it: that ends a picture as if it were cancelled.
pub(crate) struct Casting<'a> {
    caster: &'a dyn Caster,
    failure: Mutex<Option<CasterError>>,
}

impl<'a> Casting<'a> {
    pub(crate) fn new(caster: &'a dyn Caster) -> Self {
        Self { caster, failure: Mutex::new(None) }
    }

    pub(crate) fn closest_hits(&self, rays: &[Ray]) -> Result<Vec<Option<Hit>>, Cancelled> {
        let mut hits = vec![None; rays.len()];
        self.keep(self.caster.closest_hits(rays, &mut hits))?;
        Ok(hits)
    }

    pub(crate) fn any_hits(&self, rays: &[Ray]) -> Result<Vec<bool>, Cancelled> {
        let mut found = vec![false; rays.len()];
        self.keep(self.caster.any_hits(rays, &mut found))?;
        Ok(found)
    }

    fn keep(&self, result: Result<(), CasterError>) -> Result<(), Cancelled> {
        result.map_err(|error| {
            self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            Cancelled
        })
    }

    /// What went wrong.
    pub(crate) fn into_failure(self) -> Option<CasterError> {
        self.failure.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}
