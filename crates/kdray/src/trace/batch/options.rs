//! How a batch is asked, and what can end it.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::Batch;

/// Options of a batch; change the fields you care about.
#[derive(Clone, Copy, Default)]
pub struct BatchOptions<'a> {
    /// Threads that ask; 0 for those of the current `rayon` pool. The answers are the same.
    pub threads: usize,
    /// Whether queries near each other are asked one after the other, whatever their order. The
    /// answers are the same, and where they were. It takes sorting. Closest points, and inside or
    /// outside by parity, are always asked in an order of their own, and lists never.
    pub reorder: bool,
    /// By triangle, whether rays see it; `None` for all.
    pub visible: Option<&'a [bool]>,
    /// By ray, a triangle that it does not see, such as the one that it starts on; `u32::MAX` for
    /// none.
    pub except: Option<&'a [u32]>,
    /// Called now and then, from any of the threads, with the fraction that is done.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
    /// When this becomes true the batch ends soon with [`BatchError::Cancelled`].
    pub cancel: Option<&'a AtomicBool>,
}

/// Why a batch has no answers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// The caller asked the batch to stop. Some answers may have been written.
    #[error("the queries were cancelled")]
    Cancelled,
    /// The threads could not be started.
    #[error("could not start {threads} threads: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// The threads of a batch.
pub(super) enum Team {
    Current,
    Own(rayon::ThreadPool),
}

impl Team {
    pub(super) fn new(threads: usize) -> Result<Self, BatchError> {
        if threads == 0 {
            return Ok(Self::Current);
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map(Self::Own)
            .map_err(|error| BatchError::Threads { threads, reason: error.to_string() })
    }

    pub(super) fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match self {
            Self::Current => work(),
            Self::Own(pool) => pool.install(work),
        }
    }

    pub(super) fn threads(&self) -> usize {
        match self {
            Self::Current => rayon::current_num_threads(),
            Self::Own(pool) => pool.current_num_threads(),
        }
    }
}

/// How far a batch is.
pub(super) struct Meter<'a> {
    options: &'a BatchOptions<'a>,
    share: &'a Range<f32>,
    total: usize,
    done: AtomicUsize,
}

impl<'a> Meter<'a> {
    pub(super) fn new(batch: &'a Batch<'_>, total: usize) -> Self {
        let Batch { options, share, .. } = batch;
        Self { options, share, total, done: AtomicUsize::new(0) }
    }

    /// Ends the batch if the caller wants it to end.
    pub(super) fn check(&self) -> Result<(), BatchError> {
        match self.options.cancel {
            Some(cancel) if cancel.load(Ordering::Relaxed) => Err(BatchError::Cancelled),
            _ => Ok(()),
        }
    }

    /// Books queries as done.
    pub(super) fn advance(&self, queries: usize) {
        let done = self.done.fetch_add(queries, Ordering::Relaxed) + queries;
        if let Some(report) = self.options.progress {
            report(self.fraction(done));
        }
    }

    /// The fraction that is done of what the batch is a part of.
    pub(super) fn so_far(&self) -> f32 {
        self.fraction(self.done.load(Ordering::Relaxed))
    }

    fn fraction(&self, done: usize) -> f32 {
        let Range { start, end } = self.share;
        if done == self.total {
            *end
        } else {
            start + (end - start) * (done as f32 / self.total as f32)
        }
    }
}
