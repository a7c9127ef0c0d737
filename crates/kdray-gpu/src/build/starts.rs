//! How many references enter the left side in each chunk of events.
//!
//! The first step of the sweep: after a scan, every chunk knows the counts where it begins
//! \[WZL11].

use super::arrays::{Array, Arrays};
use super::data::Event;
use super::kernel::{Kernel, Params, Worker, chunk, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const STARTS: Kernel = Kernel {
    shader: Shader {
        name: "starts",
        source: include_str!("starts.wgsl"),
        bindings: &[Uniform, Read, Read, Write],
    },
    arrays: &[Array::References, Array::Events, Array::Sums],
    moved: |p| Moved { read: p.axes() * w(p.events) * 8, written: w(p.count) * 4 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Sums, |arrays, sums: &mut [u32]| {
        let count = 2 * arrays[Array::References][0];
        let chunks = params.event_chunks();
        for index in 0..params.count {
            let events =
                &arrays.of::<Event>(Array::Events)[(index / chunks * params.events) as usize..];
            let places = chunk(index % chunks, count);
            sums[index as usize] = places.map(|k| u32::from(events[k as usize].is_left())).sum();
        }
    });
}
