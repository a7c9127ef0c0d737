// The events of a chunk, priced one after the other: node by node, so that what is known of a node
// is loaded once.
//
// Twin: `pricing.rs`. Whoever imports this has the parameters, references, nodes, events, sums
// and what the teams have finished.

//#import prices

// The node that is swept, along one axis; its events in the chunk end before `end`.
struct Swept {
    is_open: bool,
    first: u32,
    count: u32,
    end: u32,
    lower: u32,
    upper: u32,
    prices: Prices,
}

fn swept(slot: u32, axis: u32, end: u32) -> Swept {
    var node: Swept;
    let lower = nodes[slot].lower;
    let upper = nodes[slot].upper;
    node.first = nodes[slot].first;
    node.count = nodes[slot].count;
    node.end = min(2u * (node.first + node.count), end);
    node.lower = lower[axis];
    node.upper = upper[axis];
    let corner = vec3u(lower[0], lower[1], lower[2]);
    node.prices = prices_of(corner, vec3u(upper[0], upper[1], upper[2]), axis);
    node.is_open = inner[params.nodes + slot] == 0u && is_open(node.prices, node.count);
    return node;
}

// What the plane at an event of an open node costs, all bits inverted; zero if it is no candidate.
// `place` is the event's among those of its axis, and `left` how many before it enter the left side.
fn price_at(node: Swept, event: Event, place: u32, left: u32) -> u32 {
    if event.position <= node.lower || event.position >= node.upper {
        return 0u;
    }
    let position = f_of_key(event.position);
    let below = f_sub(position, f_of_key(node.lower));
    let above = f_sub(f_of_key(node.upper), position);
    let on_left = left - node.first;
    let passed = place - 2u * node.first - on_left;
    let on_right = node.count - passed - (1u - (event.what & 1u));
    return ~split_price(node.prices, vec2u(below, above), vec2u(on_left, on_right));
}
