//! The bounds of the references of one child.

use super::arrays::{Array, Arrays};
use super::data::{NONE, Node, Part, TO_RIGHT};
use super::ends::{SPAN_BYTES, span};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const CARRY: Kernel = Kernel {
    shader: Shader {
        name: "carry",
        source: include_str!("carry.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Write],
    },
    arrays: &[
        Array::Positions,
        Array::Triangles,
        Array::Bounds,
        Array::Marks,
        Array::Parts,
        Array::Places,
        Array::NextNodes,
        Array::NextBounds,
    ],
    moved: |p| Moved {
        read: w(p.count) * (3 * SPAN_BYTES + 4) + w(p.straddlers) * 32,
        written: (w(p.count) + w(p.straddlers)) * 24,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    let side = params.first_node as usize;
    let first = arrays.of::<Node>(Array::NextNodes)[side].first;
    arrays.write(Array::NextBounds, |arrays, next: &mut [Part]| {
        for straddler in 0..params.straddlers as usize {
            let place = arrays.of::<[u32; 2]>(Array::Places)[straddler][side];
            if place != NONE {
                let part = arrays.of::<Part>(Array::Parts)[2 * straddler + side];
                next[(place - first) as usize] = part;
            }
        }
        for index in 0..params.count {
            let name = arrays[Array::Marks][index as usize];
            if name != NONE && (name >> 31) as usize == side {
                let spans = [0, 1, 2].map(|axis| span(arrays, params, index, axis));
                next[((name & !TO_RIGHT) - first) as usize] =
                    Part { lower: spans.map(|span| span[0]), upper: spans.map(|span| span[1]) };
            }
        }
    });
}
