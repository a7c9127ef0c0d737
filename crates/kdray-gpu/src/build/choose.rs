//! The first plane with the lowest price: of equals the lowest axis, then the lowest position.

use super::arrays::{Array, Arrays};
use super::data::{AXIS_SHIFT, Best, kind};
use super::kernel::{Kernel, Params, Worker, w};
use super::pricing::walk;
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const CHOOSE: Kernel = Kernel {
    shader: Shader {
        name: "choose",
        source: include_str!("choose.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Write],
    },
    arrays: &[
        Array::References,
        Array::Nodes,
        Array::Events,
        Array::Sums,
        Array::Inner,
        Array::Lows,
        Array::Best,
    ],
    moved: |p| Moved {
        read: p.axes() * (w(p.events) * 12 + w(p.nodes) * 48) + w(p.count) * 4,
        written: p.axes() * w(p.nodes) * 8,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Best, |arrays, best: &mut [Best]| {
        walk(arrays, params, |priced| {
            let best = &mut best[priced.slot];
            if priced.price.is_some_and(|price| !price == best.price) {
                let index = !(priced.axis << AXIS_SHIFT | priced.place);
                best.index = best.index.max(index);
                if priced.event.kind() >= kind::LEAVE {
                    best.left_index = best.left_index.max(index);
                }
            }
        });
    });
}
