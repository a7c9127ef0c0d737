// A triangle, clipped to a box: the recipe of the tree's definition, operation by operation.
//
// Twin: `geometry/clip.rs` of kdray. Coordinates are the bits of floats; comparisons are those of
// integers.

//#import level
//#import float

const MAX_CORNERS = 12u;
const HALF_ULP = 0x33800000u; // Of one.
const FIVE = 0x40a00000u;
const NO_PART = Box(vec3u(NONE), vec3u(NONE));

// Ordered positions.
struct Box {
    lower: vec3u,
    upper: vec3u,
}

var<private> corners: array<vec3u, 12>;
var<private> corner_count: u32;
var<private> overflowed: bool;

// Bits that compare like the coordinate; both zeros are one.
fn place_of(bits: u32) -> u32 {
    return f_key(select(bits, 0u, bits == 0x80000000u));
}

fn places_of(point: vec3u) -> vec3u {
    return vec3u(place_of(point.x), place_of(point.y), place_of(point.z));
}

fn corner_bounds() -> Box {
    var bounds = Box(vec3u(NONE), vec3u(0u));
    for (var index = 0u; index < corner_count; index++) {
        let place = places_of(corners[index]);
        bounds = Box(min(bounds.lower, place), max(bounds.upper, place));
    }
    return bounds;
}

// The part of the triangle in `corners` inside a box.
fn part_inside(bounds: Box, clip: bool) -> Box {
    let whole = corner_bounds();
    let shared_box = Box(max(whole.lower, bounds.lower), min(whole.upper, bounds.upper));
    if !clip {
        return or_none(shared_box);
    }
    let margin = margin_of(whole, bounds);
    overflowed = false;
    for (var axis = 0u; axis < 3u; axis++) {
        if whole.lower[axis] < bounds.lower[axis] {
            cut(axis, f_sub(f_of_key(bounds.lower[axis]), margin), true);
        }
        if whole.upper[axis] > bounds.upper[axis] {
            cut(axis, f_add(f_of_key(bounds.upper[axis]), margin), false);
        }
    }
    if overflowed {
        return or_none(shared_box);
    }
    if corner_count == 0u {
        return NO_PART;
    }
    let part = corner_bounds();
    var clipped: Box;
    for (var axis = 0u; axis < 3u; axis++) {
        let lower = place_of(f_sub(f_of_key(part.lower[axis]), margin));
        let upper = place_of(f_add(f_of_key(part.upper[axis]), margin));
        clipped.lower[axis] = max(lower, shared_box.lower[axis]);
        clipped.upper[axis] = min(upper, shared_box.upper[axis]);
    }
    return or_none(clipped);
}

fn or_none(part: Box) -> Box {
    if any(part.lower > part.upper) {
        return NO_PART;
    }
    return part;
}

// How far the corners of the clipped polygon can be from where they belong.
fn margin_of(whole: Box, bounds: Box) -> u32 {
    var cuts = 1u;
    var largest = 0u;
    var extent = 0u;
    for (var axis = 0u; axis < 3u; axis++) {
        let lower = f_of_key(whole.lower[axis]);
        let upper = f_of_key(whole.upper[axis]);
        cuts += u32(whole.lower[axis] < bounds.lower[axis]);
        cuts += u32(whole.upper[axis] > bounds.upper[axis]);
        largest = max(largest, max(lower & 0x7fffffffu, upper & 0x7fffffffu));
        extent = max(extent, f_sub(upper, lower));
    }
    let scale = bitcast<u32>(f32(cuts));
    return f_mul(scale, f_mul(HALF_ULP, f_add(f_mul(FIVE, extent), largest)));
}

// Keeps the side of the plane above, or the one below.
fn cut(axis: u32, plane: u32, above: bool) {
    let old = corners;
    let count = corner_count;
    let limit = place_of(plane);
    corner_count = 0u;
    for (var index = 0u; index < count; index++) {
        let corner = old[index];
        let next = old[select(index + 1u, 0u, index + 1u == count)];
        let here = is_inside(corner[axis], limit, above);
        if here {
            push(corner);
        }
        if here != is_inside(next[axis], limit, above) {
            push(crossing(corner, next, axis, plane));
        }
    }
}

fn is_inside(coordinate: u32, limit: u32, above: bool) -> bool {
    let place = place_of(coordinate);
    return select(place <= limit, place >= limit, above);
}

fn push(corner: vec3u) {
    if corner_count == MAX_CORNERS {
        overflowed = true;
        return;
    }
    corners[corner_count] = corner;
    corner_count++;
}

// Where the edge from `p` to `q` meets the plane.
fn crossing(p: vec3u, q: vec3u, axis: u32, plane: u32) -> vec3u {
    let t = f_div(f_sub(plane, p[axis]), f_sub(q[axis], p[axis]));
    var point: vec3u;
    for (var other = 0u; other < 3u; other++) {
        point[other] = f_add(p[other], f_mul(f_sub(q[other], p[other]), t));
    }
    point[axis] = plane;
    return point;
}
