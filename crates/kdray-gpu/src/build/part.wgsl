// A range of the level's nodes as a level of its own.
//
// Twin: `part.rs`. One invocation a reference and its events, and a node. Narrow levels have no
// events.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> references: References;
@group(0) @binding(2) var<storage> events: array<Event>;
@group(0) @binding(3) var<storage> nodes: array<Node>;
@group(0) @binding(4) var<storage, read_write> next_references: References;
@group(0) @binding(5) var<storage, read_write> next_events: array<Event>;
@group(0) @binding(6) var<storage, read_write> next_nodes: array<Node>;

@compute @workgroup_size(256)
fn part(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    let last = params.first_node + params.nodes - 1u;
    let first = nodes[params.first_node].first;
    let count = nodes[last].first + nodes[last].count - first;
    if index == 0u {
        next_references.count = count;
        next_references.parts = 0u;
        next_references.most = references.most;
        next_references.most_parts = references.most_parts;
    }
    if index < params.nodes {
        next_nodes[index] = nodes[params.first_node + index];
        next_nodes[index].first -= first;
    }
    if index >= count {
        return;
    }
    let reference = references.list[first + index];
    next_references.list[index] = Reference(reference.triangle, reference.slot - params.first_node);
    for (var axis = 0u; axis < 3u && params.has_bounds == 0u; axis++) {
        for (var end = 0u; end < 2u; end++) {
            var event = events[axis * params.events + 2u * (first + index) + end];
            event.what -= first << 2u;
            next_events[axis * params.next_events + 2u * index + end] = event;
        }
    }
}
