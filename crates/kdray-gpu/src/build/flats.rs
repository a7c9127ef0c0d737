//! Which references of a node are flat along an axis: their events are of other kinds.

use super::arrays::{Array, Arrays};
use super::ends::{SPAN_BYTES, span};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const FLATS: Kernel = Kernel {
    shader: Shader {
        name: "flats",
        source: include_str!("flats.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Write],
    },
    arrays: &[Array::Positions, Array::Triangles, Array::Bounds, Array::References, Array::Sums],
    moved: |p| Moved { read: w(p.count) * SPAN_BYTES, written: w(p.count) * 4 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Sums, |arrays, sums: &mut [u32]| {
        sums[..params.count as usize].fill(0);
        for reference in 0..arrays[Array::References][0] {
            let [lower, upper] = span(arrays, params, reference, params.axis);
            sums[reference as usize] = u32::from(lower == upper);
        }
    });
}
