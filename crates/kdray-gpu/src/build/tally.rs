//! How many events of each chunk keep their order in the left and in the right child.

use super::arrays::{Array, Arrays};
use super::data::{Event, NONE, TO_RIGHT};
use super::kernel::{Kernel, Params, Worker, chunk, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const TALLY: Kernel = Kernel {
    shader: Shader {
        name: "tally",
        source: include_str!("tally.wgsl"),
        bindings: &[Uniform, Read, Read, Write],
    },
    arrays: &[Array::Events, Array::Marks, Array::Sums],
    moved: |p| Moved { read: 3 * w(p.events) * 12, written: 6 * w(p.event_chunks()) * 4 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Sums, |arrays, sums: &mut [u32]| {
        let chunks = params.event_chunks();
        for index in 0..3 * chunks {
            let axis = index / chunks;
            let places = chunk(index % chunks, 2 * params.references());
            let counts = kept(arrays, params, axis, places);
            for side in 0..2 {
                sums[((2 * axis + side) * chunks + index % chunks) as usize] =
                    counts[side as usize];
            }
        }
    });
}

/// How many of the events at `places` of an axis go left and right with their bounds.
fn kept(arrays: &Arrays, params: &Params, axis: u32, places: std::ops::Range<u32>) -> [u32; 2] {
    let mut counts = [0; 2];
    for place in places {
        let event: &Event = &arrays.of(Array::Events)[(axis * params.events + place) as usize];
        if let Some((side, _)) = name_of(arrays, event) {
            counts[side] += 1;
        }
    }
    counts
}

/// The child and the place there of an event's reference, if it keeps its bounds.
pub(crate) fn name_of(arrays: &Arrays, event: &Event) -> Option<(usize, u32)> {
    let name = arrays[Array::Marks][event.place()];
    (name != NONE).then_some((usize::from(name & TO_RIGHT != 0), name & !TO_RIGHT))
}

/// How many events before `place` on an axis keep their order in each child; the counts are
/// scanned.
pub(crate) fn kept_before(arrays: &Arrays, params: &Params, axis: u32, place: u32) -> [u32; 2] {
    let chunks = params.event_chunks();
    let index = (place / super::kernel::CHUNK).min(chunks - 1);
    let here = kept(arrays, params, axis, index * super::kernel::CHUNK..place);
    [0, 1].map(|side| {
        let at = |index: u32| arrays[Array::Sums][((2 * axis + side) * chunks + index) as usize];
        at(index) - at(0) + here[side as usize]
    })
}
