// The references of the root, which are all triangles.
//
// Twin: `seed.rs`.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read_write> references: References;

@compute @workgroup_size(256)
fn seed(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index == 0u {
        references.count = params.triangles;
        references.parts = params.triangles;
        references.most = params.triangles;
        references.most_parts = params.triangles;
    }
    if index < params.triangles {
        references.list[index] = Reference(index, 0u);
    }
}
