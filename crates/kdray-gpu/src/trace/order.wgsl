// The hits of each ray in order of `t` and then of the triangle, each once, and how many they are.

//#import ray

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> rays: array<Ray>;
@group(0) @binding(2) var<storage> except: array<u32>;
@group(0) @binding(3) var<storage> starts: array<u32>;
@group(0) @binding(4) var<storage, read_write> hits: array<vec4u>;
@group(0) @binding(5) var<storage, read_write> hit_counts: array<u32>;

@compute @workgroup_size(256)
fn order(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let start = starts[index];
    let end = starts[index + 1u];
    var count = 0u;
    for (var place = start; place < end; place++) {
        let hit = hits[place];
        if hit.y != NONE {
            count += insert(start, count, hit);
        }
    }
    hit_counts[index] = count;
}

// Puts a hit among the `count` before it, which are in order, if it is not there. Leaves come from
// front to back: few are beyond it.
fn insert(start: u32, count: u32, hit: vec4u) -> u32 {
    var place = count;
    for (; place > 0u && comes_before(hit, hits[start + place - 1u]); place--) {
    }
    if place > 0u && hits[start + place - 1u].y == hit.y {
        return 0u;
    }
    for (var to = count; to > place; to--) {
        hits[start + to] = hits[start + to - 1u];
    }
    hits[start + place] = hit;
    return 1u;
}

fn comes_before(one: vec4u, other: vec4u) -> bool {
    let t = key_of(one.x);
    let other_t = key_of(other.x);
    return t < other_t || (t == other_t && one.y < other.y);
}
