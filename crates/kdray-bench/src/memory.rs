//! Bytes taken from Rust's allocator while something is built.
//!
//! Counting is off except inside [`measure`], so timed passes pay one relaxed load per call.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering::Relaxed};

use serde::{Deserialize, Serialize};

static COUNTING: AtomicBool = AtomicBool::new(false);
static METER: Meter = Meter::new();

/// Memory of a build in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub(crate) struct Memory {
    /// What is still held when the build is over.
    pub(crate) final_bytes: u64,
    /// The most held at one time, the final bytes included.
    pub(crate) peak_bytes: u64,
}

/// Current and greatest number of bytes held; shared by threads.
pub(crate) struct Meter {
    current: AtomicI64,
    peak: AtomicI64,
}

impl Meter {
    /// A meter at zero.
    pub(crate) const fn new() -> Meter {
        Meter { current: AtomicI64::new(0), peak: AtomicI64::new(0) }
    }

    /// Starts again from zero.
    pub(crate) fn reset(&self) {
        self.current.store(0, Relaxed);
        self.peak.store(0, Relaxed);
    }

    /// Counts bytes taken, or given back when negative.
    pub(crate) fn add(&self, bytes: i64) {
        let now = self.current.fetch_add(bytes, Relaxed) + bytes;
        self.peak.fetch_max(now, Relaxed);
    }

    /// What was counted since the last reset.
    pub(crate) fn memory(&self) -> Memory {
        let bytes = |counter: &AtomicI64| counter.load(Relaxed).try_into().unwrap_or(0);
        Memory { final_bytes: bytes(&self.current), peak_bytes: bytes(&self.peak) }
    }
}

/// Runs `work` and tells how much memory it took from Rust's allocator, on all threads.
pub(crate) fn measure<T>(work: impl FnOnce() -> T) -> (T, Memory) {
    METER.reset();
    COUNTING.store(true, Relaxed);
    let result = work();
    COUNTING.store(false, Relaxed);
    (result, METER.memory())
}

/// The system allocator with a meter.
pub(crate) struct Counting;

fn count(bytes: i64) {
    if COUNTING.load(Relaxed) {
        METER.add(bytes);
    }
}

// SAFETY: every call goes to the system allocator unchanged; counting touches only atomics.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: the caller keeps the contract of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as i64 - layout.size() as i64);
        // SAFETY: the caller keeps the contract of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_meter_keeps_the_peak() {
        let meter = Meter::new();
        meter.add(100);
        meter.add(50);
        meter.add(-120);
        assert_eq!(meter.memory(), Memory { final_bytes: 30, peak_bytes: 150 });
        meter.reset();
        assert_eq!(meter.memory(), Memory::default());
    }

    /// In a process of its own: other tests allocate, and free what was allocated before.
    #[test]
    fn measuring_sees_the_heap() {
        const ALONE: &str = "KDRAY_BENCH_TEST_ALONE";
        if std::env::var_os(ALONE).is_none() {
            let mut test = std::process::Command::new(std::env::current_exe().unwrap());
            test.args(["--exact", "memory::tests::measuring_sees_the_heap", "--test-threads=1"]);
            let output = test.env(ALONE, "1").output().unwrap();
            let text = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success() && text.contains("1 passed"), "{text}");
            return;
        }
        let (kept, memory) = measure(|| {
            drop(std::hint::black_box(vec![1_u8; 30_000_000]));
            std::hint::black_box(vec![1_u8; 10_000_000])
        });
        assert_eq!(kept.len(), 10_000_000);
        assert!(memory.peak_bytes >= 30_000_000, "{memory:?}");
        assert!(memory.final_bytes >= 10_000_000, "{memory:?}");
    }
}
