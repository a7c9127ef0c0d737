// Merges sorted runs of new events two by two.
//
// Twin: `merge.rs`. Each event finds its place among those of the other run.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> next_references: References;
@group(0) @binding(2) var<storage> next_nodes: array<Node>;
@group(0) @binding(3) var<storage> fresh: array<Event>;
@group(0) @binding(4) var<storage, read_write> next_fresh: array<Event>;

@compute @workgroup_size(256)
fn merge(
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
    let end = list + 2u * next_nodes[slot].fresh_count;
    let run = (index - list) / params.run;
    let is_right = (run & 1u) == 1u;
    let other = list + (run ^ 1u) * params.run;
    // Events of the left run come before their equals in the right one.
    var low = min(other, end);
    var high = min(other + params.run, end);
    let first = low;
    while low < high {
        let middle = (low + high) / 2u;
        let comes_first = select(
            is_before(fresh[middle], event),
            !is_before(event, fresh[middle]),
            is_right,
        );
        if comes_first {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    let own = index - list - run * params.run;
    next_fresh[list + run / 2u * 2u * params.run + own + low - first] = event;
}
