// What becomes of each node: a leaf, or a plane.
//
// Twin: `decide.rs`.

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
fn decide(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    if index == params.nodes {
        inner[2u * index] = 0u;
        return;
    }
    let words = inner[params.nodes + index];
    var plan = Plan(0u, LEAF, 0u);
    if words == NONE {
        inner[params.nodes + index] = 0u;
    } else if words != 0u {
        plan.what = FINISHED;
    } else {
        plan = plan_of(index);
    }
    plans[index] = plan;
    inner[index] = u32((plan.what & 3u) != LEAF);
}

fn plan_of(slot: u32) -> Plan {
    let lower = nodes[slot].lower;
    let upper = nodes[slot].upper;
    let count = nodes[slot].count;
    let corner = vec3u(lower[0], lower[1], lower[2]);
    let prices = prices_of(corner, vec3u(upper[0], upper[1], upper[2]), 0u);
    let found = best[slot];
    if found.price == 0u || !is_open(prices, count) || ~found.price >= leaf_price(prices, count) {
        return Plan(0u, LEAF, 0u);
    }
    let plane = plane_at(~found.index);
    var what = plane.x | FLAT_RIGHT;
    if found.left_index != 0u && all(plane_at(~found.left_index) == plane) {
        what = plane.x;
    }
    return Plan(plane.y, what, 0u);
}

// Axis and position of the event at an index.
fn plane_at(index: u32) -> vec2u {
    let axis = index >> AXIS_SHIFT;
    let place = index & ((1u << AXIS_SHIFT) - 1u);
    return vec2u(axis, events[axis * params.events + place].position);
}
