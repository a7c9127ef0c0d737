// The events of new parts, by child.
//
// Twin: `renew.rs`.

//#import bases

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> next_references: References;
@group(0) @binding(2) var<storage> pairs: array<Pair>;
@group(0) @binding(3) var<storage> exists: array<u32>;
@group(0) @binding(4) var<storage> parts: array<Part>;
@group(0) @binding(5) var<storage> places: array<u32>;
@group(0) @binding(6) var<storage, read_write> fresh: array<Event>;

@compute @workgroup_size(256)
fn renew(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let place = places[index];
    if place == NONE {
        return;
    }
    let side = index % 2u;
    let pair = pairs[next_references.list[place].slot / 2u];
    let rank = parts_before(index / 2u) - parts_before(pair.start.straddlers);
    let first = 2u * (bases_of(pair).parts[side] + rank[side]);
    for (var axis = 0u; axis < 3u; axis++) {
        let events = event_pair(parts[index].lower[axis], parts[index].upper[axis], place);
        fresh[axis * params.fresh_events + first] = events[0];
        fresh[axis * params.fresh_events + first + 1u] = events[1];
    }
}
