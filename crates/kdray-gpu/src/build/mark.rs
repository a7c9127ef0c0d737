//! On which sides of its node's plane each reference has a part.

use super::arrays::{Array, Arrays};
use super::data::{Event, Plan};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const MARK: Kernel = Kernel {
    shader: Shader {
        name: "mark",
        source: include_str!("mark.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write],
    },
    arrays: &[Array::References, Array::Plans, Array::Events, Array::Marks],
    moved: |p| Moved { read: w(p.events) * 16 + w(p.nodes) * 12, written: w(p.events) * 4 },
    by: Worker::Invocation,
    twin,
};

/// Bits of a mark.
pub(crate) const LEFT: u32 = 1;
pub(crate) const RIGHT: u32 = 2;

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Marks, |arrays, marks: &mut [u32]| {
        let references = arrays.references(Array::References);
        let plans: &[Plan] = arrays.of(Array::Plans);
        let events: &[Event] = arrays.of(Array::Events);
        for k in 0..2 * arrays[Array::References][0] as usize {
            let plan = plans[references[k / 2].slot as usize];
            if !plan.is_inner() {
                continue;
            }
            let event = events[plan.axis() * params.events as usize + k];
            if event.is_left() && event.position < plan.position {
                marks[event.place()] |= LEFT;
            } else if !event.is_left() && event.position > plan.position {
                marks[event.place()] |= RIGHT;
            }
        }
    });
}
