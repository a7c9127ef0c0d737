// On which sides of its node's plane each reference has a part.
//
// Twin: `mark.rs`. One invocation an event of the plane's axis: a node's events lie at the same
// places along every axis, two for each of its references.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> references: References;
@group(0) @binding(2) var<storage> plans: array<Plan>;
@group(0) @binding(3) var<storage> events: array<Event>;
@group(0) @binding(4) var<storage, read_write> marks: array<atomic<u32>>;

@compute @workgroup_size(256)
fn mark(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    if index >= 2u * references.count {
        return;
    }
    let plan = plans[references.list[index / 2u].slot];
    if (plan.what & 3u) == LEAF {
        return;
    }
    let event = events[(plan.what & 3u) * params.events + index];
    let is_left = (event.what & 1u) == 1u;
    if is_left && event.position < plan.position {
        atomicOr(&marks[event.what >> 2u], LEFT);
    } else if !is_left && event.position > plan.position {
        atomicOr(&marks[event.what >> 2u], RIGHT);
    }
}
