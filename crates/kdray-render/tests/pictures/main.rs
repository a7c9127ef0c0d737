//! Whole pictures, judged by what physics and the options promise, by snapshots that people have
//! looked at, and beside each other.

mod cpu;
#[cfg(feature = "gpu")]
mod gpu;
mod support;
