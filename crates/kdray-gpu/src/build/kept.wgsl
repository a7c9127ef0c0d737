// Events that keep their order in a child.
//
// Twin: `kept` in `tally.rs`. Whoever imports this has the parameters, events, marks and sums.

//#import level

// Events of the level along an axis.
fn event_count() -> u32 {
    return 2u * (params.straddlers + params.left + params.right + params.leaf + params.gone);
}

// How many of the events from `start` to `end` of an axis go left and right.
fn kept(axis: u32, start: u32, end: u32) -> vec2u {
    var counts = vec2u(0u);
    for (var place = start; place < end; place++) {
        let name = marks[events[axis * params.events + place].what >> 2u];
        if name != NONE {
            counts += select(vec2u(1u, 0u), vec2u(0u, 1u), (name & TO_RIGHT) != 0u);
        }
    }
    return counts;
}

// The same for the events of an axis before a chunk; the counts are scanned.
fn kept_before_chunk(axis: u32, chunk: u32) -> vec2u {
    let chunks = chunks_of(params.events);
    let left = 2u * axis * chunks;
    let right = left + chunks;
    return vec2u(sums[left + chunk] - sums[left], sums[right + chunk] - sums[right]);
}
