//! Events along an axis, from their sorted positions and what these stand for.

use super::arrays::{Array, Arrays};
use super::data::Event;
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const JOIN: Kernel = Kernel {
    shader: Shader {
        name: "join",
        source: include_str!("join.wgsl"),
        bindings: &[Uniform, Read, Read, Write],
    },
    arrays: &[Array::Keys, Array::Values, Array::Events],
    moved: |p| Moved { read: w(p.count) * 8, written: w(p.count) * 8 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Events, |arrays, events: &mut [Event]| {
        let pairs = arrays[Array::Keys].iter().zip(&arrays[Array::Values]);
        let events = &mut events[((params.axis - params.base_axis) * params.events) as usize..];
        for (event, (&position, &what)) in events.iter_mut().zip(pairs).take(params.count as usize)
        {
            *event = Event { position, what };
        }
    });
}
