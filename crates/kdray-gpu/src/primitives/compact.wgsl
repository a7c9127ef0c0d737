// Move every value that is kept to its place. Twin: `kept` in `compact.rs`.
//
// The places are the scan of flags, so a value is kept where they go up.

//#import count

struct Params {
    count: Count,
    // Where in `total` the number of kept values is.
    total_at: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage> places: array<u32>;
@group(0) @binding(3) var<storage> total: array<u32>;
@group(0) @binding(4) var<storage> values: array<u32>;
@group(0) @binding(5) var<storage, read_write> kept: array<u32>;

@compute @workgroup_size(256)
fn compact(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let count = element_count(params.count);
    let i = group_index(group, groups) * WORKGROUP + invocation;
    if i >= count {
        return;
    }
    var next = total[params.total_at];
    if i + 1u < count {
        next = places[i + 1u];
    }
    if places[i] != next {
        kept[places[i]] = values[i];
    }
}
