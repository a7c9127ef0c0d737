//! Puts the sorted new events of each child among those that kept their order.
//!
//! Each finds its interval among the events of the parent, and from there its place.

use super::arrays::{Array, Arrays};
use super::data::{Event, Node, Pair};
use super::keep::kept_of_parents;
use super::kernel::{CHUNK, Kernel, Params, Worker, w};
use super::tally::kept_before;
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const PLACE: Kernel = Kernel {
    shader: Shader {
        name: "place",
        source: include_str!("place.wgsl"),
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
        read: 3
            * w(p.fresh_events)
            * (88 + 8 * w(p.events.max(2).ilog2()) + u64::from(CHUNK / 2) * 12),
        written: 3 * w(p.fresh_events) * 8,
    },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::NextEvents, |arrays, next: &mut [Event]| {
        let events: &[Event] = arrays.of(Array::Events);
        for axis in 0..3 {
            for rank in 0..2 * arrays[Array::NextReferences][1] {
                let event =
                    arrays.of::<Event>(Array::Fresh)[(axis * params.fresh_events + rank) as usize];
                let child = arrays.references(Array::NextReferences)[event.place()].slot as usize;
                let node = &arrays.of::<Node>(Array::NextNodes)[child];
                let pair = &arrays.of::<Pair>(Array::Pairs)[child / 2];
                let first = axis * params.events + 2 * pair.first;
                let parents = &events[first as usize..(first + 2 * pair.count) as usize];
                let interval = parents.partition_point(|old| old.order() <= event.order()) as u32;
                let kept = kept_before(arrays, params, axis, 2 * pair.first + interval)[child % 2]
                    - kept_of_parents(arrays, child);
                let at =
                    axis * params.next_events + 2 * node.first + kept + rank - 2 * node.fresh_first;
                next[at as usize] = event;
            }
        }
    });
}
