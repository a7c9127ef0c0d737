//! The lowest price of each node's planes, and of each chunk's.

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
        bindings: &[Uniform, Read, Read, Read, Read, Read, Write, Write],
    },
    arrays: &[
        Array::References,
        Array::Nodes,
        Array::Events,
        Array::Sums,
        Array::Inner,
        Array::Best,
        Array::Lows,
    ],
    moved: |p| Moved {
        read: p.axes() * (w(p.events) * 12 + w(p.nodes) * 36),
        written: p.axes() * w(p.nodes) * 4 + w(p.count) * 4,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Best, |arrays, best: &mut [Best]| {
        arrays.write(Array::Lows, |arrays, lows: &mut [u32]| {
            lows[..params.count as usize].fill(0);
            walk(arrays, params, |priced| {
                if let Some(price) = priced.price {
                    let best = &mut best[priced.slot].price;
                    *best = (*best).max(!price);
                    let low = &mut lows[priced.chunk as usize];
                    *low = (*low).max(!price);
                }
            });
        });
    });
}
