// Puts the sorted new events of each child among those that kept their order.
//
// Twin: `place.rs`.

//#import kept

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> events: array<Event>;
@group(0) @binding(2) var<storage> marks: array<u32>;
@group(0) @binding(3) var<storage> sums: array<u32>;
@group(0) @binding(4) var<storage> pairs: array<Pair>;
@group(0) @binding(5) var<storage> next_references: References;
@group(0) @binding(6) var<storage> next_nodes: array<Node>;
@group(0) @binding(7) var<storage> fresh: array<Event>;
@group(0) @binding(8) var<storage, read_write> next_events: array<Event>;

@compute @workgroup_size(256)
fn place(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let axis = index / params.fresh_events;
    let rank = index % params.fresh_events;
    if rank >= 2u * next_references.parts {
        return;
    }
    let event = fresh[index];
    let slot = next_references.list[event.what >> 2u].slot;
    let side = slot % 2u;
    let pair = pairs[slot / 2u];
    let interval = interval_of(event, axis, pair);
    let kept_before = kept_before_place(axis, interval);
    let others = 2u * select(pair.start.left, pair.start.right, side == 1u);
    let base = axis * params.next_events + 2u * next_nodes[slot].first;
    let own = rank - 2u * next_nodes[slot].fresh_first;
    next_events[base + kept_before[side] - others + own] = event;
}

// The place of the first of the parent's events that comes after an event.
fn interval_of(event: Event, axis: u32, pair: Pair) -> u32 {
    var low = 2u * pair.first;
    var high = low + 2u * pair.count;
    while low < high {
        let middle = (low + high) / 2u;
        if is_before(event, events[axis * params.events + middle]) {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    return low;
}

// How many events before a place keep their order in each child, from the nearer end of its chunk.
fn kept_before_place(axis: u32, place: u32) -> vec2u {
    let last = chunks_of(params.events) - 1u;
    let chunk = min((place + CHUNK / 2u) / CHUNK, last);
    let start = chunk * CHUNK;
    let between = kept(axis, min(start, place), max(start, place));
    let before = kept_before_chunk(axis, chunk);
    return select(before + between, before - between, place < start);
}
