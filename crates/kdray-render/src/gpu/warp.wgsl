// From the unit square to hemispheres and cones. Twin: `warp.rs`.
//
// Sines and cosines are worked out here: what a device offers may be wrong in the fourth digit.

const PI = 3.14159265359;

// Cosine and sine of an angle of at most an eighth of a turn.
fn cos_sin(angle: f32) -> vec2f {
    let x = angle * angle;
    let cosine = 1.0 - x / 2.0 * (1.0 - x / 12.0 * (1.0 - x / 30.0 * (1.0 - x / 56.0)));
    let sine = angle * (1.0 - x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0))));
    return vec2f(cosine, sine);
}

// The unit disk, neighbours kept together [SC97].
fn disk(square: vec2f) -> vec2f {
    let p = 2.0 * square - 1.0;
    if p.x == 0.0 && p.y == 0.0 {
        return vec2f(0.0);
    }
    if abs(p.x) > abs(p.y) {
        return p.x * cos_sin(PI / 4.0 * (p.y / p.x));
    }
    return p.y * cos_sin(PI / 4.0 * (p.x / p.y)).yx;
}

// A direction around `normal` with density proportional to the cosine.
fn cosine_hemisphere(normal: vec3f, square: vec2f) -> vec3f {
    let p = disk(square);
    let height = sqrt(max(1.0 - p.x * p.x - p.y * p.y, 0.0));
    return unit(across(normal, p) + height * normal);
}

// A direction uniformly in the cone around `axis` whose half angle has this cosine.
fn cone(axis: vec3f, cos_half_angle: f32, square: vec2f) -> vec3f {
    let cosine = 1.0 - square.x * (1.0 - cos_half_angle);
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    let quarter = floor(4.0 * square.y + 0.5);
    var around = cos_sin(PI / 2.0 * (4.0 * square.y - quarter));
    let turns = u32(quarter);
    around = select(around, vec2f(-around.y, around.x), (turns & 1u) != 0u);
    around = select(around, -around, (turns & 2u) != 0u);
    return unit(sine * across(axis, around) + cosine * axis);
}

// A point of the plane through zero that a unit vector is normal to.
fn across(normal: vec3f, point: vec2f) -> vec3f {
    let is_down = (bitcast<u32>(normal.z) >> 31u) != 0u;
    let s = select(1.0, -1.0, is_down);
    let a = -1.0 / (s + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = vec3f(1.0 + s * normal.x * normal.x * a, s * b, -s * normal.x);
    let bitangent = vec3f(b, s + normal.y * normal.y * a, -normal.y);
    return point.x * tangent + point.y * bitangent;
}

fn unit(v: vec3f) -> vec3f {
    return v * (1.0 / sqrt(dot(v, v)));
}

// The same, or another vector where a direction is not to be had.
fn unit_or(v: vec3f, other: vec3f) -> vec3f {
    let square = dot(v, v);
    return select(other, v * (1.0 / sqrt(square)), square > 0.0);
}
