//! What a process has for itself.

use std::mem;
use std::sync::{Mutex, PoisonError};

/// Something that does not live on in the child of a fork, such as threads: a child starts from
/// nothing.
pub(crate) struct OfProcess<T>(Mutex<Option<(u32, T)>>);

impl<T: Default> OfProcess<T> {
    pub(crate) const fn new() -> Self {
        Self(Mutex::new(None))
    }

    /// What `ask` says of it. Callers are attached to the interpreter, and so is whoever forks: the
    /// lock is free then. So `ask` must not detach, or take long.
    pub(crate) fn with<R>(&self, ask: impl FnOnce(&mut T) -> R) -> R {
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let process = std::process::id();
        if held.as_ref().is_some_and(|(owner, _)| *owner != process) {
            // Its threads cannot be waited for.
            mem::forget(held.take());
        }
        ask(&mut held.get_or_insert_with(|| (process, T::default())).1)
    }
}
