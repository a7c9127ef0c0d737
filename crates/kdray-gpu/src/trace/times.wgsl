// Between which times a triangle is hit, for certain.
//
// Twin: `times_avx2` of kdray's tracer, which says why. Each of its fused operations is two here,
// which the larger number of half ulps makes room for.

//#import sides

const HALF_ULPS = 0x35a00000u; // 20 half ulps of one.
const ULP = 0x34000000u;
const TINY = 0x0da24260u; // 1e-30
const HUGE = 0x7cf0bdc2u; // 1e37
const LARGE = 0x5d800000u; // 2^60: products of four such numbers and rounding errors are finite.
const TWO = 0x40000000u;
const SIX = 0x40c00000u;

struct Times {
    early: u32,
    late: u32,
}

// Keys of the times, for the triangle tested last. All times where nothing is known.
fn times() -> Times {
    let unknown = Times(0u, NONE);
    let zs = vec3u(f_key(seen[0].z), f_key(seen[1].z), f_key(seen[2].z));
    let low = f_of_key(min(min(zs.x, zs.y), zs.z));
    let high = f_of_key(max(max(zs.x, zs.y), zs.z));
    let along = max(magnitude(low), magnitude(high));
    let across = max(max(across_of(0u), across_of(1u)), across_of(2u));
    if max(along, across) >= LARGE {
        return unknown;
    }
    let size = f_add(f_mul(TWO, along), across);
    let error = f_mul(f_mul(HALF_ULPS, size), f_add(f_mul(ULP, size), across));
    let smallest = min(min(magnitude(edges.x), magnitude(edges.y)), magnitude(edges.z));
    if smallest <= max(error, TINY) {
        return unknown;
    }
    let one_over = f_div(F_ONE, f_add(f_add(edges.x, edges.y), edges.z));
    let ends = f_add(weighted(one_over, 0u), weighted(one_over, 2u));
    let t = f_mul(f_add(ends, weighted(one_over, 1u)), t_per_z);
    let share = f_mul(f_mul(SIX, error), magnitude(one_over));
    let rounding = f_mul(HALF_ULPS, max(along, TINY));
    let off_z = f_add(f_mul(share, f_sub(high, low)), rounding);
    let off = f_mul(off_z, magnitude(t_per_z));
    if max(magnitude(t), off) >= HUGE {
        return unknown;
    }
    let all = f_add(off, f_mul(HALF_ULPS, TINY));
    return Times(key_of(f_sub(t, all)), key_of(f_add(t, all)));
}

fn across_of(corner: u32) -> u32 {
    return max(magnitude(seen[corner].x), magnitude(seen[corner].y));
}

fn weighted(one_over: u32, corner: u32) -> u32 {
    return f_mul(f_mul(edges[corner], one_over), seen[corner].z);
}
