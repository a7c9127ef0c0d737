//! The references of the next level, and under which name each of this level's goes on.

use super::arrays::{Array, Arrays};
use super::bear::{bases, parts_before};
use super::data::{HEADER, NONE, Pair, Plan, Ranks, TO_RIGHT};
use super::kernel::{Kernel, Params, Worker, chunk, w};
use super::route::{Route, before, ranks, route};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const NAME: Kernel = Kernel {
    shader: Shader {
        name: "name",
        source: include_str!("name.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Write, Write, Write],
    },
    arrays: &[
        Array::References,
        Array::Plans,
        Array::Pairs,
        Array::Exists,
        Array::Sums,
        Array::Marks,
        Array::NextReferences,
        Array::Places,
    ],
    moved: |p| Moved {
        read: w(p.references()) * 12
            + w(p.straddlers) * 8
            + w(p.nodes) * 44
            + w(p.reference_chunks()) * 16,
        written: w(p.references()) * 4
            + (w(p.left) + w(p.right) + 2 * w(p.straddlers)) * 8
            + w(p.straddlers) * 8,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Marks, |arrays, marks: &mut [u32]| {
        arrays.write(Array::NextReferences, |arrays, next: &mut [u32]| {
            arrays.write(Array::Places, |arrays, places: &mut [[u32; 2]]| {
                for index in 0..params.reference_chunks() {
                    walk(arrays, params, index, (marks, next, places));
                }
            });
        });
    });
}

type Outputs<'a> = (&'a mut [u32], &'a mut [u32], &'a mut [[u32; 2]]);

fn walk(arrays: &Arrays, params: &Params, index: u32, (marks, next, places): Outputs) {
    let references = arrays.references(Array::References);
    let mut counts = before(arrays, params, index);
    for place in chunk(index, params.references()) {
        let reference = references[place as usize];
        let plan = &arrays.of::<Plan>(Array::Plans)[reference.slot as usize];
        let way = route(plan, marks[place as usize]);
        marks[place as usize] = NONE;
        if plan.is_inner() {
            let pair = &arrays.of::<Pair>(Array::Pairs)[plan.place as usize];
            let names = names(arrays, params, pair, &ranks(counts));
            let mut put = |side: usize| {
                let at = HEADER + 2 * names[side] as usize;
                let slot = 2 * plan.place + side as u32;
                next[at..at + 2].copy_from_slice(&[reference.triangle, slot]);
                names[side]
            };
            match way {
                Route::Left => marks[place as usize] = put(0),
                Route::Right => marks[place as usize] = put(1) | TO_RIGHT,
                _ => {
                    let straddler = counts[way as usize];
                    let [from, to] =
                        [straddler, straddler + 1].map(|n| parts_before(arrays, params, n));
                    places[straddler as usize] =
                        [0, 1].map(|side| if to[side] > from[side] { put(side) } else { NONE });
                }
            }
        }
        counts[way as usize] += 1;
    }
}

/// The places in both children of the next of a node's references, with `ranks` before it.
fn names(arrays: &Arrays, params: &Params, pair: &Pair, ranks: &Ranks) -> [u32; 2] {
    let bases = bases(arrays, params, pair);
    let [left, right] = parts_before(arrays, params, ranks.straddlers);
    let [left_start, right_start] = parts_before(arrays, params, pair.start.straddlers);
    [
        bases.references[0] + ranks.left - pair.start.left + left - left_start,
        bases.references[1] + ranks.right - pair.start.right + right - right_start,
    ]
}
