//! Which triangles a ray may hit, or which rays a triangle, many at once.

use super::sifted::{Filtered, Sifted, Wants};
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
    crossed_between(corners, &crossed, t_per_z, interval).sifted()
}

/// What the edge functions of triangles tell.
pub(super) struct Crossed<V: Vector> {
    edges: [V; 3],
    /// The lowest and the highest edge function.
    ends: [V; 2],
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
    Crossed { edges, ends: [lowest, highest], maybe, surely }
}

/// What bounds of `t` tell of triangles.
pub(super) struct Between<V: Vector> {
    /// Those that may be crossed in the interval.
    maybe: V::Mask,
    /// Those whose line crosses for certain, wherever.
    surely: V::Mask,
    /// Those that are crossed in the interval for certain.
    inside: V::Mask,
    /// Between which `t` each is crossed.
    early: V,
    late: V,
}

/// What [`sift`] gives, of triangles some of which may be crossed.
#[inline(always)]
pub(super) fn crossed_between<V: Vector>(
    corners: &[[V; 3]; 3],
    crossed: &Crossed<V>,
    t_per_z: V,
    [t_min, t_max]: [V; 2],
) -> Between<V> {
    let Crossed { maybe, surely, .. } = *crossed;
    let (early, late) = times(corners, crossed, t_per_z);
    let outside = late.is_less(t_min).or(t_max.is_less(early));
    let inside = t_min.is_at_most(early).and(late.is_at_most(t_max)).and(surely);
    Between { maybe: maybe.and_not(outside), surely, inside, early, late }
}

impl<V: Vector> Between<V> {
    #[inline(always)]
    pub(super) fn sifted(&self) -> Sifted {
        let maybe = self.maybe.bits();
        Sifted { maybe, surely: self.surely.bits(), inside: self.inside.bits() & maybe }
    }

    /// What a visitor wants of them, if there are any.
    #[inline(always)]
    pub(super) fn filtered(&self, wants: Wants) -> Option<Filtered> {
        let sifted = self.sifted();
        if sifted.maybe == 0 {
            return None;
        }
        let is_one = sifted.maybe & (sifted.maybe - 1) == 0;
        if wants != Wants::First || is_one {
            return Some(Filtered::all(sifted));
        }
        Some(self.first(sifted))
    }

    /// Those apart that are behind another.
    #[inline(always)]
    fn first(&self, sifted: Sifted) -> Filtered {
        let late = V::pick(self.maybe, self.late, self.late.all(f32::INFINITY)).least();
        let later = self.early.all(late).is_less(self.early).bits() & sifted.maybe;
        Filtered { sifted: Sifted { maybe: sifted.maybe & !later, ..sifted }, later, late }
    }
}

/// Between which `t` the line of a ray crosses triangles, given their corners in ray space and
/// their edge functions; from minus to plus infinity where rounding may have moved it across an edge.
///
/// With `u` half an ulp of one, `m` the largest x or y and `z` the largest z of the corners, corners
/// are off by at most `u (2 m + 6 z)` and, with `s = m + 2 z`, edge functions by less than
/// `e = 16 u s (m + 2 u s)`. Where all of them are larger than that, so are those that
/// [`locate`](super::intersect::locate) works out, or they have the same signs at least; the weights of the corners, which
/// are edge functions over their sum `d`, are together off by at most `12 e / d`, which moves the
/// crossing by as much of half the range of z. So nothing is said where one is not larger than `6 e`, nor
/// where numbers come near to the ends of their range, where errors are not relative.
#[inline(always)]
fn times<V: Vector>(corners: &[[V; 3]; 3], crossed: &Crossed<V>, t_per_z: V) -> (V, V) {
    const HALF_ULP: f32 = 0.5 * f32::EPSILON;
    const TINY: f32 = 1e-30;
    const HUGE: f32 = 1e37;
    let zero = t_per_z.all(0.0);
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = *corners;
    let across = ax.magnitude().max(bx.magnitude()).max(cx.magnitude());
    let across = across.max(ay.magnitude()).max(by.magnitude()).max(cy.magnitude());
    let (low, high) = (az.min(bz).min(cz), az.max(bz).max(cz));
    let along = high.max(zero - low);
    let size = t_per_z.all(2.0).fused(along, across);
    let error =
        t_per_z.all(6.0 * 16.0 * HALF_ULP) * size * t_per_z.all(2.0 * HALF_ULP).fused(size, across);
    let Crossed { edges: [u, v, w], ends: [lowest, highest], .. } = *crossed;
    let one_over = t_per_z.all(1.0) / (u + v + w);
    let z = (u * one_over).fused(az, (v * one_over).fused(bz, w * one_over * cz));
    let off = error * one_over.magnitude() * (high - low);
    let off = t_per_z.all(16.0 * HALF_ULP).fused(along.max(t_per_z.all(TINY)), off);
    let off = off.fused(t_per_z.magnitude(), t_per_z.all(16.0 * HALF_ULP * TINY));
    let t = z * t_per_z;
    // Less than zero where they differ in sign.
    let smallest = lowest.max(zero - highest);
    let known = error
        .max(t_per_z.all(TINY))
        .is_less(smallest)
        .and(t.magnitude().is_less(t_per_z.all(HUGE)));
    let early = V::pick(known, t - off, t_per_z.all(f32::NEG_INFINITY));
    let late = V::pick(known, t + off, t_per_z.all(f32::INFINITY));
    (early, late)
}
