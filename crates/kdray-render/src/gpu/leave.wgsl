// How rays leave a point on a surface. Twin: `point.rs`.

// Whatever is beyond all meshes.
const FAR = 3.4028234e38;

// The least float that every device has.
const LEAST = 1.1754944e-38;

// A ray that starts outside the surface and leaves it in (about) `direction`.
fn leave(point: Point, direction: vec3f) -> Ray {
    let inward = min(dot(point.geometric, direction), 0.0);
    return Ray(lifted(point), 0.0, direction - 2.0 * inward * point.geometric, FAR);
}

// How much of the light from `direction` a smooth surface lets pass to its flat triangle [CLB19].
fn visibility(point: Point, direction: vec3f) -> f32 {
    let flat_cosine = dot(point.geometric, direction);
    let smooth_cosine = dot(point.shading, direction);
    if flat_cosine <= 0.0 || smooth_cosine <= 0.0 {
        return 0.0;
    }
    let along = dot(point.geometric, point.shading);
    let x = clamp(flat_cosine / (smooth_cosine * along), 0.0, 1.0);
    return x * (1.0 + x - x * x);
}

// The position, moved along the normal until rounding cannot have left it inside.
fn lifted(point: Point) -> vec3f {
    let normal = point.geometric;
    let lift = point.error * (abs(normal.x) + abs(normal.y) + abs(normal.z));
    let moved = point.position + lift * normal;
    return vec3f(
        next_along(moved.x, normal.x),
        next_along(moved.y, normal.y),
        next_along(moved.z, normal.z),
    );
}

// The float after `x` in a direction.
fn next_along(x: f32, direction: f32) -> f32 {
    if direction == 0.0 {
        return x;
    }
    let bits = bitcast<u32>(x);
    let is_away = (bits >> 31u == 1u) == (direction < 0.0);
    if (bits << 1u) == 0u {
        return select(LEAST, -LEAST, direction < 0.0);
    }
    return bitcast<f32>(select(bits - 1u, bits + 1u, is_away));
}
