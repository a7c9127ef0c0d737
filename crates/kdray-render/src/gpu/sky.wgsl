// Where the light comes from. Twin: `sky.rs`.

// Light that comes in against `direction`, the sun's left out.
fn radiance(direction: vec3f) -> vec3f {
    let height = dot(direction, params.vertical);
    if height >= 0.0 {
        let below = max(1.0 - height, 0.0);
        return mix(params.horizon, params.zenith, 1.0 - below * below * below);
    }
    return mix(params.horizon, params.below, min(-6.0 * height, 1.0));
}

// What is behind everything: the sky, which ends at the horizon.
fn backdrop(direction: vec3f) -> vec3f {
    let height = dot(direction, params.vertical);
    return radiance(direction - min(height, 0.0) * params.vertical);
}
