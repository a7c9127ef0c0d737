// Subtract from every value of a scan what it has at the start of the value's segment. Twin:
// `exclusive` in `segmented.rs`.

//#import count

struct Params {
    count: Count,
    segments: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage> offsets: array<u32>;
@group(0) @binding(3) var<storage> bases: array<u32>;
@group(0) @binding(4) var<storage, read_write> scan: array<u32>;

@compute @workgroup_size(256)
fn segmented_apply(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let i = group_index(group, groups) * WORKGROUP + invocation;
    if i < element_count(params.count) {
        scan[i] -= bases[segment_of(i)];
    }
}

// The last segment that starts at or before `i`.
fn segment_of(i: u32) -> u32 {
    var first = 0u;
    var last = params.segments - 1u;
    while first < last {
        let middle = first + (last - first + 1u) / 2u;
        if offsets[middle] <= i {
            first = middle;
        } else {
            last = middle - 1u;
        }
    }
    return first;
}
