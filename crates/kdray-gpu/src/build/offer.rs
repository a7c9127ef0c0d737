//! The cheapest plane of a node, by counting for every plane the parts on its sides.
//!
//! That is the definition itself, and for few parts it is quicker than lists of events.

use super::data::FLAT_RIGHT;
use super::kernel::Params;
use super::pricing::{is_open, node_cost};
use super::subtree::{Member, Task};
use kdray::build::position_of;

/// Axis, side of the flat parts and position of a node's plane; none if it is a leaf.
pub(crate) fn choice(
    params: &Params,
    task: &Task,
    members: &[Member],
) -> Option<(usize, u32, u32)> {
    let node = &task.node;
    let cost = node_cost(node, params);
    if task.depth == 0 || !is_open(node, params, &cost) {
        return None;
    }
    let mut best: Option<(u32, usize, u32, u32)> = None;
    for axis in 0..3 {
        let inside = node.lower[axis] + 1..node.upper[axis];
        let planes = members.iter().flat_map(|member| [member.lower[axis], member.upper[axis]]);
        for plane in planes.filter(|plane| inside.contains(plane)) {
            let [lower, position, upper] =
                [node.lower[axis], plane, node.upper[axis]].map(position_of);
            let price = |counts: [usize; 2]| {
                let distances = [position - lower, upper - position];
                cost.split(axis, distances, counts.map(|count| count as i32)).to_bits()
            };
            let left = members.iter().filter(|member| member.lower[axis] < plane).count();
            let right = members.iter().filter(|member| member.upper[axis] > plane).count();
            let is_flat =
                |member: &&Member| member.lower[axis] == plane && member.upper[axis] == plane;
            let flat_ones = members.iter().filter(is_flat).count();
            let prices = [price([left + flat_ones, right]), price([left, right + flat_ones])];
            let what = if prices[1] < prices[0] { FLAT_RIGHT } else { 0 };
            let offer = (prices[0].min(prices[1]), axis, plane, what);
            best = Some(best.map_or(offer, |best| best.min(offer)));
        }
    }
    let leaf_price = cost.leaf(node.count as usize).to_bits();
    best.filter(|best| best.0 < leaf_price).map(|(_, axis, plane, what)| (axis, what, plane))
}
