// The triangle that each ray hits first; of several at one time the one with the lowest index.
//
// Candidates are known by the times between which they are hit. Only where these overlap is it worked
// out when exactly; where the triangle is hit is left to `locate`.

//#import walk
//#import times
//#import point

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> rays: array<Ray>;
@group(0) @binding(2) var<storage> except: array<u32>;
@group(0) @binding(3) var<storage> nodes: array<vec2u>;
@group(0) @binding(4) var<storage> references: array<u32>;
@group(0) @binding(5) var<storage> positions: array<u32>;
@group(0) @binding(6) var<storage> triangles: array<u32>;
@group(0) @binding(7) var<storage, read_write> closest_triangles: array<u32>;
@group(0) @binding(8) var<storage, read_write> counts: array<vec3u>;

// The first so far.
var<private> best: u32;
var<private> best_times: Times;
var<private> leaf_visits: u32;
var<private> test_count: u32;

@compute @workgroup_size(256)
fn closest(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    best = NONE;
    leaf_visits = 0u;
    test_count = 0u;
    if load(index) {
        trace();
    }
    closest_triangles[index] = best;
    if params.is_counted == 1u {
        counts[index] = vec3u(step_count, leaf_visits, test_count);
    }
}

fn trace() {
    prepare_shear();
    begin();
    for (var turn = 0u; turn < NONE && next_leaf(); turn++) {
        leaf_visits++;
        for (var place = 0u; place < leaf_count; place++) {
            let triangle = references[leaf_first + place];
            if triangle != best && triangle != left_out {
                test_count++;
                if is_crossed(triangle) {
                    consider(triangle);
                }
            }
        }
    }
}

// Takes a triangle that the line of the ray crosses, if it is hit before the best.
fn consider(triangle: u32) {
    var found = times();
    if found.early > until || found.late < t_first {
        return;
    }
    let is_inside = found.early >= t_first && found.late <= t_last;
    if !is_inside || (best != NONE && found.late >= best_times.early) {
        if !is_before_best(triangle, &found) {
            return;
        }
    }
    best = triangle;
    best_times = found;
    until = found.late;
}

// The same for certain: works out when the triangle is hit and, if need be, when the best is.
fn is_before_best(triangle: u32, found: ptr<function, Times>) -> bool {
    for (var turn = 0u; turn < 2u; turn++) {
        let t = key_of(locate_crossing(select(triangle, best, turn == 1u)).t);
        if turn == 1u {
            best_times = Times(t, t);
            until = t;
        } else {
            *found = Times(t, t);
            if t < t_first || t > until {
                return false;
            }
        }
        if best == NONE || (*found).late < best_times.early {
            return true;
        }
        if best_times.early == best_times.late {
            break;
        }
    }
    return (*found).early == best_times.early && triangle < best;
}
