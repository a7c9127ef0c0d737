// The camera ray of each path. Twin: `View::sample` in `film.rs`.

@group(0) @binding(1) var<storage, read_write> rays: array<Ray>;
@group(0) @binding(2) var<storage, read_write> ids: array<u32>;

@compute @workgroup_size(256)
fn camera(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let path = number(group, groups, local);
    if path >= params.bound {
        return;
    }
    let pixel = pixel_of(path);
    let within = sample_of(path, 0u);
    let x = 2.0 * (f32(pixel % params.width) + within.x) / f32(params.width) - 1.0;
    let y = 1.0 - 2.0 * (f32(pixel / params.width) + within.y) / f32(params.height);
    let direction = unit(params.forward + x * params.right + y * params.up);
    rays[path] = Ray(params.eye, 0.0, direction, FAR);
    ids[path] = path;
}
