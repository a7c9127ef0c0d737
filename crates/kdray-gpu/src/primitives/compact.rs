//! Stable compaction: values with a flag move together, in their order.

use bytemuck::{Pod, Zeroable};

use super::scan::Scan;
use crate::device::Buffer;
use crate::record::{Binding, Count, CountParams, Kernel, Moved, Recording, Work};

pub(crate) static COMPACT: Kernel = Kernel {
    name: "compact",
    source: include_str!("compact.wgsl"),
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
pub(crate) struct Params {
    pub(crate) count: CountParams,
    pub(crate) total_at: u32,
    pub(crate) unused: [u32; 3],
}

/// What is compacted, and where to.
#[derive(Clone, Copy, Debug)]
pub struct Compaction<'a> {
    /// 1 for a value that is kept, else 0; becomes the places of values.
    pub flags: &'a Buffer,
    /// The values.
    pub values: &'a Buffer,
    /// Room for those that are kept.
    pub kept: &'a Buffer,
    /// The word that gets their number, in a buffer that does not hold a live count.
    pub total: (&'a Buffer, u32),
}

impl Compaction<'_> {
    /// Keeps those of the first `count` values that have a flag. Costs the dispatches of a scan, and
    /// one.
    ///
    /// # Panics
    ///
    /// If there may be more values than `scan` has room for.
    pub fn record(&self, recording: &mut Recording, scan: &Scan, count: &Count) {
        let Self { flags, values, kept, total } = *self;
        scan.record(recording, flags, count, Some(total));
        let params = Params { count: count.params(), total_at: total.1, unused: [0; 3] };
        let counter = count.counter(recording.device());
        let buffers = [counter, flags, total.0, values, kept];
        let moved = |n| Moved { read: 8 * n, written: 4 * n };
        recording.dispatch(&COMPACT, &params, &buffers, &Work::each(count), moved);
    }
}

/// Twin: the values that have a flag, in their order.
#[must_use]
pub fn kept(flags: &[u32], values: &[u32]) -> Vec<u32> {
    let flagged = flags.iter().zip(values).filter(|(flag, _)| **flag != 0);
    flagged.map(|(_, &value)| value).collect()
}
