//! A range of the level's nodes as a level of its own.
//!
//! What a build does when its memory is short: it finishes one half of the nodes before it goes on
//! with the other \[Hou11].

use super::arrays::{Array, Arrays};
use super::data::{Event, HEADER, MOST, Node};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const PART: Kernel = Kernel {
    shader: Shader {
        name: "part",
        source: include_str!("part.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write, Write, Write],
    },
    arrays: &[
        Array::References,
        Array::Events,
        Array::Nodes,
        Array::NextReferences,
        Array::NextEvents,
        Array::NextNodes,
    ],
    moved: |p| Moved {
        read: w(p.count) * (8 + 48 * w(1 - p.has_bounds)) + w(p.nodes) * 40,
        written: w(p.count) * (8 + 48 * w(1 - p.has_bounds)) + w(p.nodes) * 40,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    let own = params.first_node as usize..(params.first_node + params.nodes) as usize;
    let nodes = &arrays.of::<Node>(Array::Nodes)[own];
    let first = nodes[0].first;
    let count = nodes.iter().map(|node| node.count).sum::<u32>();
    let axes = if params.has_bounds == 1 { 0..0 } else { 0..3 };
    arrays.write(Array::NextReferences, |arrays, next: &mut [u32]| {
        let [most, most_parts] = MOST.map(|at| arrays[Array::References][at as usize]);
        next[..HEADER].copy_from_slice(&[count, 0, most, most_parts]);
        for place in 0..count as usize {
            let reference = arrays.references(Array::References)[first as usize + place];
            let moved = [reference.triangle, reference.slot - params.first_node];
            next[HEADER + 2 * place..HEADER + 2 * place + 2].copy_from_slice(&moved);
        }
    });
    arrays.write(Array::NextEvents, |arrays, next: &mut [Event]| {
        for axis in axes {
            for place in 0..2 * count {
                let from = axis * params.events + 2 * first + place;
                let event = arrays.of::<Event>(Array::Events)[from as usize];
                next[(axis * params.next_events + place) as usize] =
                    Event { what: event.what - (first << 2), ..event };
            }
        }
    });
    arrays.write(Array::NextNodes, |arrays, next: &mut [Node]| {
        for slot in 0..params.nodes as usize {
            let node = arrays.of::<Node>(Array::Nodes)[params.first_node as usize + slot];
            next[slot] = Node { first: node.first - first, ..node };
        }
    });
}
