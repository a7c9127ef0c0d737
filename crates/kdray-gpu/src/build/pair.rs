//! The place of each inner node's children among those of the level.

use super::arrays::{Array, Arrays};
use super::data::{Node, Pair, Plan};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const PAIR: Kernel = Kernel {
    shader: Shader {
        name: "pair",
        source: include_str!("pair.wgsl"),
        bindings: &[Uniform, Read, Read, Write, Write],
    },
    arrays: &[Array::Nodes, Array::Inner, Array::Plans, Array::Pairs],
    moved: |p| Moved { read: w(p.nodes) * 24, written: w(p.nodes) * 12 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Plans, |arrays, plans: &mut [Plan]| {
        arrays.write(Array::Pairs, |arrays, pairs: &mut [Pair]| {
            let nodes: &[Node] = arrays.of(Array::Nodes);
            for slot in 0..params.nodes as usize {
                if plans[slot].is_inner() {
                    let place = arrays[Array::Inner][slot];
                    plans[slot].place = place;
                    let pair = &mut pairs[place as usize];
                    (pair.first, pair.count) = (nodes[slot].first, nodes[slot].count);
                }
            }
        });
    });
}
