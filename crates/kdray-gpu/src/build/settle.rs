//! What becomes of a node whose axes are looked at one after the other: a leaf, or a plane.

use super::arrays::{Array, Arrays};
use super::data::{AXIS_SHIFT, Best, Event, FLAT_RIGHT, LEAF, Node, Plan};
use super::kernel::{Kernel, Params, Worker};
use super::pricing::{is_open, node_cost};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const SETTLE: Kernel = Kernel {
    shader: Shader {
        name: "settle",
        source: include_str!("settle.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write, Write],
    },
    arrays: &[Array::Nodes, Array::Events, Array::Best, Array::Plans, Array::Inner],
    moved: |_| Moved { read: 80, written: 16 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    let best = arrays.of::<Best>(Array::Best)[0];
    let mut plan = arrays.of::<Plan>(Array::Plans)[0];
    let position = |index: u32| {
        let place = !index & ((1 << AXIS_SHIFT) - 1);
        arrays.of::<Event>(Array::Events)[place as usize].position
    };
    // Until all axes are done, the plan has the inverted price in place of its place.
    if best.price > plan.place {
        plan.position = position(best.index);
        let is_left = best.left_index != 0 && position(best.left_index) == plan.position;
        plan.what = if is_left { params.axis } else { params.axis | FLAT_RIGHT };
        plan.place = best.price;
    }
    if params.axis == 2 {
        let node = &arrays.of::<Node>(Array::Nodes)[0];
        let cost = node_cost(node, params);
        let leaf_price = cost.leaf(node.count as usize).to_bits();
        let is_worth = plan.place != 0 && !plan.place < leaf_price;
        plan = match is_worth && is_open(node, params, &cost) {
            true => Plan { place: 0, ..plan },
            false => Plan { position: 0, what: LEAF, place: 0 },
        };
        arrays[Array::Inner][0] = u32::from(plan.is_inner());
    }
    arrays.write(Array::Plans, |_, plans: &mut [Plan]| plans[0] = plan);
}
