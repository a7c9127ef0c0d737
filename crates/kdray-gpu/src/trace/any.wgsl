// Whether each ray hits anything.

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
@group(0) @binding(7) var<storage, read_write> found: array<u32>;

@compute @workgroup_size(256)
fn any(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    found[index] = u32(load(index) && is_anything_hit());
}

fn is_anything_hit() -> bool {
    prepare_shear();
    begin();
    for (var turn = 0u; turn < NONE && next_leaf(); turn++) {
        for (var place = 0u; place < leaf_count; place++) {
            let triangle = references[leaf_first + place];
            if triangle != left_out && is_crossed(triangle) && is_inside(triangle) {
                return true;
            }
        }
    }
    return false;
}

// Whether a triangle that the line of the ray crosses is hit in the interval that was asked for.
fn is_inside(triangle: u32) -> bool {
    let known = times();
    if known.early > t_last || known.late < t_first {
        return false;
    }
    if known.early >= t_first && known.late <= t_last {
        return true;
    }
    let t = key_of(locate_crossing(triangle).t);
    return t_first <= t && t <= t_last;
}
