//! Which triangles a ray may hit, or which rays a triangle, many at once.

use super::eights::by_axis;
use super::sifted::{Sifted, Wants};
use super::vector::{Mask, Vector};

/// A corner in ray space, with the arithmetic of [`Shear`](super::prepare::Shear).
#[inline(always)]
pub(super) fn sheared<V: Vector>([x, y, z]: [V; 3], origin: &[V; 3], slope: &[V; 2]) -> [V; 3] {
    let (x, y, z) = (x - origin[0], y - origin[1], z - origin[2]);
    [x - slope[0] * z, y - slope[1] * z, z]
}

#[inline(always)]
fn edge<V: Vector>(p: [V; 3], q: [V; 3]) -> V {
    p[0] * q[1] - p[1] * q[0]
}

/// The lanes whose edge functions do not differ in sign, with the arithmetic of
/// [`crossing`](super::intersect::crossing), but for those that are hit before or after the interval
/// for certain. Corners are in ray space.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) fn sift<V: Vector>(corners: &[[V; 3]; 3], t_per_z: V, interval: [V; 2]) -> Sifted {
    let crossed = crossed(corners);
    if crossed.maybe.bits() == 0 {
        return Sifted { maybe: 0, surely: 0, inside: 0 };
    }
    crossed_between(corners, &crossed, t_per_z, interval)
}

/// The triangles of a block that may be hit in the interval, if there are any. Corners are in ray space.
///
/// A line that crosses a triangle often does so behind the ray, most of all where the ray starts on a
/// surface. Where it might, or where to know whether there is a hit is enough, bounds of `t` are asked: they
/// are there sooner than a hit. Elsewhere it takes less to find the hits.
#[inline(always)]
pub(super) fn filtered<V: Vector>(
    corners: &[[V; 3]; 3],
    t_per_z: V,
    interval: [V; 2],
    wants: Wants,
) -> Option<Sifted> {
    let crossed = crossed(corners);
    let maybe = crossed.maybe.bits();
    if maybe == 0 {
        return None;
    }
    if wants != Wants::Whether {
        let [a, b, c] = by_axis!(|corner| corners[corner][2] * t_per_z);
        let behind = a.min(b).min(c).is_less(interval[0]);
        if behind.bits() & maybe == 0 {
            return Some(Sifted { maybe, surely: crossed.surely.bits(), inside: 0 });
        }
    }
    let sifted = crossed_between(corners, &crossed, t_per_z, interval);
    (sifted.maybe != 0).then_some(sifted)
}

/// What the edge functions of triangles tell.
pub(super) struct Crossed<V: Vector> {
    edges: [V; 3],
    /// Where they do not differ in sign.
    pub(super) maybe: V::Mask,
    /// Those of them where none is zero.
    pub(super) surely: V::Mask,
}

/// Corners are in ray space.
#[inline(always)]
pub(super) fn crossed<V: Vector>(corners: &[[V; 3]; 3]) -> Crossed<V> {
    let [a, b, c] = *corners;
    let edges = [edge(c, b), edge(a, c), edge(b, a)];
    let lowest = edges[0].min(edges[1]).min(edges[2]);
    let highest = edges[0].max(edges[1]).max(edges[2]);
    let zero = lowest.all(0.0);
    let maybe = zero.is_at_most(lowest).or(highest.is_at_most(zero));
    let surely = zero.is_less(lowest).or(highest.is_less(zero));
    Crossed { edges, maybe, surely }
}

/// What [`sift`] gives, of triangles some of which may be crossed.
#[inline(always)]
fn crossed_between<V: Vector>(
    corners: &[[V; 3]; 3],
    crossed: &Crossed<V>,
    t_per_z: V,
    [t_min, t_max]: [V; 2],
) -> Sifted {
    let Crossed { maybe, surely, .. } = *crossed;
    let (early, late) = times(corners, crossed, t_per_z);
    let outside = late.is_less(t_min).or(t_max.is_less(early));
    let inside = t_min.is_at_most(early).and(late.is_at_most(t_max)).and(surely);
    let maybe = maybe.and_not(outside).bits();
    Sifted { maybe, surely: surely.bits(), inside: inside.bits() & maybe }
}

