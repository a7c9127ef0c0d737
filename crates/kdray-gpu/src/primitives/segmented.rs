//! Exclusive prefix sums that start anew with every segment.
//!
//! Sums wrap, so a segment's own sums are those of a plain scan less what it has at the segment's
//! start: segments of any shape cost the same.

use bytemuck::{Pod, Zeroable};

use super::scan::Scan;
use crate::device::{Buffer, Device};
use crate::error::GpuError;
use crate::record::{Binding, Count, CountParams, Kernel, Moved, Recording, Work};

pub(crate) static BASES: Kernel = Kernel {
    name: "segmented_bases",
    source: include_str!("segmented_bases.wgsl"),
    bindings: &[Binding::Uniform, Binding::Read, Binding::Read, Binding::Read, Binding::Write],
};

pub(crate) static APPLY: Kernel = Kernel {
    name: "segmented_apply",
    source: include_str!("segmented_apply.wgsl"),
    bindings: &[Binding::Uniform, Binding::Read, Binding::Read, Binding::Read, Binding::Write],
};

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct Params {
    pub(crate) count: CountParams,
    pub(crate) segments: u32,
    pub(crate) unused: [u32; 3],
}

/// Room for segmented scans.
#[derive(Debug)]
pub struct SegmentedScan {
    scan: Scan,
    bases: Buffer,
}

impl SegmentedScan {
    /// Makes room for scans of up to `bound` values in up to `segments` segments.
    ///
    /// # Errors
    ///
    /// If the device has no memory for it.
    pub fn new(device: &Device, bound: u32, segments: u32) -> Result<Self, GpuError> {
        let bases = device.buffer("bases of segments", segments.into())?;
        Ok(Self { scan: Scan::new(device, bound)?, bases })
    }

    /// Replaces the first `count` of `values` by the sums of those before each in its segment.
    /// Segment `s` is from `offsets[s]` to `offsets[s + 1]`, and may be empty; together they are all
    /// values. Costs the dispatches of a scan, and two.
    ///
    /// # Panics
    ///
    /// If there may be more values or segments than room was made for.
    pub fn record(
        &self,
        recording: &mut Recording,
        values: &Buffer,
        count: &Count,
        offsets: &Buffer,
        segments: u32,
    ) {
        assert!(u64::from(segments) <= self.bases.size_bytes() / 4, "{segments} segments");
        self.scan.record(recording, values, count, None);
        let starts = Count::from(segments);
        let buffers = [starts.counter(recording.device()), offsets, values, &self.bases];
        let moved = |n| Moved { read: 8 * n, written: 4 * n };
        recording.dispatch(&BASES, &starts.params(), &buffers, &Work::each(&starts), moved);
        let params = Params { count: count.params(), segments, unused: [0; 3] };
        let buffers = [count.counter(recording.device()), offsets, &self.bases, values];
        // Neighbours look up the same segments, so each is read once.
        let read = 8 * u64::from(segments);
        let moved = move |n| Moved { read: 4 * n + read, written: 4 * n };
        recording.dispatch(&APPLY, &params, &buffers, &Work::each(count), moved);
    }
}

/// Twin: replaces `values` by the sums of those before each in its segment.
///
/// # Panics
///
/// If an offset lies beyond the values.
pub fn exclusive(values: &mut [u32], offsets: &[u32]) {
    for ends in offsets.windows(2) {
        super::scan::exclusive(&mut values[ends[0] as usize..ends[1] as usize]);
    }
}
