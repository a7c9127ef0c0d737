//! Sorts short runs of each child's new events, by counting for each how many come before it.

use super::arrays::{Array, Arrays};
use super::data::{Event, Node};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

/// Events of a run.
pub(crate) const RUN: u32 = 64;

pub(crate) const RANK: Kernel = Kernel {
    shader: Shader {
        name: "rank",
        source: include_str!("rank.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write],
    },
    arrays: &[Array::NextReferences, Array::NextNodes, Array::Fresh, Array::NextFresh],
    moved: |p| Moved { read: 3 * w(p.fresh_events) * 24, written: 3 * w(p.fresh_events) * 8 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::NextFresh, |arrays, sorted: &mut [Event]| {
        each_list(arrays, params, |first, events| {
            for (run, start) in events.chunks(RUN as usize).zip((first..).step_by(RUN as usize)) {
                let sorted = &mut sorted[start..start + run.len()];
                sorted.copy_from_slice(run);
                sorted.sort_by_key(|event| event.order());
            }
        });
    });
}

/// Calls `work` with the new events of each child along each axis, and their place.
pub(crate) fn each_list(arrays: &Arrays, params: &Params, mut work: impl FnMut(usize, &[Event])) {
    let nodes: &[Node] = arrays.of(Array::NextNodes);
    let fresh: &[Event] = arrays.of(Array::Fresh);
    for axis in 0..3 {
        for node in &nodes[..params.next_nodes as usize] {
            let first = (axis * params.fresh_events + 2 * node.fresh_first) as usize;
            work(first, &fresh[first..first + 2 * node.fresh_count as usize]);
        }
    }
}
