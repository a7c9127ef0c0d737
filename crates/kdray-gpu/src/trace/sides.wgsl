// Whether the line of a ray crosses a triangle: the signs of three edge functions [WBA13].
//
// Twin: `intersect.rs` of kdray's tracer.

//#import shear

// Corners in ray space and edge functions of the triangle tested last.
var<private> seen: array<vec3u, 3>;
var<private> edges: vec3u;

// Whether it is crossed. Ties are decided.
fn is_crossed(triangle: u32) -> bool {
    for (var corner = 0u; corner < 3u; corner++) {
        let at = corner_of(triangle, corner);
        let z = f_sub(at.z, origin.z);
        let x = f_sub(f_sub(at.x, origin.x), f_mul(shear.x, z));
        let y = f_sub(f_sub(at.y, origin.y), f_mul(shear.y, z));
        seen[corner] = vec3u(x, y, z);
    }
    // Only the distance itself can have no end, and then all corners are at one place.
    if max(magnitude(seen[0].x), magnitude(seen[0].y)) > F_MAX {
        return false;
    }
    edges = vec3u(edge(seen[2], seen[1]), edge(seen[0], seen[2]), edge(seen[1], seen[0]));
    let has_positive = is_positive(edges.x) || is_positive(edges.y) || is_positive(edges.z);
    let has_negative = is_negative(edges.x) || is_negative(edges.y) || is_negative(edges.z);
    if has_positive && has_negative {
        return false;
    }
    if is_zero(edges.x) || is_zero(edges.y) || is_zero(edges.z) {
        return is_crossed_in_tie();
    }
    let is_number = max(max(magnitude(edges.x), magnitude(edges.y)), magnitude(edges.z)) <= F_INFINITY;
    return is_number;
}

fn is_zero(x: u32) -> bool {
    return magnitude(x) == 0u;
}

fn is_positive(x: u32) -> bool {
    return x - 1u < F_INFINITY;
}

fn is_negative(x: u32) -> bool {
    return is_positive(x ^ F_SIGN);
}

// The edge function, with the infinities and the NaN of the processor.
fn edge(p: vec3u, q: vec3u) -> u32 {
    let one = f_mul(p.x, q.y);
    let other = f_mul(p.y, q.x);
    if magnitude(one) == F_INFINITY {
        return select(one, NONE, one == other);
    }
    if magnitude(other) == F_INFINITY {
        return other ^ F_SIGN;
    }
    return f_sub(one, other);
}

const ON_EDGE = 0u;
const POSITIVE = 1u;
const NEGATIVE = 2u;

// As if the ray stood an infinitesimal step `(e, e²)` to the side.
fn is_crossed_in_tie() -> bool {
    var sides = 0u;
    for (var index = 0u; index < 3u; index++) {
        let side = side_of(seen[(index + 2u) % 3u], seen[(index + 1u) % 3u]);
        if side == ON_EDGE {
            return false;
        }
        sides |= side;
    }
    return sides != (POSITIVE | NEGATIVE);
}

// On which side of an edge the ray is; on the edge if that is a point.
fn side_of(p: vec3u, q: vec3u) -> u32 {
    set_cell(ENDS, p.x);
    set_cell(ENDS + 1u, p.y);
    set_cell(ENDS + 2u, q.x);
    set_cell(ENDS + 3u, q.y);
    run_steps(POINTS_END, EDGE_END);
    let edge = cells[RESULT];
    if edge.high != 0u {
        return select(POSITIVE, NEGATIVE, edge.sign != 0u);
    }
    if key_of(p.y) != key_of(q.y) {
        return select(NEGATIVE, POSITIVE, key_of(p.y) > key_of(q.y));
    }
    if key_of(p.x) != key_of(q.x) {
        return select(NEGATIVE, POSITIVE, key_of(q.x) > key_of(p.x));
    }
    return ON_EDGE;
}
