// Moves the events whose references keep their bounds: they keep their order, and leave room for
// the new events that come before them.
//
// Twin: `keep.rs`.

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

// What is known of a child: where its list begins if nothing went there from other nodes, and the
// next of its new events.
struct Child {
    slot: u32,
    base: u32,
    fresh: u32,
    fresh_start: u32,
    fresh_end: u32,
}

@compute @workgroup_size(256)
fn keep(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let chunks = chunks_of(params.events);
    let axis = index / chunks;
    let chunk = index % chunks;
    let end = min((chunk + 1u) * CHUNK, event_count());
    var ranks = kept_before_chunk(axis, chunk);
    var children = array<Child, 2>();
    children[0].slot = NONE;
    children[1].slot = NONE;
    for (var place = chunk * CHUNK; place < end; place++) {
        let event = events[axis * params.events + place];
        let name = marks[event.what >> 2u];
        if name == NONE {
            continue;
        }
        let side = name >> 31u;
        let slot = next_references.list[name & ~TO_RIGHT].slot;
        if slot != children[side].slot {
            children[side] = child_of(slot, axis);
        }
        let child = children[side];
        var next = child.fresh;
        if next < child.fresh_end && is_before(fresh[next], event) {
            next = place_among(event, next + 1u, child.fresh_end);
            children[side].fresh = next;
        }
        let at = child.base + ranks[side] + next - child.fresh_start;
        next_events[at] = Event(event.position, (name << 2u) | (event.what & 3u));
        ranks[side] += 1u;
    }
}

fn child_of(slot: u32, axis: u32) -> Child {
    let node = next_nodes[slot];
    let start = pairs[slot / 2u].start;
    let others = 2u * select(start.left, start.right, slot % 2u == 1u);
    let first = axis * params.fresh_events + 2u * node.fresh_first;
    let base = axis * params.next_events + 2u * node.first - others;
    return Child(slot, base, first, first, first + 2u * node.fresh_count);
}

// How far the new events from `low` to `high` come before an event.
fn place_among(event: Event, first: u32, end: u32) -> u32 {
    var low = first;
    var high = end;
    while low < high {
        let middle = (low + high) / 2u;
        if is_before(fresh[middle], event) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}
