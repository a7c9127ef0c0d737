//! On which sides of its node's plane each reference has a part, by its bounds.
//!
//! `mark` does the same by events, where there are some.

use super::arrays::{Array, Arrays};
use super::data::Plan;
use super::ends::{SPAN_BYTES, span};
use super::kernel::{Kernel, Params, Worker, w};
use super::mark::{LEFT, RIGHT};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const SIDE: Kernel = Kernel {
    shader: Shader {
        name: "side",
        source: include_str!("side.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Write],
    },
    arrays: &[
        Array::Positions,
        Array::Triangles,
        Array::Bounds,
        Array::References,
        Array::Plans,
        Array::Marks,
    ],
    moved: |p| Moved {
        read: w(p.count) * (SPAN_BYTES + 8) + w(p.nodes) * 12,
        written: w(p.count) * 4,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Marks, |arrays, marks: &mut [u32]| {
        for index in 0..arrays[Array::References][0] {
            let slot = arrays.references(Array::References)[index as usize].slot;
            let plan = &arrays.of::<Plan>(Array::Plans)[slot as usize];
            if plan.is_inner() {
                let [lower, upper] = span(arrays, params, index, plan.axis() as u32);
                let left = if lower < plan.position { LEFT } else { 0 };
                let right = if upper > plan.position { RIGHT } else { 0 };
                marks[index as usize] = left | right;
            }
        }
    });
}
