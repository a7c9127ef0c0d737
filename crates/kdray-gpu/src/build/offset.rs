//! What comes before each subtree in the finished tree, from what comes before its parent.

use super::arrays::{Array, Arrays};
use super::data::{Extent, Record};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const OFFSET: Kernel = Kernel {
    shader: Shader {
        name: "offset",
        source: include_str!("offset.wgsl"),
        bindings: &[Uniform, Read, Write],
    },
    arrays: &[Array::Records, Array::Extents],
    moved: |p| Moved { read: w(p.count) * 24, written: w(p.count) * 8 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Extents, |arrays, extents: &mut [Extent]| {
        for index in params.records..params.records + params.count {
            if index == 0 {
                extents[0] = Extent::default();
            }
            let record = arrays.of::<Record>(Array::Records)[index as usize];
            if let Some(children) = record.children() {
                let Extent { nodes, references } = extents[index as usize];
                let left = extents[children];
                extents[children] = Extent { nodes: nodes + 1, references };
                extents[children + 1] = Extent {
                    nodes: nodes + 1 + left.nodes,
                    references: references + left.references,
                };
            }
        }
    });
}
