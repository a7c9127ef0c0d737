//! Where rays cross triangles, one or many at once.

use super::vector::{Mask, Precise};

/// Where lines cross triangles, a lane each.
pub(super) struct Located<P> {
    /// The lanes of which this is known, a bit each.
    pub(super) known: u32,
    pub(super) t: P,
    pub(super) u: P,
    pub(super) v: P,
}

/// A corner in ray space, in double precision.
#[inline(always)]
pub(super) fn precisely_sheared<P: Precise>([x, y, z]: [P; 3], slope: &[P; 2]) -> [P; 3] {
    [x - slope[0] * z, y - slope[1] * z, z]
}

/// [`locate`](super::intersect::locate) in all lanes, with the same arithmetic but for the last rounding,
/// and but where the line passes an edge on the outside by a rounding. Corners are in ray space.
#[inline(always)]
pub(super) fn located<P: Precise>([a, b, c]: [[P; 3]; 3], t_per_z: P) -> Located<P> {
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    let (lowest, highest) = (u.min(v).min(w), u.max(v).max(w));
    let (sum, zero) = (u + v + w, u.all(0.0));
    // Of these none is inside whose sum is zero.
    let positive = zero.is_at_most(lowest).and(zero.is_less(sum));
    let negative = highest.is_at_most(zero).and(sum.is_less(zero));
    let (v, w) = (v / sum, w / sum);
    let z = a[2] + (v * (b[2] - a[2]) + w * (c[2] - a[2]));
    Located { known: positive.or(negative).bits(), t: z * t_per_z, u: v, v: w }
}

#[inline(always)]
fn edge<P: Precise>(p: [P; 3], q: [P; 3]) -> P {
    p[0] * q[1] - p[1] * q[0]
}
