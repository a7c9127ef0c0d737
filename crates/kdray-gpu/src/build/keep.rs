//! Moves the events whose references keep their bounds: they keep their order, and leave room for
//! the new events that come before them.

use super::arrays::{Array, Arrays};
use super::data::{Event, Node, Pair};
use super::kernel::{Kernel, Params, Worker, chunk, w};
use super::tally::{kept_before, name_of};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const KEEP: Kernel = Kernel {
    shader: Shader {
        name: "keep",
        source: include_str!("keep.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Write],
    },
    arrays: &[
        Array::Events,
        Array::Marks,
        Array::Sums,
        Array::Pairs,
        Array::NextReferences,
        Array::NextNodes,
        Array::Fresh,
        Array::NextEvents,
    ],
    moved: |p| Moved {
        read: 3 * w(p.events) * 12
            + 3 * (w(p.left) + w(p.right)) * 2 * 8
            + 3 * w(p.next_nodes) * 72,
        written: 3 * (w(p.left) + w(p.right)) * 16,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::NextEvents, |arrays, next: &mut [Event]| {
        let chunks = params.event_chunks();
        for index in 0..3 * chunks {
            let axis = index / chunks;
            let places = chunk(index % chunks, 2 * params.references());
            let mut ranks = kept_before(arrays, params, axis, places.start);
            for place in places {
                let event =
                    arrays.of::<Event>(Array::Events)[(axis * params.events + place) as usize];
                let Some((side, name)) = name_of(arrays, &event) else { continue };
                let child = arrays.references(Array::NextReferences)[name as usize].slot as usize;
                let node = &arrays.of::<Node>(Array::NextNodes)[child];
                let before = fresh(arrays, params, axis, node)
                    .partition_point(|new| new.order() < event.order());
                let rank = ranks[side] - kept_of_parents(arrays, child);
                let at = axis * params.next_events + 2 * node.first + rank + before as u32;
                next[at as usize] = Event { what: name << 2 | event.kind(), ..event };
                ranks[side] += 1;
            }
        }
    });
}

/// The sorted new events of a node of the next level.
fn fresh<'a>(arrays: &'a Arrays, params: &Params, axis: u32, node: &Node) -> &'a [Event] {
    let first = (axis * params.fresh_events + 2 * node.fresh_first) as usize;
    &arrays.of(Array::Fresh)[first..first + 2 * node.fresh_count as usize]
}

/// How many events that keep their order go to children of this side before a child's parent.
pub(crate) fn kept_of_parents(arrays: &Arrays, child: usize) -> u32 {
    let start = arrays.of::<Pair>(Array::Pairs)[child / 2].start;
    2 * if child.is_multiple_of(2) { start.left } else { start.right }
}
