// The extents of subtrees, from those of their children.
//
// Twin: `weigh.rs`. An extent is nodes and references.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> records: array<vec2u>;
@group(0) @binding(2) var<storage> finished: array<u32>;
@group(0) @binding(3) var<storage, read_write> extents: array<vec2u>;

@compute @workgroup_size(256)
fn weigh(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let record = params.records + index;
    let what = records[record].y;
    let children = what >> 2u;
    if what == NONE {
        let piece = records[record].x;
        extents[record] = vec2u(finished[piece], finished[piece + 1u]);
    } else if (what & 3u) == LEAF {
        extents[record] = vec2u(1u, children);
    } else {
        extents[record] = vec2u(1u, 0u) + extents[children] + extents[children + 1u];
    }
}
