// The surface that each ray meets first. Twin: `Scene::point` in `scene.rs`.

@group(0) @binding(1) var<storage> rays: array<Ray>;
@group(0) @binding(2) var<storage> ids: array<u32>;
@group(0) @binding(3) var<storage> hits: array<vec4u>;
@group(0) @binding(4) var<storage> positions: array<f32>;
@group(0) @binding(5) var<storage> triangles: array<u32>;
@group(0) @binding(6) var<storage> normals: array<u32>; // Two components a word.
@group(0) @binding(7) var<storage> palette: array<u32>;
@group(0) @binding(8) var<storage, read_write> points: array<Point>;

@compute @workgroup_size(256)
fn surface(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = number(group, groups, local);
    if index >= params.bound {
        return;
    }
    var ray = rays[index];
    let hit = hits[index];
    let is_hit = hit.y != NONE;
    ray.t_max = select(ray.t_max, bitcast<f32>(hit.x), is_hit);
    let t = ground_distance(ray);
    var point = Point();
    if t >= 0.0 {
        point = ground_point(ray, t);
    } else if is_hit {
        point = mesh_point(ray, hit);
    }
    point.kind = select(0u, SURFACE, t >= 0.0 || is_hit) | select(0u, TRIANGLE, is_hit);
    point.path = ids[index];
    points[index] = point;
}

fn ground_point(ray: Ray, t: f32) -> Point {
    let at = ground_position(ray, t);
    let up = params.vertical;
    let error = largest(abs(at)) * ROUNDING;
    return Point(at, error, up, ground_haze(at), up, 0u, params.ground_colour, 0u);
}

fn mesh_point(ray: Ray, hit: vec4u) -> Point {
    let triangle = hit.y;
    let a = corner(triangle, 0u);
    let b = corner(triangle, 1u);
    let c = corner(triangle, 2u);
    let flat_normal = normal_of(b - a, c - a);
    let side = select(1.0, -1.0, dot(flat_normal, ray.direction) > 0.0);
    let na = side * corner_normal(triangle, 0u);
    let nb = side * corner_normal(triangle, 1u);
    let nc = side * corner_normal(triangle, 2u);
    let v = vec2f(bitcast<f32>(hit.z), bitcast<f32>(hit.w));
    let weights = vec3f(1.0 - v.x - v.y, v);
    let at = weights.x * a + weights.y * b + weights.z * c;
    let bulge = above(at - a, weights.x, na) + above(at - b, weights.y, nb) + above(at - c, weights.z, nc);
    let has_area = dot(flat_normal, flat_normal) > 0.0;
    let geometric = select(-unit(ray.direction), side * flat_normal, has_area);
    let shading = unit_or(weights.x * na + weights.y * nb + weights.z * nc, geometric);
    let error = max(max(largest(abs(a)), largest(abs(b))), largest(abs(c))) * ROUNDING;
    return Point(at + bulge, error, geometric, 0.0, shading, 0u, colour(triangle), 0u);
}

// What interpolating corners of size one, or intersecting a ray with them, can lose.
const ROUNDING = 9.5367431640625e-7;

fn largest(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z);
}

fn corner(triangle: u32, index: u32) -> vec3f {
    let first = 3u * triangles[3u * triangle + index];
    return vec3f(positions[first], positions[first + 1u], positions[first + 2u]);
}

// The unit normal of a triangle by two of its sides, or zero for one without area.
fn normal_of(first: vec3f, second: vec3f) -> vec3f {
    let size = largest(max(abs(first), abs(second)));
    if size == 0.0 {
        return vec3f(0.0);
    }
    return unit_or(cross(first / size, second / size), vec3f(0.0));
}

fn corner_normal(triangle: u32, index: u32) -> vec3f {
    let first = 9u * triangle + 3u * index;
    return vec3f(component(first), component(first + 1u), component(first + 2u)) / 32767.0;
}

fn component(index: u32) -> f32 {
    let word = normals[index / 2u];
    return f32(bitcast<i32>(word << (16u * (1u - index % 2u))) >> 16u);
}

// How far the tangent plane of a corner lies above a point of the triangle.
fn above(offset: vec3f, weight: f32, normal: vec3f) -> vec3f {
    return weight * -min(dot(offset, normal), 0.0) * normal;
}

fn colour(triangle: u32) -> vec3f {
    var part = 0u;
    if params.has_parts == 1u {
        part = palette[triangle];
    }
    let first = params.colours + 3u * part;
    return bitcast<vec3f>(vec3u(palette[first], palette[first + 1u], palette[first + 2u]));
}
