//! The extents of subtrees, from those of their children.

use super::arrays::{Array, Arrays};
use super::data::{Extent, NONE, Record};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const WEIGH: Kernel = Kernel {
    shader: Shader {
        name: "weigh",
        source: include_str!("weigh.wgsl"),
        bindings: &[Uniform, Read, Read, Write],
    },
    arrays: &[Array::Records, Array::Finished, Array::Extents],
    moved: |p| Moved { read: w(p.count) * 24, written: w(p.count) * 8 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Extents, |arrays, extents: &mut [Extent]| {
        for index in params.records..params.records + params.count {
            let record = arrays.of::<Record>(Array::Records)[index as usize];
            extents[index as usize] = match record.children() {
                None if record.second == NONE => {
                    let piece = &arrays[Array::Finished][record.first as usize..];
                    Extent { nodes: piece[0], references: piece[1] }
                }
                None => Extent { nodes: 1, references: record.second >> 2 },
                Some(children) => Extent {
                    nodes: 1 + extents[children].nodes + extents[children + 1].nodes,
                    references: extents[children].references + extents[children + 1].references,
                },
            };
        }
    });
}
