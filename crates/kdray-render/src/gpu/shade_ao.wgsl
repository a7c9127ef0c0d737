// Ambient occlusion: a feeler into the surroundings [ZIK98]. Twin: `ao.rs`.

@group(0) @binding(1) var<storage> points: array<Point>;
@group(0) @binding(2) var<storage, read_write> paths: array<Path>;
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> shadow_rays: array<Ray>;
@group(0) @binding(5) var<storage, read_write> shadows: array<vec4u>;

const OPEN = 0.86f;
const BACKDROP = 0.5f;

@compute @workgroup_size(256)
fn shade_ao(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = number(group, groups, local);
    if index >= params.bound {
        return;
    }
    let point = points[index];
    var path = seen(point, vec3f(BACKDROP));
    path.albedo = vec3f(1.0);
    paths[point.path] = path;
    if path.has_surface == 0u {
        return;
    }
    let direction = cosine_hemisphere(point.shading, sample_of(point.path, 1u));
    var feeler = leave(point, direction);
    feeler.t_max = params.reach;
    if ground_distance(feeler) < 0.0 {
        let place = take_place(params.counters.y);
        shadow_rays[place] = feeler;
        shadows[place] = vec4u(bitcast<vec3u>(vec3f(OPEN)), point.path);
    }
}
