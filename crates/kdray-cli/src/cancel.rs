//! Ctrl-C.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;

static CANCELLED: AtomicBool = AtomicBool::new(false);

/// From now on an interrupt sets the flag that is returned; a second one ends the program at once.
pub(crate) fn flag() -> anyhow::Result<&'static AtomicBool> {
    ctrlc::set_handler(|| {
        if CANCELLED.swap(true, Ordering::Relaxed) {
            process::exit(130);
        }
    })
    .context("cannot listen for Ctrl-C")?;
    Ok(&CANCELLED)
}
