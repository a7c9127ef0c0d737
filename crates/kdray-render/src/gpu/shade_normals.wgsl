// Surface directions as colours. Twin: `normals.rs`.

@group(0) @binding(1) var<storage> points: array<Point>;
@group(0) @binding(2) var<storage, read_write> paths: array<Path>;

const BACKGROUND = 0.05f;

@compute @workgroup_size(256)
fn shade_normals(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = number(group, groups, local);
    if index >= params.bound {
        return;
    }
    let point = points[index];
    var path = seen(point, vec3f(BACKGROUND));
    if path.has_surface == 1u {
        path.background = 0.5 * point.shading + 0.5;
        path.has_surface = 0u;
    }
    paths[point.path] = path;
}
