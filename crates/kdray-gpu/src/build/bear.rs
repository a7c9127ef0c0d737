//! The nodes of the next level, and the records of this one.

use kdray::build::position_of;

use super::arrays::{Array, Arrays};
use super::data::{FINISHED, HEADER, LEAF, NONE, Node, Pair, Plan, Ranks, Record};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const BEAR: Kernel = Kernel {
    shader: Shader {
        name: "bear",
        source: include_str!("bear.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Write, Write, Write],
    },
    arrays: &[
        Array::Nodes,
        Array::Plans,
        Array::Pairs,
        Array::Exists,
        Array::NextNodes,
        Array::NextReferences,
        Array::Records,
    ],
    moved: |p| Moved { read: w(p.nodes) * 84, written: w(p.nodes) * 8 + w(p.next_nodes) * 40 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    let parts = arrays[Array::Exists][2 * params.straddlers as usize];
    let header = [params.left + params.right + parts, parts, 0, 0];
    arrays[Array::NextReferences][..HEADER].copy_from_slice(&header);
    arrays.write(Array::NextNodes, |arrays, next: &mut [Node]| {
        arrays.write(Array::Records, |arrays, records: &mut [Record]| {
            for slot in 0..params.nodes as usize {
                let node: &Node = &arrays.of(Array::Nodes)[slot];
                let plan: &Plan = &arrays.of(Array::Plans)[slot];
                records[params.records as usize + slot] = record(node, plan, params);
                if plan.is_inner() {
                    let place = plan.place as usize;
                    let pair = &arrays.of::<Pair>(Array::Pairs)[place];
                    let children = children(node, plan, &bases(arrays, params, pair));
                    next[2 * place..2 * place + 2].copy_from_slice(&children);
                    let header = &mut arrays[Array::NextReferences];
                    for child in children {
                        header[2] = header[2].max(child.count);
                        header[3] = header[3].max(child.fresh_count);
                    }
                }
            }
        });
    });
}

fn record(node: &Node, plan: &Plan, params: &Params) -> Record {
    match plan.what {
        LEAF => return Record { first: plan.place, second: node.count << 2 | LEAF },
        FINISHED => return Record { first: plan.place, second: NONE },
        _ => {}
    }
    let children = params.next_records + 2 * plan.place;
    let first = position_of(plan.position).to_bits();
    Record { first, second: children << 2 | plan.what & 3 }
}

/// Where a node's children have their references, and among the new parts of the level their own:
/// left, right and the end.
pub(crate) struct Bases {
    pub(crate) references: [u32; 3],
    pub(crate) parts: [u32; 3],
}

pub(crate) fn bases(arrays: &Arrays, params: &Params, pair: &Pair) -> Bases {
    let parts_at = |ranks: &Ranks| parts_before(arrays, params, ranks.straddlers);
    let ([left, right], [left_end, right_end]) = (parts_at(&pair.start), parts_at(&pair.end));
    let parts = [left + right, left_end + right, left_end + right_end];
    let kept = [
        pair.start.left + pair.start.right,
        pair.end.left + pair.start.right,
        pair.end.left + pair.end.right,
    ];
    Bases { references: [0, 1, 2].map(|end| kept[end] + parts[end]), parts }
}

/// How many parts on each side the first `straddlers` of the level have.
pub(crate) fn parts_before(arrays: &Arrays, params: &Params, straddlers: u32) -> [u32; 2] {
    let exists = &arrays[Array::Exists];
    let right =
        exists[(params.straddlers + straddlers) as usize] - exists[params.straddlers as usize];
    [exists[straddlers as usize], right]
}

fn children(node: &Node, plan: &Plan, bases: &Bases) -> [Node; 2] {
    let mut children = [0, 1].map(|side| Node {
        first: bases.references[side],
        count: bases.references[side + 1] - bases.references[side],
        fresh_first: bases.parts[side],
        fresh_count: bases.parts[side + 1] - bases.parts[side],
        ..*node
    });
    children[0].upper[plan.axis()] = plan.position;
    children[1].lower[plan.axis()] = plan.position;
    children
}
