//! Memory budget, progress and cancellation of one build.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{BuildError, BuildOptions};

/// Keeps the books of a build. Shared by its threads.
pub(super) struct Meter<'a> {
    options: &'a BuildOptions<'a>,
    current: AtomicU64,
    peak: AtomicU64,
    done: Mutex<Done>,
}

/// Progress so far, and as last reported.
struct Done {
    fraction: f64,
    reported: f64,
}

/// Progress is reported in steps of at least this fraction.
const REPORT_STEP: f64 = 0.01;

impl<'a> Meter<'a> {
    pub(super) fn new(options: &'a BuildOptions<'a>) -> Self {
        Self {
            options,
            current: AtomicU64::new(0),
            peak: AtomicU64::new(0),
            done: Mutex::new(Done { fraction: 0.0, reported: 0.0 }),
        }
    }

    /// Books `bytes` for `stage`, or says that the budget cannot hold them.
    pub(super) fn charge(&self, stage: &'static str, bytes: usize) -> Result<(), BuildError> {
        let needed = self.current.fetch_add(bytes as u64, Ordering::Relaxed) + bytes as u64;
        self.peak.fetch_max(needed, Ordering::Relaxed);
        match self.options.memory_budget {
            Some(budget) if needed > budget => {
                Err(BuildError::MemoryBudget { stage, needed, budget })
            }
            _ => Ok(()),
        }
    }

    /// Gives `bytes` back.
    pub(super) fn release(&self, bytes: usize) {
        self.current.fetch_sub(bytes as u64, Ordering::Relaxed);
    }

    pub(super) fn peak_bytes(&self) -> u64 {
        self.peak.load(Ordering::Relaxed)
    }

    /// Ends the build if the caller wants it to end.
    pub(super) fn check_cancelled(&self) -> Result<(), BuildError> {
        match self.options.cancel {
            Some(cancel) if cancel.load(Ordering::Relaxed) => Err(BuildError::Cancelled),
            _ => Ok(()),
        }
    }

    /// Books `fraction` of the build as done.
    pub(super) fn advance(&self, fraction: f64) {
        let Some(report) = self.options.progress else {
            return;
        };
        let mut done = self.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        done.fraction = (done.fraction + fraction).min(1.0);
        if done.fraction - done.reported >= REPORT_STEP {
            done.reported = done.fraction;
            report(done.fraction as f32);
        }
    }

    /// Reports that all is done.
    pub(super) fn finish(&self) {
        if let Some(report) = self.options.progress {
            report(1.0);
        }
    }
}
