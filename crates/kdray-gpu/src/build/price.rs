//! The lowest price of each node's planes.

use super::arrays::{Array, Arrays};
use super::data::Best;
use super::kernel::{Kernel, Params, Worker, w};
use super::pricing::walk;
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const PRICE: Kernel = Kernel {
    shader: Shader {
        name: "price",
        source: include_str!("price.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Write],
    },
    arrays: &[
        Array::References,
        Array::Nodes,
        Array::Events,
        Array::Sums,
        Array::Inner,
        Array::Best,
    ],
    moved: |p| Moved {
        read: 3 * w(p.events) * 12 + 3 * w(p.nodes) * 36,
        written: 3 * w(p.nodes) * 4,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Best, |arrays, best: &mut [Best]| {
        walk(arrays, params, |priced| {
            if let Some(price) = priced.price {
                let best = &mut best[priced.slot].price;
                *best = (*best).max(!price);
            }
        });
    });
}
