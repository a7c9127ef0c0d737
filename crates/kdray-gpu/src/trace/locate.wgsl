// Where each ray hits its triangle.

//#import point

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> rays: array<Ray>;
@group(0) @binding(2) var<storage> except: array<u32>;
@group(0) @binding(3) var<storage> positions: array<u32>;
@group(0) @binding(4) var<storage> triangles: array<u32>;
@group(0) @binding(5) var<storage> closest_triangles: array<u32>;
@group(0) @binding(6) var<storage, read_write> hits: array<vec4u>;

@compute @workgroup_size(256)
fn locate(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let triangle = closest_triangles[index];
    hits[index] = vec4u(0u, NONE, 0u, 0u);
    if triangle != NONE && load(index) {
        prepare_shear();
        let crossing = locate_crossing(triangle);
        hits[index] = vec4u(crossing.t, triangle, crossing.u, crossing.v);
    }
}
