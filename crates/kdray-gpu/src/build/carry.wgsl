// The bounds of the references of one child.
//
// Twin: `carry.rs`. One invocation a reference that keeps its bounds, and a straddler.

//#import span

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> positions: array<u32>;
@group(0) @binding(2) var<storage> triangles: array<u32>;
@group(0) @binding(3) var<storage> bounds: array<Part>;
@group(0) @binding(4) var<storage> marks: array<u32>;
@group(0) @binding(5) var<storage> parts: array<Part>;
@group(0) @binding(6) var<storage> places: array<vec2u>;
@group(0) @binding(7) var<storage> next_nodes: array<Node>;
@group(0) @binding(8) var<storage, read_write> next_bounds: array<Part>;

@compute @workgroup_size(256)
fn carry(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    let side = params.first_node;
    let first = next_nodes[side].first;
    if index < params.straddlers {
        let place = places[index][side];
        if place != NONE {
            next_bounds[place - first] = parts[2u * index + side];
        }
    }
    if index >= params.count {
        return;
    }
    let name = marks[index];
    if name == NONE || name >> 31u != side {
        return;
    }
    let place = (name & ~TO_RIGHT) - first;
    for (var axis = 0u; axis < 3u; axis++) {
        let span = span(index, axis);
        next_bounds[place].lower[axis] = span.x;
        next_bounds[place].upper[axis] = span.y;
    }
}
