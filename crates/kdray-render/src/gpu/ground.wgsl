// What the mesh stands on. Twin: `ground.rs`.

// Where the ray comes down on the ground, or less than nothing.
fn ground_distance(ray: Ray) -> f32 {
    let descent = -dot(ray.direction, params.vertical);
    let above = dot(ray.origin, params.vertical) - params.ground_height;
    let t = above / descent;
    let is_met = params.has_ground == 1u && descent > 0.0 && above >= 0.0 && t <= ray.t_max;
    return select(-1.0, t, is_met);
}

// The point on the ground along the ray.
fn ground_position(ray: Ray, t: f32) -> vec3f {
    let point = ray.origin + t * ray.direction;
    return point + (params.ground_height - dot(point, params.vertical)) * params.vertical;
}

// How far a point has faded into the distance: 0 near the mesh, 1 at the horizon.
fn ground_haze(point: vec3f) -> f32 {
    let offset = point - params.ground_center;
    let away = length(offset - dot(offset, params.vertical) * params.vertical);
    let x = clamp((away / params.ground_radius - 1.5) / 8.5, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}
