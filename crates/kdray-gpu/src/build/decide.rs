//! What becomes of each node: a leaf, or a plane.

use super::arrays::{Array, Arrays};
use super::data::{AXIS_SHIFT, Best, Event, FINISHED, FLAT_RIGHT, LEAF, NONE, Node, Plan};
use super::kernel::{Kernel, Params, Worker, w};
use super::pricing::{is_open, node_cost};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const DECIDE: Kernel = Kernel {
    shader: Shader {
        name: "decide",
        source: include_str!("decide.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write, Write],
    },
    arrays: &[Array::Nodes, Array::Events, Array::Best, Array::Plans, Array::Inner],
    moved: |p| Moved { read: w(p.nodes) * 72, written: w(p.nodes) * 16 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Plans, |arrays, plans: &mut [Plan]| {
        arrays.write(Array::Inner, |arrays, inner: &mut [u32]| {
            for slot in 0..params.nodes as usize {
                let words = &mut inner[params.nodes as usize + slot];
                plans[slot] = match std::mem::take(words) {
                    0 => plan(arrays, params, slot),
                    NONE => Plan { position: 0, what: LEAF, place: 0 },
                    piece => {
                        *words = piece;
                        Plan { position: 0, what: FINISHED, place: 0 }
                    }
                };
                inner[slot] = u32::from(plans[slot].is_inner());
            }
            inner[2 * params.nodes as usize] = 0;
        });
    });
}

fn plan(arrays: &Arrays, params: &Params, slot: usize) -> Plan {
    let leaf = Plan { position: 0, what: LEAF, place: 0 };
    let node = &arrays.of::<Node>(Array::Nodes)[slot];
    let best = &arrays.of::<Best>(Array::Best)[slot];
    let cost = node_cost(node, params);
    let leaf_price = cost.leaf(node.count as usize).to_bits();
    if best.price == 0 || !is_open(node, params, &cost) || !best.price >= leaf_price {
        return leaf;
    }
    let events: &[Event] = arrays.of(Array::Events);
    let plane = |index: u32| {
        let axis = index >> AXIS_SHIFT;
        let place = index & ((1 << AXIS_SHIFT) - 1);
        (axis, events[(axis * params.events + place) as usize].position)
    };
    let (axis, position) = plane(!best.index);
    let is_left = best.left_index != 0 && plane(!best.left_index) == (axis, position);
    let what = if is_left { axis } else { axis | FLAT_RIGHT };
    Plan { position, what, place: 0 }
}
