// Which references of a node are flat along an axis.
//
// Twin: `flats.rs`.

//#import span

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> positions: array<u32>;
@group(0) @binding(2) var<storage> triangles: array<u32>;
@group(0) @binding(3) var<storage> bounds: array<Part>;
@group(0) @binding(4) var<storage> references: References;
@group(0) @binding(5) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(256)
fn flats(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    sums[index] = 0u;
    if index < references.count {
        let span = span(index, params.axis);
        sums[index] = u32(span.x == span.y);
    }
}
