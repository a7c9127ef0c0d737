//! Work on all cores, while the interpreter goes on and Ctrl-C is heard.

use std::collections::HashMap;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use kdray::BatchOptions;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::process::OfProcess;

/// How often a call that takes long asks the interpreter for signals.
const PATIENCE: Duration = Duration::from_millis(50);

/// The most threads that can be asked for.
const MOST_THREADS: usize = 1024;

/// What the caller and the work say to each other.
#[derive(Default)]
pub(crate) struct Watch {
    cancelled: AtomicBool,
    /// The bits of the fraction that is done.
    progress: AtomicU32,
}

impl Watch {
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// A flag that becomes true when the work should end.
    pub(crate) fn cancel(&self) -> &AtomicBool {
        &self.cancelled
    }

    /// Options of a batch that is asked on the threads at hand, and ends when the work should.
    pub(crate) fn batch_options(&self) -> BatchOptions<'_> {
        BatchOptions { cancel: Some(&self.cancelled), ..BatchOptions::default() }
    }

    /// Estimates may fall; what the caller hears does not. Bits compare like fractions.
    pub(crate) fn report(&self, fraction: f32) {
        self.progress.fetch_max(fraction.to_bits(), Ordering::Relaxed);
    }

    /// Lets the interpreter handle its signals, and the caller see the progress.
    fn attend(&self, py: Python<'_>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        py.check_signals()?;
        if let Some(progress) = progress {
            progress.call1(py, (f32::from_bits(self.progress.load(Ordering::Relaxed)),))?;
        }
        Ok(())
    }
}

/// Gives what `work` gives, on `threads` threads (0 for one a core) and detached from the
/// interpreter. `progress` is called with the fraction that is done, last with 1.
///
/// # Errors
///
/// What a signal handler or `progress` raises; the work was told to end, and has.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    threads: usize,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    let pool = pool(threads)?;
    let watch = Watch::default();
    let answer = py.detach(|| {
        pool.in_place_scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            let watch = &watch;
            // The receiver is there until the work has ended.
            scope.spawn(move |_| sender.send(work(watch)).unwrap_or(()));
            loop {
                match receiver.recv_timeout(PATIENCE) {
                    Ok(answer) => return Ok(answer),
                    Err(RecvTimeoutError::Timeout) => {}
                    // The scope hands the panic on.
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(without_answer());
                    }
                }
                if let Err(error) = Python::attach(|py| watch.attend(py, progress)) {
                    watch.cancelled.store(true, Ordering::Relaxed);
                    drop(receiver.recv());
                    return Err(error);
                }
            }
        })
    })?;
    watch.report(1.0);
    watch.attend(py, progress)?;
    Ok(answer)
}

/// Gives what `work` gives, on `threads` threads (0 for one a core) and detached from the interpreter.
/// It cannot be told to end: after a signal it goes on alone, and what it gives is dropped.
///
/// # Errors
///
/// What a signal handler raises.
pub(crate) fn run_owned<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel();
    pool(threads)?.spawn(move || {
        // A panic is for the caller, if there still is one.
        drop(sender.send(panic::catch_unwind(AssertUnwindSafe(work))));
    });
    py.detach(move || {
        loop {
            match receiver.recv_timeout(PATIENCE) {
                Ok(answer) => return Ok(answer.unwrap_or_else(|it| panic::resume_unwind(it))),
                Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals())?,
                Err(RecvTimeoutError::Disconnected) => return Err(without_answer()),
            }
        }
    })
}

fn without_answer() -> PyErr {
    PyRuntimeError::new_err("the work ended without an answer")
}

/// The pools by their number of threads.
static POOLS: OfProcess<HashMap<usize, Arc<ThreadPool>>> = OfProcess::new();

/// The pool of `threads` threads.
fn pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    if threads > MOST_THREADS {
        let message = format!("threads is {threads}, which is more than {MOST_THREADS}");
        return Err(PyValueError::new_err(message));
    }
    POOLS.with(|pools| {
        if let Some(pool) = pools.get(&threads) {
            return Ok(Arc::clone(pool));
        }
        let named = |index| format!("kdray-{index}");
        let builder = ThreadPoolBuilder::new().num_threads(threads).thread_name(named);
        let pool = builder.build().map_err(|error| {
            PyOSError::new_err(format!("threads: could not start {threads}: {error}"))
        })?;
        Ok(Arc::clone(pools.entry(threads).or_insert(Arc::new(pool))))
    })
}
