//! The events of new parts, by child.

use super::arrays::{Array, Arrays};
use super::bear::{bases, parts_before};
use super::data::{Event, NONE, Pair, Part};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const RENEW: Kernel = Kernel {
    shader: Shader {
        name: "renew",
        source: include_str!("renew.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Write],
    },
    arrays: &[
        Array::NextReferences,
        Array::Pairs,
        Array::Exists,
        Array::Parts,
        Array::Places,
        Array::Fresh,
    ],
    moved: |p| Moved { read: 2 * w(p.straddlers) * 76, written: 2 * w(p.straddlers) * 48 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Fresh, |arrays, fresh: &mut [Event]| {
        for index in 0..2 * params.straddlers {
            let (straddler, side) = (index / 2, index as usize % 2);
            let place = arrays[Array::Places][index as usize];
            if place == NONE {
                continue;
            }
            let child = arrays.references(Array::NextReferences)[place as usize].slot;
            let pair: &Pair = &arrays.of(Array::Pairs)[child as usize / 2];
            let rank = parts_before(arrays, params, straddler)[side]
                - parts_before(arrays, params, pair.start.straddlers)[side];
            let first = 2 * (bases(arrays, params, pair).parts[side] + rank);
            let part: &Part = &arrays.of(Array::Parts)[index as usize];
            for axis in 0..3 {
                let at = (axis * params.fresh_events + first) as usize;
                let bounds = (part.lower[axis as usize], part.upper[axis as usize]);
                fresh[at..at + 2].copy_from_slice(&Event::pair(bounds.0, bounds.1, place));
            }
        }
    });
}
