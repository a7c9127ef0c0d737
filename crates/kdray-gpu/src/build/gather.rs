//! The straddlers in one list, the references of leaves in another, and the counts where inner
//! nodes start and end.

use super::arrays::{Array, Arrays};
use super::data::{Node, Pair, Plan};
use super::kernel::{Kernel, Params, Worker, chunk, w};
use super::route::{Route, before, ranks, route};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const GATHER: Kernel = Kernel {
    shader: Shader {
        name: "gather",
        source: include_str!("gather.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Write, Write, Write, Write],
    },
    arrays: &[
        Array::References,
        Array::Nodes,
        Array::Marks,
        Array::Sums,
        Array::Plans,
        Array::Pairs,
        Array::Straddlers,
        Array::Finished,
    ],
    moved: |p| Moved {
        read: w(p.references()) * 12 + w(p.nodes) * 20 + w(p.reference_chunks()) * 16,
        written: (w(p.straddlers) + w(p.leaf)) * 4 + w(p.nodes) * 28,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Plans, |arrays, plans: &mut [Plan]| {
        arrays.write(Array::Pairs, |arrays, pairs: &mut [Pair]| {
            arrays.write(Array::Straddlers, |arrays, straddlers: &mut [u32]| {
                arrays.write(Array::Finished, |arrays, leaves: &mut [u32]| {
                    for index in 0..params.reference_chunks() {
                        walk(arrays, params, index, (plans, pairs, straddlers, leaves));
                    }
                });
            });
        });
    });
}

type Outputs<'a> = (&'a mut [Plan], &'a mut [Pair], &'a mut [u32], &'a mut [u32]);

fn walk(arrays: &Arrays, params: &Params, index: u32, (plans, pairs, straddlers, leaves): Outputs) {
    let references = arrays.references(Array::References);
    let mut counts = before(arrays, params, index);
    for place in chunk(index, params.references()) {
        let reference = references[place as usize];
        let slot = reference.slot as usize;
        let node = &arrays.of::<Node>(Array::Nodes)[slot];
        let way = route(&plans[slot], arrays[Array::Marks][place as usize]);
        let leaf_place = params.finished + counts[Route::Leaf as usize];
        if place == node.first {
            match way {
                Route::Leaf => plans[slot].place = leaf_place,
                Route::Finished => {}
                _ => pairs[plans[slot].place as usize].start = ranks(counts),
            }
        }
        match way {
            Route::Both => straddlers[counts[way as usize] as usize] = place,
            Route::Leaf => leaves[leaf_place as usize] = reference.triangle,
            Route::Left | Route::Right | Route::Finished => {}
        }
        counts[way as usize] += 1;
        if place == node.first + node.count - 1 && plans[slot].is_inner() {
            pairs[plans[slot].place as usize].end = ranks(counts);
        }
    }
}
