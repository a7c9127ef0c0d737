//! What a hit is: the watertight ray-triangle test \[WBA13], with ties decided.
//!
//! Corners are translated and sheared so that the ray is the z axis; then the signs of three edge
//! functions say whether the axis passes between them. Two triangles that share an edge compute
//! the same function for it with opposite signs, and rounding cannot change a sign: a product is
//! rounded monotonically, so the difference of two products is right or zero. Zeros are computed
//! again in double precision, where products are exact.
//!
//! What is still zero then lies exactly under the ray. Such ties are decided as if the ray stood
//! an infinitesimal step to the side, the same step for all triangles: so a ray through a
//! shared edge or vertex of a closed mesh hits exactly as many triangles as its neighbour does.
//! Triangles seen edge-on are never hit.
//!
//! Where a triangle is hit is then worked out in double precision, so that `t` is right on slivers
//! too. A ray that passes an edge on the outside by a rounding hits the edge.

use super::prepare::Shear;
use crate::geometry::{Hit, Ray};

/// The hit of `ray` with one triangle, whose index it will carry.
///
/// The definition of a hit: every query gives what this function gives for some triangle.
#[must_use]
pub fn intersect(ray: &Ray, triangle: u32, corners: &[[f32; 3]; 3]) -> Option<Hit> {
    if !ray.is_valid() {
        return None;
    }
    let Crossing { t, u, v } = crossing(Shear::new(ray), corners)?;
    (ray.t_min <= t && t <= ray.t_max).then_some(Hit { t, triangle, u, v })
}

/// Where a triangle is crossed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
}

/// Where the line of the ray crosses the triangle, at any `t`.
#[inline]
pub(super) fn crossing(shear: Shear, corners: &[[f32; 3]; 3]) -> Option<Crossing> {
    let [a, b, c] = [shear.point(&corners[0]), shear.point(&corners[1]), shear.point(&corners[2])];
    let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
    let crossed = if (u == 0.0) | (v == 0.0) | (w == 0.0) {
        is_crossed_in_tie([a, b, c])
    } else {
        let positive = (u > 0.0) & (v > 0.0) & (w > 0.0);
        let negative = (u < 0.0) & (v < 0.0) & (w < 0.0);
        positive | negative
    };
    if crossed { Some(locate(shear, corners)) } else { None }
}

impl Shear {
    /// A corner in the plane across the ray, which passes through its zero.
    #[inline(always)]
    fn point(&self, corner: &[f32; 3]) -> [f32; 2] {
        let x = corner[self.axes[0]] - self.origin[0];
        let y = corner[self.axes[1]] - self.origin[1];
        let z = corner[self.axes[2]] - self.origin[2];
        [x - self.shear[0] * z, y - self.shear[1] * z]
    }

    /// The same in double precision, and how far along the ray's largest axis the corner is.
    #[inline(always)]
    fn precise_point(&self, corner: &[f32; 3]) -> ([f64; 2], f64) {
        let along = |axis: usize| f64::from(corner[self.axes[axis]]) - f64::from(self.origin[axis]);
        let (x, y, z) = (along(0), along(1), along(2));
        ([x - self.precise_shear[0] * z, y - self.precise_shear[1] * z], z)
    }
}

#[inline(always)]
fn edge(p: [f32; 2], q: [f32; 2]) -> f32 {
    p[0] * q[1] - p[1] * q[0]
}

#[inline(always)]
fn precise_edge(p: [f64; 2], q: [f64; 2]) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

/// Where a triangle that is crossed is crossed.
#[inline]
pub(super) fn locate(shear: Shear, corners: &[[f32; 3]; 3]) -> Crossing {
    let (a, az) = shear.precise_point(&corners[0]);
    let (b, bz) = shear.precise_point(&corners[1]);
    let (c, cz) = shear.precise_point(&corners[2]);
    let [u, v, w] = [precise_edge(c, b), precise_edge(a, c), precise_edge(b, a)];
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let sum = u + v + w;
    let (v, w) =
        if inside && sum != 0.0 { (v / sum, w / sum) } else { nearest_on_outline([a, b, c]) };
    let z = az + (v * (bz - az) + w * (cz - az));
    Crossing { t: (z * shear.t_per_z) as f32, u: v as f32, v: w as f32 }
}

/// Weights of the second and third corner at the point of the outline nearest to the ray.
#[cold]
fn nearest_on_outline([a, b, c]: [[f64; 2]; 3]) -> (f64, f64) {
    let nearest = |p: [f64; 2], q: [f64; 2]| {
        let along = [q[0] - p[0], q[1] - p[1]];
        let length = along[0] * along[0] + along[1] * along[1];
        let s = -(p[0] * along[0] + p[1] * along[1]) / length;
        let s = if s.is_nan() { 0.0 } else { s.clamp(0.0, 1.0) };
        let point = [p[0] + s * along[0], p[1] + s * along[1]];
        (point[0] * point[0] + point[1] * point[1], s)
    };
    let (ab, bc, ca) = (nearest(a, b), nearest(b, c), nearest(c, a));
    if ab.0 <= bc.0 && ab.0 <= ca.0 {
        (ab.1, 0.0)
    } else if bc.0 <= ca.0 {
        (1.0 - bc.1, bc.1)
    } else {
        (0.0, 1.0 - ca.1)
    }
}

