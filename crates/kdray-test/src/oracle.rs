//! Queries answered by trying every triangle.

use kdray::trace::intersect;
use kdray::{Aabb, Hit, Mesh, Ray};

/// Every hit of the ray, by triangle.
pub fn hits<'a>(mesh: &'a Mesh, ray: &'a Ray) -> impl Iterator<Item = Hit> + 'a {
    (0..mesh.triangles().len())
        .filter_map(|triangle| intersect(ray, triangle as u32, &mesh.triangle(triangle)))
}

/// The hit with the lowest `t`; of several the one of the lowest triangle.
#[must_use]
pub fn closest_hit(mesh: &Mesh, ray: &Ray) -> Option<Hit> {
    hits(mesh, ray).reduce(|best, hit| if hit.t < best.t { hit } else { best })
}

/// Whether there is any hit.
#[must_use]
pub fn any_hit(mesh: &Mesh, ray: &Ray) -> bool {
    hits(mesh, ray).next().is_some()
}

/// All hits in order of `t`, then of the triangle.
#[must_use]
pub fn all_hits(mesh: &Mesh, ray: &Ray) -> Vec<Hit> {
    let mut all: Vec<Hit> = hits(mesh, ray).collect();
    all.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
    all
}

type Vector = [f64; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Squared distance of a point from a segment.
fn squared_from_segment(point: Vector, a: Vector, b: Vector) -> f64 {
    let (along, from) = (minus(b, a), minus(point, a));
    let length = dot(along, along);
    let share = if length > 0.0 { (dot(along, from) / length).clamp(0.0, 1.0) } else { 0.0 };
    let away = minus(from, along.map(|v| v * share));
    dot(away, away)
}

/// Squared distance of a point from a triangle: from its plane if the foot is inside, else from
/// its edges.
#[must_use]
pub fn squared_distance(point: [f32; 3], corners: &[[f32; 3]; 3]) -> f64 {
    let wide = |v: [f32; 3]| v.map(f64::from);
    let (point, [a, b, c]) = (wide(point), corners.map(wide));
    let normal = cross(minus(b, a), minus(c, a));
    let length = dot(normal, normal);
    let inward = |p: Vector, q: Vector| dot(cross(normal, minus(q, p)), minus(point, p)) >= 0.0;
    let edges = [(a, b), (b, c), (c, a)];
    let edges = edges.into_iter().map(|(p, q)| squared_from_segment(point, p, q));
    let nearest = edges.fold(f64::INFINITY, f64::min);
    if length > 0.0 && inward(a, b) && inward(b, c) && inward(c, a) {
        let height = dot(normal, minus(point, a));
        return nearest.min(height * height / length);
    }
    nearest
}

/// Squared distance of a point from the mesh.
#[must_use]
pub fn closest_distance(mesh: &Mesh, point: [f32; 3]) -> Option<f64> {
    let distance = |triangle| squared_distance(point, &mesh.triangle(triangle));
    (0..mesh.triangles().len()).map(distance).reduce(f64::min)
}

/// Whether a triangle and a box meet, if that does not hang on roundings: a box a little smaller
/// or larger gives the same answer.
#[must_use]
pub fn clearly_overlaps(corners: &[[f32; 3]; 3], region: &Aabb) -> Option<bool> {
    let coordinates = corners.as_flattened().iter().chain(&region.lower).chain(&region.upper);
    let reach = coordinates.fold(0.0_f64, |reach, v| reach.max(f64::from(v.abs())));
    let meets = |margin: f64| {
        let mut polygon: Vec<Vector> = corners.iter().map(|v| v.map(f64::from)).collect();
        for axis in 0..3 {
            let (lower, upper) = (f64::from(region.lower[axis]), f64::from(region.upper[axis]));
            polygon = cut(&polygon, axis, |v| v - (lower - margin));
            polygon = cut(&polygon, axis, |v| upper + margin - v);
        }
        !polygon.is_empty()
    };
    let (smaller, larger) = (meets(-1e-9 * reach), meets(1e-9 * reach));
    (smaller == larger).then_some(smaller)
}

/// The part of a polygon where `inside` is not negative along an axis.
fn cut(polygon: &[Vector], axis: usize, inside: impl Fn(f64) -> f64) -> Vec<Vector> {
    let mut kept = Vec::new();
    for (index, corner) in polygon.iter().enumerate() {
        let next = polygon[(index + 1) % polygon.len()];
        let (here, there) = (inside(corner[axis]), inside(next[axis]));
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here >= 0.0) != (there >= 0.0) {
            let share = here / (here - there);
            kept.push([0, 1, 2].map(|other| corner[other] + share * (next[other] - corner[other])));
        }
    }
    kept
}

/// How often the mesh winds around a point: the solid angles of its triangles over the sphere's.
#[must_use]
pub fn winding_number(mesh: &Mesh, point: [f32; 3]) -> f64 {
    let point = point.map(f64::from);
    let angle = |triangle: usize| {
        let [a, b, c] = mesh.triangle(triangle).map(|v| minus(v.map(f64::from), point));
        let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
        let volume = dot(a, cross(b, c));
        let flat = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        2.0 * volume.atan2(flat)
    };
    (0..mesh.triangles().len()).map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}
