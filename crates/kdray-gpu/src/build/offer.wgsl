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
// By axis and end of a part, what is known of the plane there: how many parts have something on the
// left, how many on the right, and how many lie in it, in 8 bits each.
var<workgroup> plane_counts: array<u32, 6 * SMALL>;

// The cheapest of the planes that one invocation looks at.
fn offer(task: Task, local: u32) -> Offer {
    var best = Offer(NONE, LEAF, NONE);
    if task.depth == 0u || !is_open(prices_of(task.lower, task.upper, 0u), task.count) {
        return best;
    }
    for (var axis = 0u; axis < 3u; axis++) {
        if !is_counted {
            count_planes(task, axis, local);
        }
        let prices = prices_of(task.lower, task.upper, axis);
        let bounds = vec2u(task.lower[axis], task.upper[axis]);
        for (var end = local; end < 2u * task.count; end += TEAM) {
            let plane = bound(task.first, axis, end);
            if plane > bounds.x && plane < bounds.y {
                let priced = price(prices, bounds, plane, plane_counts[2u * SMALL * axis + end]);
                best = cheaper(best, Offer(priced.x, axis | priced.y, plane));
            }
        }
    }
    return best;
}

// Counts for the planes that an invocation looks at along an axis, eight at a time.
fn count_planes(task: Task, axis: u32, local: u32) {
    for (var end = local; end < 2u * task.count; end += 8u * TEAM) {
        let one = planes_at(task, axis, end);
        let other = planes_at(task, axis, end + 4u * TEAM);
        var of_one = vec4u(0u);
        var of_other = vec4u(0u);
        for (var part = task.first; part < task.first + task.count; part++) {
            let lower = vec4u(part_bounds[6u * part + 2u * axis]);
            let upper = vec4u(part_bounds[6u * part + 2u * axis + 1u]);
            of_one += sides(lower, upper, one);
            of_other += sides(lower, upper, other);
        }
        for (var k = 0u; k < 4u; k++) {
            put_count(task, axis, end + k * TEAM, of_one[k]);
            put_count(task, axis, end + (4u + k) * TEAM, of_other[k]);
        }
    }
}

// Where every so many planes are.
fn planes_at(task: Task, axis: u32, first: u32) -> vec4u {
    var planes = vec4u(0u);
    for (var k = 0u; k < 4u; k++) {
        if first + k * TEAM < 2u * task.count {
            planes[k] = bound(task.first, axis, first + k * TEAM);
        }
    }
    return planes;
}

fn put_count(task: Task, axis: u32, end: u32, count: u32) {
    if end < 2u * task.count {
        plane_counts[2u * SMALL * axis + end] = count;
    }
}

// What a part adds to the counts of four planes.
fn sides(lower: vec4u, upper: vec4u, planes: vec4u) -> vec4u {
    let is_left = lower < planes;
    let is_right = upper > planes;
    let in_plane = select(vec4u(0x10000u), vec4u(0u), is_left | is_right);
    return select(vec4u(0u), vec4u(1u), is_left) + select(vec4u(0u), vec4u(0x100u), is_right)
        + in_plane;
}

// The price of a plane, and what goes with its axis: the side that its flat parts go to, and the
// side where nothing is.
fn price(prices: Prices, bounds: vec2u, plane: u32, count: u32) -> vec2u {
    let counts = vec3u(count & 0xffu, (count >> 8u) & 0xffu, count >> 16u);
    let position = f_of_key(plane);
    let below = f_sub(position, f_of_key(bounds.x));
    let distances = vec2u(below, f_sub(f_of_key(bounds.y), position));
    let left = split_price(prices, distances, vec2u(counts.x + counts.z, counts.y));
    let empty_left = select(0u, EMPTY_LEFT, counts.x == 0u);
    let empty_right = select(0u, EMPTY_RIGHT, counts.y == 0u);
    if counts.z == 0u {
        return vec2u(left, empty_left | empty_right);
    }
    let right = split_price(prices, distances, vec2u(counts.x, counts.y + counts.z));
    return select(vec2u(left, empty_right), vec2u(right, FLAT_RIGHT | empty_left), right < left);
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
