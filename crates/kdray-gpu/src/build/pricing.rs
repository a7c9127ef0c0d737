//! What the planes at events cost.
//!
//! At event `k` of a node with `N` references, with `left` references that entered the left side
//! before it, a plane has
//!
//! ```text
//! N_left = left        N_right = N - (k - left) - (1 if the event takes one from the right)
//! ```
//!
//! references on its sides \[WZL11]. The last end, the first to enter, the last to leave and the
//! first start at a position give the counts of the plane with flat references on the right
//! (ends and those that enter) or on the left (the others). All other events at the position count
//! too many, never too few, and prices grow with the counts: so every event may be priced as if
//! it were alone, and the cheapest is the cheapest plane.

use kdray::Cost;
use kdray::build::{NodeCost, position_of};

use super::arrays::{Array, Arrays};
use super::data::{Event, Node};
use super::kernel::{Params, chunk};

/// An event and what its plane costs; without one if it is no candidate.
pub(crate) struct Priced {
    pub(crate) slot: usize,
    /// Among those of all axes.
    pub(crate) chunk: u32,
    pub(crate) axis: u32,
    /// Among the events of the axis.
    pub(crate) place: u32,
    pub(crate) event: Event,
    pub(crate) price: Option<u32>,
}

/// Calls `work` with every event of the level. The counts before chunks are scanned.
pub(crate) fn walk(arrays: &Arrays, params: &Params, mut work: impl FnMut(&Priced)) {
    let references = arrays.references(Array::References);
    let nodes: &[Node] = arrays.of(Array::Nodes);
    let pieces = &arrays[Array::Inner][params.nodes as usize..];
    let events: &[Event] = arrays.of(Array::Events);
    let count = arrays[Array::References][0];
    let chunks = params.event_chunks();
    for index in 0..params.count {
        let lane = index / chunks;
        let axis = params.base_axis + lane;
        let mut left = arrays[Array::Sums][index as usize] - lane * count;
        for place in chunk(index % chunks, 2 * count) {
            let event = events[(lane * params.events + place) as usize];
            let slot = references[place as usize / 2].slot as usize;
            let price = (pieces[slot] == 0)
                .then(|| price(&nodes[slot], params, axis as usize, [place, left], event))
                .flatten();
            work(&Priced { slot, chunk: index, axis, place, event, price });
            left += u32::from(event.is_left());
        }
    }
}

/// The bits of the price of the plane at an event, which is at `place` among those of its axis
/// with `left` before it that enter the left side.
fn price(
    node: &Node,
    params: &Params,
    axis: usize,
    [place, left]: [u32; 2],
    event: Event,
) -> Option<u32> {
    let cost = node_cost(node, params);
    if !is_open(node, params, &cost)
        || event.position <= node.lower[axis]
        || event.position >= node.upper[axis]
    {
        return None;
    }
    let [lower, position, upper] =
        [node.lower[axis], event.position, node.upper[axis]].map(position_of);
    let left = left - node.first;
    let passed = place - 2 * node.first - left;
    let right = node.count - passed - u32::from(!event.is_left());
    let price =
        cost.split(axis, [position - lower, upper - position], [left, right].map(|n| n as i32));
    Some(price.to_bits())
}

/// The prices of a node's planes.
pub(crate) fn node_cost(node: &Node, params: &Params) -> NodeCost {
    let cost = Cost { traversal: params.traversal, intersect: params.intersect, empty_bonus: 0.0 };
    let mut prices = NodeCost::new(&cost, &node.bounds());
    prices.empty_factor = params.empty_factor;
    prices
}

/// Whether the node's planes are looked at.
pub(crate) fn is_open(node: &Node, params: &Params, cost: &NodeCost) -> bool {
    params.may_split == 1
        && node.count > params.max_leaf
        && !cost.is_surely_leaf(node.count as usize)
}
