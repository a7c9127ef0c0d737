// What lies in the arrays of a build, and which part of them an invocation works on.
//
// Twins: `data.rs`, `kernel.rs`.

const WORKGROUP = 256u;
const CHUNK = 32u; // Events or references that an invocation walks through.
const RUN = 64u; // New events that are sorted at once.
const NONE = 0xffffffffu;
const TO_RIGHT = 0x80000000u;
const AXIS_SHIFT = 30u;

// Kinds of events, by position.
const END = 0u;
const ENTER = 1u;
const LEAVE = 2u;
const START = 3u;

// What becomes of a node, beside its axis.
const LEAF = 3u;
const FLAT_RIGHT = 4u;
const FINISHED = 7u;

// Bits of a mark.
const LEFT = 1u;
const RIGHT = 2u;

struct Params {
    count: u32,
    nodes: u32,
    next_nodes: u32,
    events: u32,
    next_events: u32,
    fresh_events: u32,
    straddlers: u32,
    left: u32,
    right: u32,
    leaf: u32,
    gone: u32,
    records: u32,
    next_records: u32,
    finished: u32,
    run: u32,
    may_split: u32,
    max_leaf: u32,
    clip: u32,
    traversal: u32,
    intersect: u32,
    empty_factor: u32,
    triangles: u32,
    first_node: u32,
    depth_left: u32,
    piece_words: u32,
    axis: u32,
    base_axis: u32,
    has_bounds: u32,
}

struct Event {
    position: u32,
    what: u32,
}

struct Reference {
    triangle: u32,
    slot: u32,
}

struct References {
    count: u32,
    parts: u32,
    most: u32,
    most_parts: u32,
    list: array<Reference>,
}

struct Node {
    lower: array<u32, 3>,
    first: u32,
    upper: array<u32, 3>,
    count: u32,
    fresh_first: u32,
    fresh_count: u32,
}

struct Plan {
    position: u32,
    what: u32,
    place: u32,
}

struct Ranks {
    straddlers: u32,
    left: u32,
    right: u32,
}

struct Pair {
    first: u32,
    count: u32,
    start: Ranks,
    end: Ranks,
}

struct Part {
    lower: array<u32, 3>,
    upper: array<u32, 3>,
}

// Number of an invocation, row of workgroups after row.
fn invocation(group: vec3u, groups: vec3u, local: u32) -> u32 {
    return (group.y * groups.x + group.x) * WORKGROUP + local;
}

fn chunks_of(elements: u32) -> u32 {
    return max((elements + CHUNK - 1u) / CHUNK, 1u);
}

// Whether an event comes before another in a list.
fn is_before(one: Event, other: Event) -> bool {
    return one.position < other.position
        || (one.position == other.position && (one.what & 3u) < (other.what & 3u));
}

// The events of a reference along an axis: see `Event::pair`.
fn event_pair(lower: u32, upper: u32, place: u32) -> array<Event, 2> {
    let is_flat = lower == upper;
    let first = Event(lower, (place << 2u) | select(START, ENTER, is_flat));
    let second = Event(upper, (place << 2u) | select(END, LEAVE, is_flat));
    return array<Event, 2>(first, second);
}