/// Between which `t` the line of a ray crosses triangles, given their corners in ray space and their edge
/// functions, which do not differ in sign; from minus to plus infinity where rounding may have moved it across
/// an edge. Of other triangles nothing is said.
///
/// With `u` half an ulp of one, a corner `p` is off across the ray by at most `u (2 |p| + 5.7 |z|)`, where the
/// largest part is that of the rounded slope; so an edge function is off by at most `6 u S`, and the three
/// together by `12 u S`, with `S` the sum of the squares of all coordinates. Where each is larger than `e = 32 u
/// S`, all have the signs that [`locate`](super::intersect::locate) finds.
///
/// The weights of corners are edge functions over their sum `d`, so together they are off by at most `24 u S /
/// d`, and `t` by half of that times its range over the corners: at most `e / d` times the range is said. By
/// themselves the `t` of corners are off by `3 u R`, with `R` the largest of them. The differences, the products,
/// the sums, the quotient, which may have few digits, and their roundings, that of a hit's `t` among them, add
/// less than `22 u R`, as no range is larger than `2 R`; that the range is off adds `u R`. At least `32 u R` is
/// said. `S` and the result are so large that no error comes from numbers too small for their precision.
///
/// The sum of weighted differences is less than `S` times the range: where it is too large for a number, so is
/// that product, and with it the error, and nothing is said. So that product is made first.
#[inline(always)]
fn times<V: Vector>(corners: &[[V; 3]; 3], crossed: &Crossed<V>, t_per_z: V) -> (V, V) {
    const SHARE: f32 = 32.0 * 0.5 * f32::EPSILON;
    const TINY: f32 = 1e-18;
    const SHORT: f32 = 1e-20;
    let all = |number: f32| t_per_z.all(number);
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = *corners;
    let [a, b, c] = [az * t_per_z, bz * t_per_z, cz * t_per_z];
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let size = ax.fused(ax, bx.fused(bx, cx.fused(cx, all(TINY))))
        + ay.fused(ay, by.fused(by, cy * cy))
        + az.fused(az, bz.fused(bz, cz * cz));
    let [u, v, w] = crossed.edges.map(V::magnitude);
    let known = (size * all(SHARE)).is_less(u.min(v).min(w));
    let one_over = all(1.0) / (u + v + w);
    let t = (b - a).fused(v, (c - a) * w).fused(one_over, a);
    let reach = low.magnitude().max(high.magnitude());
    let off = (size * (high - low)).fused(one_over, reach).fused(all(SHARE), all(SHORT));
    let early = V::pick(known, t - off, all(f32::NEG_INFINITY));
    let late = V::pick(known, t + off, all(f32::INFINITY));
    (early, late)
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::trace::intersect::crossing;
    use crate::trace::noise::noise;
    use crate::trace::prepare::Shear;
    use crate::trace::simd::Best;
    use crate::trace::vector::{Arithmetic, Eight, MOST, Numbers};

    /// A triangle, a sliver now and then, and a ray towards it: both of sizes up to ten to this power, and as
    /// small, and as far from each other.
    fn triangle_and_ray(power: f32, state: &mut u32) -> ([[f32; 3]; 3], Ray) {
        let mut any_size = || 10.0_f32.powf(power * (2.0 * noise(state) - 1.0));
        let (size, distance, length) = (any_size(), any_size(), any_size() * any_size());
        let mut point = |size: f32| [(); 3].map(|()| size * (noise(state) - 0.5));
        let [a, b, mut c] = [point(size), point(size), point(size)];
        let (origin, beside) = (point(distance), point(size));
        let [s, r, q] = [noise(state), noise(state), noise(state)];
        if q < 0.3 {
            let off = 10.0_f32.powf(-6.0 * q / 0.3);
            c = [0, 1, 2].map(|at| a[at] + s * (b[at] - a[at]) + off * c[at]);
        }
        let direction = [0, 1, 2].map(|at| {
            let target = a[at] + s * (b[at] - a[at]) + (1.0 - s) * r * (c[at] - a[at]);
            length * (if q < 0.9 { target } else { beside[at] } - origin[at])
        });
        ([a, b, c], Ray::new(origin, direction))
    }

    /// The edge functions of a triangle, and between which `t` it is crossed.
    fn crossed_and_times(
        zero: Eight,
        shear: &Shear,
        triangle: &[[f32; 3]; 3],
    ) -> (Crossed<Eight>, [f32; 2]) {
        let origin = shear.origin.map(|number| zero.all(number));
        let slope = shear.shear.map(|number| zero.all(number));
        let corners = triangle
            .map(|corner| sheared(shear.axes.map(|axis| zero.all(corner[axis])), &origin, &slope));
        let crossed = crossed(&corners);
        let (early, late) = times(&corners, &crossed, zero.all(shear.t_per_z as f32));
        (crossed, [early, late].map(|t| t.numbers().0[0]))
    }

    /// What is said of triangles and rays of all sizes is true, and most of the time something is.
    #[test]
    fn hits_are_between_their_bounds() {
        let Some(proof) = Best::detect().avx2() else {
            return println!("this processor has no AVX2");
        };
        let zero = Eight::of_numbers(proof, &Numbers([0.0; MOST]));
        let mut state = 5;
        for power in [0.0, 1.0, 3.0, 6.0, 12.0] {
            let [mut hits, mut narrow] = [0, 0];
            for _ in 0..200_000 {
                let (triangle, ray) = triangle_and_ray(power, &mut state);
                if !ray.is_valid() {
                    continue;
                }
                let shear = Shear::new(&ray);
                let (crossed, [early, late]) = crossed_and_times(zero, &shear, &triangle);
                if crossed.maybe.bits() == 0 {
                    continue;
                }
                let Some(hit) = crossing(shear, &triangle) else {
                    assert!(early == f32::NEG_INFINITY || early.is_nan(), "{triangle:?} {ray:?}");
                    continue;
                };
                hits += 1;
                narrow += u32::from(late - early < 1e-3 * hit.t.abs());
                let is_outside = hit.t < early || late < hit.t;
                assert!(!is_outside, "{triangle:?} {ray:?} {early} {} {late}", hit.t);
            }
            assert!(hits > 50_000 && 2 * narrow > hits, "{narrow} of {hits} up to 1e{power}");
        }
    }
}
