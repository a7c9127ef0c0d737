//! How many references of each chunk go which way.

use super::arrays::{Array, Arrays};
use super::data::Plan;
use super::kernel::{Kernel, Params, Worker, chunk, w};
use super::route::{ROUTES, route};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const ASSIGN: Kernel = Kernel {
    shader: Shader {
        name: "assign",
        source: include_str!("assign.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write],
    },
    arrays: &[Array::References, Array::Plans, Array::Marks, Array::Sums],
    moved: |p| Moved {
        read: w(p.events) / 2 * 12 + w(p.nodes) * 12,
        written: w(p.reference_chunks()) * 16,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Sums, |arrays, sums: &mut [u32]| {
        let references = arrays.references(Array::References);
        let plans: &[Plan] = arrays.of(Array::Plans);
        let chunks = params.reference_chunks();
        for index in 0..chunks {
            let mut counts = [0; ROUTES as usize];
            for place in chunk(index, arrays[Array::References][0]) {
                let plan = &plans[references[place as usize].slot as usize];
                counts[route(plan, arrays[Array::Marks][place as usize]) as usize] += 1;
            }
            for way in 0..ROUTES {
                sums[(way * chunks + index) as usize] = counts[way as usize];
            }
        }
        sums[(ROUTES * chunks) as usize] = 0;
    });
}
