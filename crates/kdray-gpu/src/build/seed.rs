//! The references of the root, which are all triangles.

use super::arrays::{Array, Arrays};
use super::data::HEADER;
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const SEED: Kernel = Kernel {
    shader: Shader { name: "seed", source: include_str!("seed.wgsl"), bindings: &[Uniform, Write] },
    arrays: &[Array::References],
    moved: |p| Moved { read: 0, written: w(p.triangles) * 8 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    let references = &mut arrays[Array::References];
    references[..HEADER].fill(params.triangles);
    for triangle in 0..params.triangles {
        references[HEADER + 2 * triangle as usize..][..2].copy_from_slice(&[triangle, 0]);
    }
}
