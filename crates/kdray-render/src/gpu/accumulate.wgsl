// The samples of each pixel in the wave are added to the film. Twin: `Sums::add` in `pixel.rs`.

@group(0) @binding(1) var<storage> paths: array<Path>;
@group(0) @binding(2) var<storage, read_write> film: array<u32>; // CELL words a pixel.

const CELL = 25u;
const LIGHT = 0u;
const COVERED = 3u;
const IRRADIANCE = 4u;
const SQUARES = 7u;
const POSITION = 8u;
const NORMAL = 11u;
const ALBEDO = 14u;
const FIRST_POSITION = 17u;
const FIRST_NORMAL = 20u;
const RAYS = 23u;
const HITS = 24u;

@compute @workgroup_size(256)
fn accumulate(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = number(group, groups, local);
    if index >= params.bound {
        return;
    }
    let cell = CELL * (params.film_pixel + index);
    for (var sample = 0u; sample < params.samples_here; sample++) {
        let path = paths[index * params.samples_here + sample];
        film[cell + RAYS] += path.rays;
        film[cell + HITS] += path.hits;
        let is_seen = path.has_surface == 1u;
        let reflected = mix(path.albedo * path.light, path.background, path.haze);
        let light = select(path.background, reflected, is_seen);
        add(cell + LIGHT, light / f32(params.samples));
        if is_seen {
            add_surface(cell, path, light);
        }
    }
}

// Adds what is seen, if it is of the pixel's first surface.
fn add_surface(cell: u32, path: Path, light: vec3f) {
    let covered = bitcast<f32>(film[cell + COVERED]);
    if covered == 0.0 {
        add(cell + FIRST_POSITION, path.position);
        add(cell + FIRST_NORMAL, path.normal);
    } else {
        let way = path.position - three(cell + FIRST_POSITION);
        let normal = three(cell + FIRST_NORMAL);
        if dot(normal, path.normal) <= 0.8 || abs(dot(way, normal)) > 0.5 * length(way) {
            return;
        }
    }
    let irradiance = light / max(path.albedo, vec3f(1e-3));
    let luminance = dot(irradiance, vec3f(0.2126, 0.7152, 0.0722));
    let squares = bitcast<f32>(film[cell + SQUARES]) + luminance * luminance;
    film[cell + COVERED] = bitcast<u32>(covered + 1.0);
    film[cell + SQUARES] = bitcast<u32>(squares);
    add(cell + IRRADIANCE, irradiance);
    add(cell + POSITION, path.position);
    add(cell + NORMAL, path.normal);
    add(cell + ALBEDO, path.albedo);
}

fn three(at: u32) -> vec3f {
    return bitcast<vec3f>(vec3u(film[at], film[at + 1u], film[at + 2u]));
}

fn add(at: u32, more: vec3f) {
    let sum = bitcast<vec3u>(three(at) + more);
    film[at] = sum.x;
    film[at + 1u] = sum.y;
    film[at + 2u] = sum.z;
}
