//! A kernel: a shader, the arrays it works on, and its twin.

use bytemuck::{Pod, Zeroable};

use super::arrays::{Array, Arrays};
use crate::record::{Kernel as Shader, Moved};

/// Events or references that one invocation walks through.
///
/// More makes the scans of the counts shorter; less gives small levels more invocations.
pub(crate) const CHUNK: u32 = 32;

/// One step of a stage. `twin` does to arrays in the CPU's memory what the shader does to the
/// device's.
pub(crate) struct Kernel {
    pub(crate) shader: Shader,
    /// What the shader binds behind the parameters.
    pub(crate) arrays: &'static [Array],
    /// Bytes that it reads and writes: every element once, and every probe of a search.
    pub(crate) moved: fn(&Params) -> Moved,
    /// Who works on one of the `count` elements.
    pub(crate) by: Worker,
    pub(crate) twin: fn(&mut Arrays, &Params),
}

/// Who works on an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Worker {
    Invocation,
    /// A workgroup of [`TEAM`](crate::record::TEAM) invocations.
    Team,
}

/// A count as a factor of bytes.
pub(crate) fn w(count: u32) -> u64 {
    count.into()
}

/// Numbers that every kernel of a level can ask for.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Params {
    /// Invocations that have work.
    pub(crate) count: u32,
    /// Nodes of the level and of the next.
    pub(crate) nodes: u32,
    pub(crate) next_nodes: u32,
    /// Room for events along an axis, in this level, in the next and among the new ones.
    pub(crate) events: u32,
    pub(crate) next_events: u32,
    pub(crate) fresh_events: u32,
    /// By where they go, references of the level; known after the first half of its kernels.
    pub(crate) straddlers: u32,
    pub(crate) left: u32,
    pub(crate) right: u32,
    pub(crate) leaf: u32,
    pub(crate) gone: u32,
    /// Records of the levels before, records with this one, and words of what is finished.
    pub(crate) records: u32,
    pub(crate) next_records: u32,
    pub(crate) finished: u32,
    /// Length of the runs that are merged.
    pub(crate) run: u32,
    /// 1 if nodes of the level may be cut.
    pub(crate) may_split: u32,
    pub(crate) max_leaf: u32,
    /// 1 if straddlers are clipped.
    pub(crate) clip: u32,
    pub(crate) traversal: f32,
    pub(crate) intersect: f32,
    pub(crate) empty_factor: f32,
    pub(crate) triangles: u32,
    /// Where a part of the level begins.
    pub(crate) first_node: u32,
    /// Levels below this one that there may be.
    pub(crate) depth_left: u32,
    /// Words of the level's pieces.
    pub(crate) piece_words: u32,
    /// The axis whose events are made.
    pub(crate) axis: u32,
    /// The axis whose events are the first: of a narrow level, the only one that has some.
    pub(crate) base_axis: u32,
    /// 1 if references have bounds of their own.
    pub(crate) has_bounds: u32,
}

impl Params {
    /// Chunks of events along an axis.
    pub(crate) fn event_chunks(&self) -> u32 {
        self.events.div_ceil(CHUNK).max(1)
    }

    /// Axes that are swept, if `count` are all chunks of events.
    pub(crate) fn axes(&self) -> u64 {
        w(self.count / self.event_chunks())
    }

    /// Chunks of references; an axis has room for two events of each.
    pub(crate) fn reference_chunks(&self) -> u32 {
        (self.events / 2).div_ceil(CHUNK).max(1)
    }

    /// References of the level; known after the first half of its kernels.
    pub(crate) fn references(&self) -> u32 {
        self.straddlers + self.left + self.right + self.leaf + self.gone
    }
}

/// Places of a chunk of `count` elements.
pub(crate) fn chunk(index: u32, count: u32) -> std::ops::Range<u32> {
    (index * CHUNK).min(count)..((index + 1) * CHUNK).min(count)
}
