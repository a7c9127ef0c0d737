// Path tracing: sun and sky, reflected by matt surfaces [Kaj86]. Twin: `path.rs`.

@group(0) @binding(1) var<storage> rays: array<Ray>;
@group(0) @binding(2) var<storage> points: array<Point>;
@group(0) @binding(3) var<storage, read_write> paths: array<Path>;
@group(0) @binding(4) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> shadow_rays: array<Ray>;
@group(0) @binding(6) var<storage, read_write> shadows: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> next_rays: array<Ray>;
@group(0) @binding(8) var<storage, read_write> next_ids: array<u32>;

@compute @workgroup_size(256)
fn shade_path(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = number(group, groups, local);
    if index >= live_count() {
        return;
    }
    let point = points[index];
    let direction = rays[index].direction;
    if params.bounce == 0u {
        paths[point.path] = seen(point, backdrop(direction));
    } else {
        arrive(point, direction);
    }
    if (point.kind & SURFACE) != 0u {
        look_at_sun(point);
        bounce(point);
    }
}

// What a path becomes that was reflected before.
fn arrive(point: Point, direction: vec3f) {
    let path = point.path;
    paths[path].rays += 1u;
    paths[path].hits += u32((point.kind & TRIANGLE) != 0u);
    if (point.kind & SURFACE) != 0u {
        paths[path].throughput *= point.albedo;
    } else {
        paths[path].light += paths[path].throughput * radiance(direction);
    }
}

// Asks whether the sun is seen from the point.
fn look_at_sun(point: Point) {
    if params.has_sun == 0u {
        return;
    }
    let square = sample_of(point.path, 1u + 2u * params.bounce);
    let direction = cone(params.sun, params.sun_cos, square);
    let visible = visibility(point, direction);
    let ray = leave(point, direction);
    if visible > 0.0 && ground_distance(ray) < 0.0 {
        let strength = visible * dot(point.shading, direction) * params.strength;
        let light = paths[point.path].throughput * strength;
        let place = take_place(params.counters.y);
        shadow_rays[place] = ray;
        shadows[place] = vec4u(bitcast<vec3u>(light), point.path);
    }
}

// Reflects the path.
fn bounce(point: Point) {
    let square = sample_of(point.path, 2u + 2u * params.bounce);
    let place = take_place(params.counters.x);
    next_rays[place] = leave(point, cosine_hemisphere(point.shading, square));
    next_ids[place] = point.path;
}
