// What becomes of a node whose axes are looked at one after the other: a leaf, or a plane.
//
// Twin: `settle.rs`. Until all axes are done, the plan has the inverted price in place of its place.

//#import prices

struct Best {
    price: u32,
    index: u32,
    left_index: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> nodes: array<Node>;
@group(0) @binding(2) var<storage> events: array<Event>;
@group(0) @binding(3) var<storage> best: array<Best>;
@group(0) @binding(4) var<storage, read_write> plans: array<Plan>;
@group(0) @binding(5) var<storage, read_write> inner: array<u32>;

@compute @workgroup_size(256)
fn settle(@builtin(local_invocation_index) local: u32) {
    if local > 0u {
        return;
    }
    let found = best[0];
    var plan = plans[0];
    // Of equals the axis that came first stays.
    if found.price > plan.place {
        plan = Plan(position_at(found.index), params.axis | FLAT_RIGHT, found.price);
        if found.left_index != 0u && position_at(found.left_index) == plan.position {
            plan.what = params.axis;
        }
    }
    if params.axis == 2u {
        let node = nodes[0];
        let lower = vec3u(node.lower[0], node.lower[1], node.lower[2]);
        let upper = vec3u(node.upper[0], node.upper[1], node.upper[2]);
        let prices = prices_of(lower, upper, 0u);
        let is_leaf = plan.place == 0u || !is_open(prices, node.count)
            || ~plan.place >= leaf_price(prices, node.count);
        plan = Plan(select(plan.position, 0u, is_leaf), select(plan.what, LEAF, is_leaf), 0u);
        inner[0] = select(1u, 0u, is_leaf);
    }
    plans[0] = plan;
}

// Where the event at an inverted index is.
fn position_at(index: u32) -> u32 {
    return events[~index & ((1u << AXIS_SHIFT) - 1u)].position;
}
