//! Exclusive prefix sums: reduce, then scan.
//!
//! Tiles of [`TILE`] values are summed, the sums scanned, and then every tile with what comes before
//! it: three dispatches up to 16 million values, five beyond. No workgroup waits for another one,
//! which not every device allows.

use bytemuck::{Pod, Zeroable};

use crate::device::{Buffer, Device};
use crate::error::GpuError;
use crate::record::{Binding, Count, CountParams, Kernel, Moved, Recording, TILE, Work};

pub(crate) static REDUCE: Kernel = Kernel {
    name: "scan_reduce",
    source: include_str!("scan_reduce.wgsl"),
    bindings: &[Binding::Uniform, Binding::Read, Binding::Read, Binding::Write],
};

pub(crate) static APPLY: Kernel = Kernel {
    name: "scan_apply",
    source: include_str!("scan_apply.wgsl"),
    bindings: &[Binding::Uniform, Binding::Read, Binding::Read, Binding::Write, Binding::Write],
};

/// No place for a total.
pub(crate) const NOWHERE: u32 = u32::MAX;

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct ApplyParams {
    pub(crate) count: CountParams,
    pub(crate) total_at: u32,
    pub(crate) has_sums: u32,
    pub(crate) unused: [u32; 2],
}

/// Room for scans of up to a number of values: a 1,024th of theirs.
#[derive(Debug)]
pub struct Scan {
    bound: u32,
    /// Sums of tiles, of tiles of those, and so on, down to a single tile.
    levels: Vec<Buffer>,
    /// A place for totals that nobody asks for.
    nowhere: Buffer,
}

impl Scan {
    /// Makes room for scans of up to `bound` values.
    ///
    /// # Errors
    ///
    /// If the device has no memory for it.
    pub fn new(device: &Device, bound: u32) -> Result<Self, GpuError> {
        let mut levels = Vec::new();
        let mut tiles = bound.div_ceil(TILE);
        while tiles > 1 {
            levels.push(device.buffer("sums of tiles", tiles.into())?);
            tiles = tiles.div_ceil(TILE);
        }
        Ok(Self { bound, levels, nowhere: device.buffer("a total", 1)? })
    }

    /// The most values that there is room for.
    #[must_use]
    pub fn bound(&self) -> u32 {
        self.bound
    }

    /// Bytes of the device that it takes.
    #[must_use]
    pub fn size_bytes(&self) -> u64 {
        self.levels.iter().chain([&self.nowhere]).map(Buffer::size_bytes).sum()
    }

    /// Replaces the first `count` of `values` by the sums of those before each; sums wrap. The sum
    /// of all goes to a word of the buffer `total`, which is not the one that holds a live count.
    ///
    /// # Panics
    ///
    /// If there may be more values than room was made for.
    pub fn record(
        &self,
        recording: &mut Recording,
        values: &Buffer,
        count: &Count,
        total: Option<(&Buffer, u32)>,
    ) {
        assert!(count.bound() <= self.bound, "{} values, room for {}", count.bound(), self.bound);
        self.level(0, recording, values, count, total);
    }

    fn level(
        &self,
        level: usize,
        recording: &mut Recording,
        values: &Buffer,
        count: &Count,
        total: Option<(&Buffer, u32)>,
    ) {
        let counter = count.counter(recording.device());
        let Some(sums) = self.levels.get(level).filter(|_| count.bound() > TILE) else {
            let (total, total_at) = total.unwrap_or((&self.nowhere, NOWHERE));
            let params = ApplyParams { total_at, ..ApplyParams::new(count, false) };
            let buffers = [counter, counter, values, total];
            recording.dispatch(&APPLY, &params, &buffers, &Work::one(count), in_place);
            return;
        };
        let reduced = |n: u64| Moved { read: 4 * n, written: 4 * n.div_ceil(TILE.into()) };
        let tiles = Work::tiles(count);
        recording.dispatch(&REDUCE, &count.params(), &[counter, values, sums], &tiles, reduced);
        self.level(level + 1, recording, sums, &count.blocks(TILE), total);
        let params = ApplyParams::new(count, true);
        let buffers = [counter, sums, values, &self.nowhere];
        recording.dispatch(&APPLY, &params, &buffers, &tiles, in_place);
    }
}

impl ApplyParams {
    fn new(count: &Count, has_sums: bool) -> Self {
        let has_sums = has_sums.into();
        Self { count: count.params(), total_at: NOWHERE, has_sums, unused: [0; 2] }
    }
}

/// Every value is read and written. That a workgroup reads its tile twice is not counted: the second
/// time it is in the cache.
fn in_place(count: u64) -> Moved {
    Moved { read: 4 * count, written: 4 * count }
}

/// Twin: replaces `values` by the sums of those before each, and gives the sum of all.
pub fn exclusive(values: &mut [u32]) -> u32 {
    let mut sums: Vec<u32> = values.chunks(TILE as usize).map(reduce).collect();
    if sums.len() > 1 {
        let total = exclusive(&mut sums);
        for (tile, sum) in values.chunks_mut(TILE as usize).zip(sums) {
            apply(tile, sum);
        }
        return total;
    }
    apply(values, 0)
}

/// Twin of `scan_reduce.wgsl`: the sum of a tile.
fn reduce(tile: &[u32]) -> u32 {
    tile.iter().fold(0, |sum, &value| sum.wrapping_add(value))
}

/// Twin of `scan_apply.wgsl`: scans a tile that comes after `before`, and gives the sum up to its
/// end.
fn apply(tile: &mut [u32], before: u32) -> u32 {
    tile.iter_mut().fold(before, |sum, value| {
        let next = sum.wrapping_add(*value);
        *value = sum;
        next
    })
}
