// Sorts short runs of each child's new events, by counting for each how many come before it.
//
// Twin: `rank.rs`.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> next_references: References;
@group(0) @binding(2) var<storage> next_nodes: array<Node>;
@group(0) @binding(3) var<storage> fresh: array<Event>;
@group(0) @binding(4) var<storage, read_write> next_fresh: array<Event>;

@compute @workgroup_size(256)
fn rank(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let start = index / params.fresh_events * params.fresh_events;
    if index - start >= 2u * next_references.parts {
        return;
    }
    let event = fresh[index];
    let slot = next_references.list[event.what >> 2u].slot;
    let list = start + 2u * next_nodes[slot].fresh_first;
    let run = list + (index - list) / RUN * RUN;
    let end = min(run + RUN, list + 2u * next_nodes[slot].fresh_count);
    var rank = 0u;
    for (var other = run; other < index; other++) {
        rank += u32(!is_before(event, fresh[other]));
    }
    for (var other = index + 1u; other < end; other++) {
        rank += u32(is_before(fresh[other], event));
    }
    next_fresh[run + rank] = event;
}
