//! Merges sorted runs of new events two by two.

use super::arrays::{Array, Arrays};
use super::data::Event;
use super::kernel::{Kernel, Params, Worker, w};
use super::rank::each_list;
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const MERGE: Kernel = Kernel {
    shader: Shader {
        name: "merge",
        source: include_str!("merge.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write],
    },
    arrays: &[Array::NextReferences, Array::NextNodes, Array::Fresh, Array::NextFresh],
    moved: |p| Moved {
        read: 3 * w(p.fresh_events) * (24 + 8 * w(p.run.ilog2())),
        written: 3 * w(p.fresh_events) * 8,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::NextFresh, |arrays, merged: &mut [Event]| {
        let width = 2 * params.run as usize;
        each_list(arrays, params, |first, events| {
            for (runs, start) in events.chunks(width).zip((first..).step_by(width)) {
                let merged = &mut merged[start..start + runs.len()];
                merged.copy_from_slice(runs);
                // Stable, and quick where two runs are sorted.
                merged.sort_by_key(|event| event.order());
            }
        });
    });
}
