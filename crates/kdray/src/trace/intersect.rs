//! What a hit is: the watertight ray-triangle test [WBA13], with ties decided.
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
    let Crossing { t, u, v } = crossing(&Shear::new(ray), corners)?;
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
#[inline(always)]
pub(super) fn crossing(shear: &Shear, corners: &[[f32; 3]; 3]) -> Option<Crossing> {
    let a = shear.point(&corners[0]);
    let b = shear.point(&corners[1]);
    let c = shear.point(&corners[2]);
    let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
    if (u == 0.0) | (v == 0.0) | (w == 0.0) {
        return tied_crossing([a, b, c]);
    }
    let positive = (u > 0.0) & (v > 0.0) & (w > 0.0);
    let negative = (u < 0.0) & (v < 0.0) & (w < 0.0);
    if !(positive | negative) {
        return None;
    }
    let determinant = u + v + w;
    let height = (u * a[2] + v * b[2]) + w * c[2];
    Some(Crossing { t: height / determinant, u: v / determinant, v: w / determinant })
}

impl Shear {
    /// A corner in ray space; its z is in units of `t`.
    #[inline(always)]
    fn point(&self, corner: &[f32; 3]) -> [f32; 3] {
        let x = corner[self.axes[0]] - self.origin[0];
        let y = corner[self.axes[1]] - self.origin[1];
        let z = corner[self.axes[2]] - self.origin[2];
        [x - self.shear[0] * z, y - self.shear[1] * z, self.t_per_z * z]
    }
}

#[inline(always)]
fn edge(p: [f32; 3], q: [f32; 3]) -> f32 {
    p[0] * q[1] - p[1] * q[0]
}

/// The crossing of a triangle of which at least one edge function is zero in single precision.
#[cold]
fn tied_crossing([a, b, c]: [[f32; 3]; 3]) -> Option<Crossing> {
    let edges = [exact_edge(c, b), exact_edge(a, c), exact_edge(b, a)];
    let sides = [side(edges[0], c, b)?, side(edges[1], a, c)?, side(edges[2], b, a)?];
    if sides != [sides[0]; 3] {
        return None;
    }
    let [u, v, w] = edges;
    let determinant = u + v + w;
    if determinant == 0.0 {
        return None;
    }
    let height = (u * f64::from(a[2]) + v * f64::from(b[2])) + w * f64::from(c[2]);
    let share = |value: f64| (value / determinant) as f32;
    Some(Crossing { t: share(height), u: share(v), v: share(w) })
}

/// An edge function whose sign is exact: its products are.
fn exact_edge(p: [f32; 3], q: [f32; 3]) -> f64 {
    f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])
}

/// Whether the axis is on the positive side of the edge, or would be an infinitesimal step
/// `(e, e²)` to the side; `None` for an edge that is a point.
fn side(edge: f64, p: [f32; 3], q: [f32; 3]) -> Option<bool> {
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
    fn rays_without_meaning_hit_nothing() {
        for direction in [[0.0; 3], [f32::NAN; 3], [f32::INFINITY, 0.0, 0.0]] {
            assert_eq!(intersect(&Ray::new([0.25, 0.5, 2.0], direction), 0, &CORNERS), None);
        }
    }
}
