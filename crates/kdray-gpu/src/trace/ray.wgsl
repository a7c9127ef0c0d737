// A ray, and what its traversal needs, worked out once.
//
// Twin: `prepare.rs` of kdray's tracer. Whoever imports this has the parameters, `rays` and `except`.
// Times are held as keys, integers that compare like them; both zeros have one.

//#import float

const WORKGROUP = 256u;
const NONE = 0xffffffffu;

const F_ONE = 0x3f800000u;
const F_MAX = 0x7f7fffffu;
const LONGEST = 0x6258d727u; // 1e21
const SHORTEST = 0x1c971da0u; // 1e-21
const SMALLEST = 0x3089705fu; // 1e-9
const THICKNESS = 0x35a00000u; // 20 half ulps of one
const OPEN_EXPONENTS = 378u; // Of two numbers whose product may be 2^124, as they are stored.

struct Params {
    count: u32,
    has_except: u32,
    is_counted: u32,
    reach: u32, // The largest coordinate of the scene.
    lower: vec3u,
    unused: u32,
    upper: vec3u,
    steps: array<vec4u, 14>,
}

struct Ray {
    origin: array<u32, 3>,
    t_min: u32,
    direction: array<u32, 3>,
    t_max: u32,
}

struct Slab {
    inverse: u32,
    enter: u32,
    leave: u32,
    is_open: bool, // Its times would leave the range of floats: planes say nothing.
}

// By axis, where planes are passed.
var<private> slabs: array<Slab, 3>;

// Keys of the interval that was asked for.
var<private> t_first: u32;
var<private> t_last: u32;

// Of the ray that `load` brought.
var<private> ray: Ray;
var<private> left_out: u32;

fn key_of(t: u32) -> u32 {
    return f_key(select(t, 0u, (t << 1u) == 0u));
}

fn magnitude(x: u32) -> u32 {
    return x & 0x7fffffffu;
}

// Number of an invocation, row of workgroups after row.
fn invocation(group: vec3u, groups: vec3u, local: u32) -> u32 {
    return (group.y * groups.x + group.x) * WORKGROUP + local;
}

// Brings a ray. Gives whether it can hit anything at all.
fn load(index: u32) -> bool {
    ray = rays[index];
    left_out = NONE;
    if params.has_except == 1u {
        left_out = except[index];
    }
    t_first = key_of(ray.t_min);
    t_last = key_of(ray.t_max);
    let is_ordered = max(magnitude(ray.t_min), magnitude(ray.t_max)) <= F_INFINITY && t_first <= t_last;
    let longest = largest(ray.direction);
    let is_finite = largest(ray.origin) <= F_MAX && longest <= LONGEST && longest >= SHORTEST;
    return is_ordered && is_finite;
}

fn largest(v: array<u32, 3>) -> u32 {
    return max(max(magnitude(v[0]), magnitude(v[1])), magnitude(v[2]));
}

// What the ray needs to be clipped against planes.
fn prepare_slabs() {
    let smallest = f_mul(SMALLEST, largest(ray.direction));
    let reach = f_add(largest(ray.origin), params.reach);
    let thickness = f_mul(THICKNESS, reach);
    for (var axis = 0u; axis < 3u; axis++) {
        let d = ray.direction[axis];
        let kept = select(d, smallest | (d & F_SIGN), magnitude(d) < smallest);
        let inverse = f_div(F_ONE, kept);
        let is_open = (magnitude(inverse) >> 23u) + (reach >> 23u) >= OPEN_EXPONENTS;
        slabs[axis] = Slab(inverse, 0u, 0u, is_open);
        if !is_open {
            let offset = f_mul(ray.origin[axis], inverse);
            let thick = f_mul(thickness, magnitude(inverse));
            slabs[axis].enter = f_add(offset, thick);
            slabs[axis].leave = f_sub(offset, thick);
        }
    }
}

// Between which times the ray may pass a plane.
fn passing(axis: u32, position: u32) -> vec2u {
    let slab = slabs[axis];
    if slab.is_open {
        return vec2u(0u, NONE);
    }
    let product = f_mul(position, slab.inverse);
    return vec2u(key_of(f_sub(product, slab.enter)), key_of(f_sub(product, slab.leave)));
}
