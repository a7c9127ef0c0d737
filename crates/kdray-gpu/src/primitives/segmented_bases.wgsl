// Remember what a scan has at the start of every segment. Twin: `exclusive` in `segmented.rs`.

//#import count

@group(0) @binding(0) var<uniform> params: Count;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage> offsets: array<u32>;
@group(0) @binding(3) var<storage> scan: array<u32>;
@group(0) @binding(4) var<storage, read_write> bases: array<u32>;

@compute @workgroup_size(256)
fn segmented_bases(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let segment = group_index(group, groups) * WORKGROUP + invocation;
    // An empty segment at the end has no values, and no need of a base.
    if segment < element_count(params) && offsets[segment] < arrayLength(&scan) {
        bases[segment] = scan[offsets[segment]];
    }
}