/// Whether a triangle is crossed of which at least one edge function is zero in single precision.
#[cold]
fn is_crossed_in_tie([a, b, c]: [[f32; 2]; 3]) -> bool {
    let sides = [side(c, b), side(a, c), side(b, a)];
    sides == [Some(true); 3] || sides == [Some(false); 3]
}

/// Whether the ray is on the positive side of the edge, or would be an infinitesimal step
/// `(e, e²)` to the side; `None` for an edge that is a point.
fn side(p: [f32; 2], q: [f32; 2]) -> Option<bool> {
    // The products are exact, so the sign is.
    let edge = precise_edge(p.map(f64::from), q.map(f64::from));
    if edge != 0.0 {
        return Some(edge > 0.0);
    }
    // (p - s) x (q - s) with s = (e, e²) is e (p.y - q.y) + e² (q.x - p.x).
    if p[1] != q[1] {
        return Some(p[1] > q[1]);
    }
    (p[0] != q[0]).then_some(q[0] > p[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    #[test]
    fn a_hit_has_barycentric_coordinates() {
        let ray = Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -4.0]);
        assert_eq!(
            intersect(&ray, 3, &CORNERS),
            Some(Hit { t: 0.5, triangle: 3, u: 0.25, v: 0.5 })
        );
    }

    #[test]
    fn both_sides_are_hit() {
        let ray = Ray::new([0.25, 0.5, -2.0], [0.0, 0.0, 4.0]);
        assert_eq!(
            intersect(&ray, 0, &CORNERS).map(|hit| (hit.t, hit.u, hit.v)),
            Some((0.5, 0.25, 0.5))
        );
    }

    #[test]
    fn hits_outside_the_interval_do_not_count() {
        let ray = Ray { t_min: 0.6, ..Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -4.0]) };
        assert_eq!(intersect(&ray, 0, &CORNERS), None);
        let ray = Ray { t_max: 0.4, ..Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -4.0]) };
        assert_eq!(intersect(&ray, 0, &CORNERS), None);
    }

    /// A fan around the origin: rays at its hub and along its spokes hit it exactly once.
    #[test]
    fn shared_edges_and_vertices_are_hit_once() {
        let hub = [0.0, 0.0, 0.0];
        let rim = [
            [1.0, 0.0, 0.1],
            [0.5, 1.0, 0.0],
            [-1.0, 0.5, 0.2],
            [-0.5, -1.0, 0.0],
            [1.0, -1.0, -0.1],
        ];
        let fan: Vec<_> = (0..5).map(|i| [hub, rim[i], rim[(i + 1) % 5]]).collect();
        let targets = rim.map(|[x, y, _]| [0.5 * x, 0.5 * y]).into_iter().chain([[0.0, 0.0]]);
        for [x, y] in targets {
            for z in [1.0, -1.0] {
                let ray = Ray::new([x, y, 3.0 * z], [0.0, 0.0, -z]);
                let hits =
                    fan.iter().filter(|corners| intersect(&ray, 0, corners).is_some()).count();
                assert_eq!(hits, 1, "at {x} {y} from {z}");
            }
        }
    }

    #[test]
    fn slivers_have_precise_distances() {
        let sliver = [[-100.0, 0.0, 3.0], [88.0, 0.1, 40.0], [-100.0, 0.7, 3.0]];
        for x in [-99.0, -50.0, 0.0, 30.0] {
            let ray = Ray::new([x, 0.1, -7.0], [0.001, 0.001, 1.0]);
            let hit = intersect(&ray, 0, &sliver).expect("the sliver is there");
            // Along the sliver only x and z change: z = 3 + 37 (x + 100) / 188.
            let (slope, x) = (37.0 / 188.0, f64::from(x));
            let t = (3.0 + slope * (x + 100.0) + 7.0) / (1.0 - slope * f64::from(0.001_f32));
            assert!((f64::from(hit.t) / t - 1.0).abs() < 1e-6, "{} {t}", hit.t);
        }
    }

    #[test]
    fn rays_without_meaning_hit_nothing() {
        for direction in [[0.0; 3], [f32::NAN; 3], [f32::INFINITY, 0.0, 0.0]] {
            assert_eq!(intersect(&Ray::new([0.25, 0.5, 2.0], direction), 0, &CORNERS), None);
        }
    }
}
