// The cheapest plane of a node, by counting for every plane the parts on its sides.
//
// Twin: `offer.rs`.

//#import subtree

// A plane; what it says of the flat parts matters only if there are some.
struct Offer {
    price: u32,
    what: u32,
    position: u32,
}

var<workgroup> offers: array<Offer, TEAM>;

// The cheapest of the planes that one invocation looks at.
fn offer(task: Task, local: u32) -> Offer {
    var best = Offer(NONE, LEAF, NONE);
    for (var axis = 0u; axis < 3u; axis++) {
        let prices = prices_of(task.lower, task.upper, axis);
        if task.depth == 0u || !is_open(prices, task.count) {
            break;
        }
        let bounds = vec2u(task.lower[axis], task.upper[axis]);
        for (var index = local; index < 2u * task.count; index += 4u * TEAM) {
            let planes = planes_at(task, axis, index);
            let counts = counts_at(task, axis, planes);
            for (var k = 0u; k < 4u; k++) {
                if planes[k] > bounds.x && planes[k] < bounds.y {
                    let priced = price(prices, bounds, planes[k], counts[k]);
                    best = cheaper(best, Offer(priced.x, axis | priced.y, planes[k]));
                }
            }
        }
    }
    return best;
}

// Where every so many planes are; those that are none at the lowest position.
fn planes_at(task: Task, axis: u32, first: u32) -> vec4u {
    var planes = vec4u(0u);
    for (var k = 0u; k < 4u; k++) {
        let index = first + k * TEAM;
        if index < 2u * task.count {
            let part = task.first + index / 2u;
            planes[k] = select(part_lower[part][axis], part_upper[part][axis], (index & 1u) == 1u);
        }
    }
    return planes;
}

// How many parts have something on the left of four planes, how many on the right, and how many
// lie in them.
fn counts_at(task: Task, axis: u32, planes: vec4u) -> array<vec3u, 4> {
    var left = vec4u(0u);
    var right = vec4u(0u);
    var flat_ones = vec4u(0u);
    for (var part = task.first; part < task.first + task.count; part++) {
        let is_left = vec4u(part_lower[part][axis]) < planes;
        let is_right = vec4u(part_upper[part][axis]) > planes;
        left += vec4u(is_left);
        right += vec4u(is_right);
        flat_ones += vec4u(!(is_left | is_right));
    }
    var counts: array<vec3u, 4>;
    for (var k = 0u; k < 4u; k++) {
        counts[k] = vec3u(left[k], right[k], flat_ones[k]);
    }
    return counts;
}

// The price of a plane, and the side that its flat parts go to.
fn price(prices: Prices, bounds: vec2u, plane: u32, counts: vec3u) -> vec2u {
    let position = f_of_key(plane);
    let below = f_sub(position, f_of_key(bounds.x));
    let distances = vec2u(below, f_sub(f_of_key(bounds.y), position));
    let left = split_price(prices, distances, vec2u(counts.x + counts.z, counts.y));
    if counts.z == 0u {
        return vec2u(left, 0u);
    }
    let right = split_price(prices, distances, vec2u(counts.x, counts.y + counts.z));
    return select(vec2u(left, 0u), vec2u(right, FLAT_RIGHT), right < left);
}

// Of equals the lowest axis, then the lowest position.
fn cheaper(one: Offer, other: Offer) -> Offer {
    let axes = vec2u(one.what & 3u, other.what & 3u);
    let is_first = other.price < one.price
        || (other.price == one.price && other.price != NONE && (axes.y < axes.x
            || (axes.y == axes.x && other.position < one.position)));
    if is_first {
        return other;
    }
    return one;
}

// What becomes of a node, by the offers of all.
fn choice(task: Task) -> Plan {
    var best = offers[0];
    for (var index = 1u; index < TEAM; index++) {
        best = cheaper(best, offers[index]);
    }
    if best.price >= leaf_price(prices_of(task.lower, task.upper, 0u), task.count) {
        return Plan(0u, LEAF, 0u);
    }
    return Plan(best.position, best.what, 0u);
}
