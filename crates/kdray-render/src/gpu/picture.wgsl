// What the kernels of a picture are told, and what they tell each other.

const WORKGROUP = 256u;
const NONE = 0xffffffffu;

struct Params {
    bound: u32, // Most elements that the kernel works on.
    at: u32, // Which counter says how many there are; NONE if all of `bound` are.
    width: u32,
    height: u32,
    samples: u32, // Of a pixel.
    sample_bits: u32,
    first_pixel: u32, // Of the wave.
    first_sample: u32,
    samples_here: u32, // Of a pixel in the wave.
    film_pixel: u32, // The first pixel in the part of the film.
    bounce: u32,
    bounces: u32,
    counters: vec4u, // Which ones get the numbers of bounces and of shadow rays.
    eye: vec3f,
    reach: f32, // How far ambient occlusion looks.
    right: vec3f,
    has_ground: u32,
    up: vec3f,
    ground_height: f32,
    forward: vec3f,
    ground_radius: f32,
    ground_center: vec3f,
    has_sun: u32,
    ground_colour: vec3f,
    has_parts: u32, // Whether triangles have colours of their own.
    vertical: vec3f, // Up in the world.
    colours: u32, // Where colours begin, behind which one each triangle has.
    zenith: vec3f,
    sun_cos: f32, // Of its radius.
    horizon: vec3f,
    unused: u32,
    below: vec3f,
    unused_too: u32,
    sun: vec3f,
    unused_either: u32,
    strength: vec3f,
}

struct Ray {
    origin: vec3f,
    t_min: f32,
    direction: vec3f,
    t_max: f32,
}

// What a ray met. Bits of `kind`: a surface; a triangle, perhaps below the ground.
struct Point {
    position: vec3f, // On the smooth surface.
    error: f32, // How wrong it can be along each axis.
    geometric: vec3f, // Normal of the triangle, on the viewer's side.
    haze: f32,
    shading: vec3f, // Normal of the smooth surface.
    kind: u32,
    albedo: vec3f,
    path: u32,
}

const SURFACE = 1u;
const TRIANGLE = 2u;

// One sample on its way: what its camera ray sees, and the light that falls there so far.
struct Path {
    background: vec3f,
    haze: f32,
    position: vec3f,
    has_surface: u32,
    normal: vec3f,
    rays: u32,
    albedo: vec3f,
    hits: u32,
    light: vec3f,
    unused: u32,
    throughput: vec3f,
    unused_too: u32,
}

@group(0) @binding(0) var<uniform> params: Params;

// Number of an invocation, row of workgroups after row.
fn number(group: vec3u, groups: vec3u, local: u32) -> u32 {
    return (group.y * groups.x + group.x) * WORKGROUP + local;
}

// Which pixel a path of the wave belongs to, counted from the top left.
fn pixel_of(path: u32) -> u32 {
    return params.first_pixel + path / params.samples_here;
}
