//! Segmented arg-min: the first least value of every segment, whatever the segments.
//!
//! The least of every 32 values is found, of every 32 of those, and so on, regardless of segments.
//! Then an invocation a segment looks at its ends value by value, and at what lies between block by
//! block. So a segment of all values and as many segments as values cost about the same.

use bytemuck::{Pod, Zeroable};

use crate::device::{Buffer, Device};
use crate::error::GpuError;
use crate::record::{Binding, Count, CountParams, Kernel, Moved, Recording, Work};

/// Entries of a block. More make fewer levels and longer searches.
pub(crate) const BLOCK: u32 = 32;

/// Levels of blocks that an index of 32 bits can ask for.
const LEVELS: usize = 7;

/// What an empty segment has.
pub const NONE: u32 = u32::MAX;

pub(crate) static REDUCE: Kernel = Kernel {
    name: "arg_min_reduce",
    source: include_str!("arg_min_reduce.wgsl"),
    bindings: &[Binding::Uniform, Binding::Read, Binding::Read, Binding::Write],
};

pub(crate) static QUERY: Kernel = Kernel {
    name: "arg_min_query",
    source: include_str!("arg_min_query.wgsl"),
    bindings: &[
        Binding::Uniform,
        Binding::Read,
        Binding::Read,
        Binding::Read,
        Binding::Read,
        Binding::Write,
    ],
};

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct ReduceParams {
    pub(crate) count: CountParams,
    pub(crate) level: u32,
    pub(crate) below: u32,
    pub(crate) to: u32,
    pub(crate) width: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct QueryParams {
    pub(crate) count: CountParams,
    pub(crate) levels: u32,
    pub(crate) width: u32,
    pub(crate) unused: [u32; 2],
    pub(crate) starts: [u32; 8],
}

/// Room for arg-mins of up to a number of values: a 31st of theirs.
#[derive(Debug)]
pub struct ArgMin {
    bound: u32,
    blocks: Buffer,
    /// Where every level of blocks starts, from level 1 on.
    starts: Vec<u32>,
}

/// What is searched, and where to.
#[derive(Clone, Copy, Debug)]
pub struct Segments<'a> {
    /// The values, of `width` words each. The first word counts most.
    pub values: &'a Buffer,
    /// Words of a value, one to three.
    pub width: u32,
    /// Segment `s` is from `offsets[s]` to `offsets[s + 1]`; it may be empty.
    pub offsets: &'a Buffer,
    /// Room for the index of every segment's least value, the first of equals; [`NONE`] if it is
    /// empty.
    pub minima: &'a Buffer,
}

impl ArgMin {
    /// Makes room for arg-mins of up to `bound` values.
    ///
    /// # Errors
    ///
    /// If the device has no memory for it.
    pub fn new(device: &Device, bound: u32) -> Result<Self, GpuError> {
        let mut starts = Vec::new();
        let (mut entries, mut end) = (bound, 0);
        while entries > 2 * BLOCK {
            starts.push(end);
            entries = entries.div_ceil(BLOCK);
            end += entries;
        }
        Ok(Self { bound, blocks: device.buffer("least of blocks", end.into())?, starts })
    }

    /// Finds the least of every one of `segments` segments of the first `count` values. Costs a
    /// dispatch a level, at most six for all that a binding holds, and one.
    ///
    /// # Panics
    ///
    /// If there may be more values than room was made for.
    pub fn record(
        &self,
        recording: &mut Recording,
        what: Segments,
        count: &Count,
        segments: &Count,
    ) {
        assert!(count.bound() <= self.bound, "{} values, room for {}", count.bound(), self.bound);
        let width = what.width;
        let counter = count.counter(recording.device());
        let mut blocks = count.clone();
        for (level, &to) in self.starts.iter().enumerate() {
            blocks = blocks.blocks(BLOCK);
            let below = if level == 0 { 0 } else { self.starts[level - 1] };
            let (count, level) = (blocks.params(), level as u32);
            let params = ReduceParams { count, level, below, to, width };
            // An entry of a higher level is an index and the value that it names.
            let words = u64::from(width) + u64::from(level > 0);
            let moved = move |n| Moved { read: 4 * words * n * u64::from(BLOCK), written: 4 * n };
            let buffers = [counter, what.values, &self.blocks];
            recording.dispatch(&REDUCE, &params, &buffers, &Work::each(&blocks), moved);
        }
        self.query(recording, what, segments);
    }

    fn query(&self, recording: &mut Recording, what: Segments, segments: &Count) {
        let mut starts = [0; LEVELS + 1];
        starts[1..=self.starts.len()].copy_from_slice(&self.starts);
        let (levels, width) = (self.starts.len() as u32, what.width);
        let params =
            QueryParams { count: segments.params(), levels, width, unused: [0; 2], starts };
        let counter = segments.counter(recording.device());
        let buffers = [counter, what.values, &self.blocks, what.offsets, what.minima];
        // At most: all values once more, where every segment is short.
        let values = 4 * u64::from(width) * u64::from(self.bound);
        let per_segment = 4 * u64::from(width + 1) * 64 * u64::from(levels + 1);
        let moved = move |n| Moved { read: 8 * n + values.min(n * per_segment), written: 4 * n };
        recording.dispatch(&QUERY, &params, &buffers, &Work::each(segments), moved);
    }
}

/// Twin: the index of the first least value of every segment.
///
/// # Panics
///
/// If an offset lies beyond the values.
#[must_use]
pub fn arg_min(values: &[u32], width: usize, offsets: &[u32]) -> Vec<u32> {
    let key = |i: u32| &values[i as usize * width..][..width];
    let segment = |ends: &[u32]| (ends[0]..ends[1]).min_by_key(|&i| key(i)).unwrap_or(NONE);
    offsets.windows(2).map(segment).collect()
}
