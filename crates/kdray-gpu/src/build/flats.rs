//! Which triangles are flat along an axis: their events are of other kinds.

use super::arrays::{Array, Arrays};
use super::kernel::{Kernel, Params, Worker, w};
use super::root::span;
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const FLATS: Kernel = Kernel {
    shader: Shader {
        name: "flats",
        source: include_str!("flats.wgsl"),
        bindings: &[Uniform, Read, Read, Write],
    },
    arrays: &[Array::Positions, Array::Triangles, Array::Sums],
    moved: |p| Moved { read: w(p.triangles) * 24, written: w(p.count) * 4 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Sums, |arrays, sums: &mut [u32]| {
        for triangle in 0..params.triangles {
            let [lower, upper] = span(arrays, triangle, params.axis);
            sums[triangle as usize] = u32::from(lower == upper);
        }
        sums[params.triangles as usize] = 0;
    });
}
