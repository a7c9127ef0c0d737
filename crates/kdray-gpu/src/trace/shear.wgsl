// The shear that takes a ray to the z axis [WBA13].
//
// Twin: `prepare.rs` of kdray's tracer. Whoever imports this has `positions` and `triangles`.

//#import cells

// Axes in the order x, y, z of ray space; z is where the direction is largest.
var<private> axes: vec3u;
var<private> origin: vec3u;
// What x and y lose per unit of z, and `t` per unit of z.
var<private> shear: vec2u;
var<private> t_per_z: u32;

fn prepare_shear() {
    let x = magnitude(ray.direction[0]);
    let y = magnitude(ray.direction[1]);
    let z = magnitude(ray.direction[2]);
    let last = select(select(2u, 1u, y > z), select(2u, 0u, x > z), x > y);
    axes = vec3u((last + 1u) % 3u, (last + 2u) % 3u, last);
    if (ray.direction[last] & F_SIGN) != 0u {
        axes = axes.yxz;
    }
    set_cell(ONE, F_ONE);
    set_cell(MINUS_ONE, F_ONE | F_SIGN);
    for (var axis = 0u; axis < 3u; axis++) {
        origin[axis] = ray.origin[axes[axis]];
        set_cell(ORIGIN + axis, origin[axis]);
        set_cell(DIRECTION + axis, ray.direction[axes[axis]]);
    }
    run_steps(0u, SLOPES_END);
    shear = vec2u(d_to_f32(cells[SHEAR]), d_to_f32(cells[SHEAR + 1u]));
    t_per_z = d_to_f32(cells[T_PER_Z]);
}

// The corner of a triangle, with its axes in the order of ray space.
fn corner_of(triangle: u32, corner: u32) -> vec3u {
    let vertex = 3u * triangles[3u * triangle + corner];
    return vec3u(positions[vertex + axes.x], positions[vertex + axes.y], positions[vertex + axes.z]);
}
