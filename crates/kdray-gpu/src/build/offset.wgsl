// What comes before each subtree in the finished tree, from what comes before its parent.
//
// Twin: `offset.rs`.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> records: array<vec2u>;
@group(0) @binding(2) var<storage, read_write> extents: array<vec2u>;

@compute @workgroup_size(256)
fn offset(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let record = params.records + index;
    if record == 0u {
        extents[0] = vec2u(0u);
    }
    let what = records[record].y;
    if (what & 3u) == LEAF {
        return;
    }
    let children = what >> 2u;
    let first = extents[record] + vec2u(1u, 0u);
    let left = extents[children];
    extents[children] = first;
    extents[children + 1u] = first + left;
}
