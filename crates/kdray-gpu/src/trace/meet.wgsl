// The triangles that each ray may hit, leaf after leaf: counted, or written where the counts say.
//
// A triangle comes again in every leaf whose part of the ray it may be hit in.

//#import walk
//#import times

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> rays: array<Ray>;
@group(0) @binding(2) var<storage> except: array<u32>;
@group(0) @binding(3) var<storage> nodes: array<vec2u>;
@group(0) @binding(4) var<storage> references: array<u32>;
@group(0) @binding(5) var<storage> positions: array<u32>;
@group(0) @binding(6) var<storage> triangles: array<u32>;
@group(0) @binding(7) var<storage, read_write> starts: array<u32>;
@group(0) @binding(8) var<storage, read_write> met: array<vec2u>;

// Triangles met so far.
var<private> met_count: u32;

@compute @workgroup_size(256)
fn meet(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    met_count = 0u;
    if load(index) {
        trace(index);
    }
    if params.is_counted == 1u {
        starts[index] = met_count;
    }
}

fn trace(index: u32) {
    prepare_shear();
    begin();
    for (var turn = 0u; turn < NONE && next_leaf(); turn++) {
        for (var place = 0u; place < leaf_count; place++) {
            let triangle = references[leaf_first + place];
            if triangle != left_out && is_crossed(triangle) && may_be_here() {
                if params.is_counted == 0u {
                    met[starts[index] + met_count] = vec2u(index, triangle);
                }
                met_count++;
            }
        }
    }
}

// Whether the triangle tested last may be hit in the interval that was asked for, and in the leaf.
fn may_be_here() -> bool {
    let known = times();
    return known.early <= min(t_last, leaf.leave) && known.late >= max(t_first, leaf.enter);
}
