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

// What is known of a child: where its list begins if nothing went there from other nodes, and its
// new events that are still to come, the next one at hand.
struct Child {
    base: u32,
    fresh: u32,
    fresh_end: u32,
    next: Event,
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
    var left: Child;
    var right: Child;
    var known_end = 0u;
    for (var place = chunk * CHUNK; place < end; place++) {
        let event = events[axis * params.events + place];
        let name = marks[event.what >> 2u];
        if name == NONE {
            continue;
        }
        let is_right = (name & TO_RIGHT) != 0u;
        if place >= known_end {
            let pair = next_references.list[name & ~TO_RIGHT].slot / 2u;
            known_end = 2u * (pairs[pair].first + pairs[pair].count);
            left = child_of(2u * pair, axis, pairs[pair].start.left);
            right = child_of(2u * pair + 1u, axis, pairs[pair].start.right);
        }
        var at = 0u;
        if is_right {
            if is_before(right.next, event) {
                right = reach(right, event);
            }
            at = right.base + ranks.y + right.fresh;
        } else {
            if is_before(left.next, event) {
                left = reach(left, event);
            }
            at = left.base + ranks.x + left.fresh;
        }
        next_events[at] = Event(event.position, (name << 2u) | (event.what & 3u));
        ranks += select(vec2u(1u, 0u), vec2u(0u, 1u), is_right);
    }
}

// `others` are the references that go to children of the same side before it.
fn child_of(slot: u32, axis: u32, others: u32) -> Child {
    let fresh_first = next_nodes[slot].fresh_first;
    let first = axis * params.fresh_events + 2u * fresh_first;
    let base = axis * params.next_events + 2u * (next_nodes[slot].first - others) - first;
    let child = Child(base, first, first + 2u * next_nodes[slot].fresh_count, Event());
    return at_hand(child);
}

fn at_hand(child: Child) -> Child {
    var known = child;
    known.next = Event(NONE, NONE);
    if child.fresh < child.fresh_end {
        known.next = fresh[child.fresh];
    }
    return known;
}

// Passes over the new events that come before an event: there are few as a rule, so in steps that
// grow, and back by halves.
fn reach(child: Child, event: Event) -> Child {
    var low = child.fresh + 1u;
    var step = 1u;
    while low + step <= child.fresh_end && is_before(fresh[low + step - 1u], event) {
        low += step;
        step *= 2u;
    }
    var high = min(low + step - 1u, child.fresh_end);
    while low < high {
        let middle = (low + high) / 2u;
        if is_before(fresh[middle], event) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return at_hand(Child(child.base, low, child.fresh_end, Event()));
}
