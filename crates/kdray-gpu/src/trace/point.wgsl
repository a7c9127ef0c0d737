// Where a triangle that is crossed is crossed, in double precision.
//
// Twin: `locate` in `intersect.rs` of kdray's tracer.

//#import shear

struct Crossing {
    t: u32,
    u: u32,
    v: u32,
}

fn locate_crossing(triangle: u32) -> Crossing {
    for (var corner = 0u; corner < 3u; corner++) {
        let at = corner_of(triangle, corner);
        for (var axis = 0u; axis < 3u; axis++) {
            set_cell(CORNERS + 3u * corner + axis, at[axis]);
        }
    }
    run_steps(SLOPES_END, POINTS_END);
    weigh_corners();
    run_steps(FOOT_END, STEPS_END);
    let u = d_to_f32(cells[EDGES + 1u]);
    return Crossing(d_to_f32(cells[RESULT]), u, d_to_f32(cells[EDGES + 2u]));
}

// Puts the weights of the second and third corner in place of their edges.
fn weigh_corners() {
    var has_positive = false;
    var has_negative = false;
    for (var edge = 0u; edge < 3u; edge++) {
        take_ends((edge + 2u) % 3u, (edge + 1u) % 3u);
        run_steps(POINTS_END, EDGE_END);
        let side = cells[RESULT];
        cells[EDGES + edge] = side;
        has_positive = has_positive || (side.high != 0u && side.sign == 0u);
        has_negative = has_negative || (side.high != 0u && side.sign != 0u);
    }
    run_steps(EDGE_END, WEIGHTS_END);
    if (has_positive && has_negative) || cells[RESULT].high == 0u {
        weigh_nearest();
    }
}

// Makes the edge from one corner to another the one to work on.
fn take_ends(p: u32, q: u32) {
    cells[ENDS] = cells[CORNERS + 3u * p];
    cells[ENDS + 1u] = cells[CORNERS + 3u * p + 1u];
    cells[ENDS + 2u] = cells[CORNERS + 3u * q];
    cells[ENDS + 3u] = cells[CORNERS + 3u * q + 1u];
}

// The same weights at the point of the outline nearest to the ray.
fn weigh_nearest() {
    var least: Double;
    for (var edge = 0u; edge < 3u; edge++) {
        take_ends(edge, (edge + 1u) % 3u);
        run_steps(WEIGHTS_END, NEAREST_END);
        clamp_share();
        run_steps(NEAREST_END, FOOT_END);
        if edge == 0u || d_is_below(cells[DISTANCE], least) {
            least = cells[DISTANCE];
            set_cell(EDGES + 1u, 0u);
            set_cell(EDGES + 2u, 0u);
            if edge == 0u {
                cells[EDGES + 1u] = cells[SHARE];
            } else if edge == 1u {
                cells[EDGES + 1u] = cells[RESULT];
                cells[EDGES + 2u] = cells[SHARE];
            } else {
                cells[EDGES + 2u] = cells[RESULT];
            }
        }
    }
}

// Keeps the nearest point on its edge. A point has no length, and share.
fn clamp_share() {
    let share = cells[SHARE];
    if cells[DISTANCE].high == 0u || (share.high != 0u && share.sign != 0u) {
        set_cell(SHARE, 0u);
    } else if d_is_below(cells[ONE], share) {
        cells[SHARE] = cells[ONE];
    }
}
