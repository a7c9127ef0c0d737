// The bounds of straddlers' parts on both sides.
//
// Twin: `clip.rs`.

//#import triangle

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> positions: array<u32>;
@group(0) @binding(2) var<storage> triangles: array<u32>;
@group(0) @binding(3) var<storage> references: References;
@group(0) @binding(4) var<storage> nodes: array<Node>;
@group(0) @binding(5) var<storage> plans: array<Plan>;
@group(0) @binding(6) var<storage> straddlers: array<u32>;
@group(0) @binding(7) var<storage, read_write> parts: array<Part>;
@group(0) @binding(8) var<storage, read_write> exists: array<u32>;

@compute @workgroup_size(256)
fn clip(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    if index == params.straddlers {
        exists[2u * index] = 0u;
        return;
    }
    let reference = references.list[straddlers[index]];
    let lower = nodes[reference.slot].lower;
    let upper = nodes[reference.slot].upper;
    let plan = plans[reference.slot];
    for (var side = 0u; side < 2u; side++) {
        var child = Box(vec3u(lower[0], lower[1], lower[2]), vec3u(upper[0], upper[1], upper[2]));
        if side == 0u {
            child.upper[plan.what & 3u] = plan.position;
        } else {
            child.lower[plan.what & 3u] = plan.position;
        }
        load(reference.triangle);
        put(index, side, part_inside(child, params.clip == 1u));
    }
}

fn put(straddler: u32, side: u32, part: Box) {
    for (var axis = 0u; axis < 3u; axis++) {
        parts[2u * straddler + side].lower[axis] = part.lower[axis];
        parts[2u * straddler + side].upper[axis] = part.upper[axis];
    }
    exists[side * params.straddlers + straddler] = u32(part.lower.x != NONE);
}
