//! A point on a surface, and how rays leave it.

use glam::Vec3;
use kdray::Ray;

/// A point on a surface, its normals on the viewer's side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    /// Where it is on the smooth surface.
    pub(crate) position: Vec3,
    /// How wrong the position can be along each axis, and a hit on the same triangle along a ray.
    pub(crate) error: f32,
    /// Normal of the triangle.
    pub(crate) geometric: Vec3,
    /// Normal of the smooth surface.
    pub(crate) shading: Vec3,
    /// Colour: the part of the light that is reflected.
    pub(crate) albedo: Vec3,
    /// How far it has faded into the distance, in 0..=1.
    pub(crate) haze: f32,
}

impl Point {
    /// A ray that starts outside the surface and leaves it in (about) `direction`.
    ///
    /// Smooth normals allow directions that point into the flat triangle: those are mirrored.
    pub(crate) fn leave(&self, direction: Vec3) -> Ray {
        let inward = self.geometric.dot(direction).min(0.0);
        let outward = direction - 2.0 * inward * self.geometric;
        Ray::new(self.lifted().to_array(), outward.to_array())
    }

    /// How much of the light from `direction` a smooth surface lets pass to its flat triangle, in
    /// 0..=1. It fades out before the triangle turns away, so that shadows end softly and not
    /// triangle by triangle [CLB19].
    pub(crate) fn visibility(&self, direction: Vec3) -> f32 {
        let [flat, smooth] = [self.geometric, self.shading].map(|normal| normal.dot(direction));
        if flat <= 0.0 || smooth <= 0.0 {
            return 0.0;
        }
        let x = (flat / (smooth * self.geometric.dot(self.shading))).clamp(0.0, 1.0);
        x * (1.0 + x - x * x)
    }

    /// The position, moved along the normal until rounding cannot have left it inside.
    fn lifted(&self) -> Vec3 {
        let lift = self.error * self.geometric.abs().element_sum();
        let moved = self.position + lift * self.geometric;
        let next = |axis: usize| match self.geometric[axis] {
            normal if normal > 0.0 => moved[axis].next_up(),
            normal if normal < 0.0 => moved[axis].next_down(),
            _ => moved[axis],
        };
        Vec3::new(next(0), next(1), next(2))
    }
}

/// What interpolating corners of this size, or intersecting a ray with them, can lose: a few roundings
/// of 2^-24 each, doubled. Intersection mixes the axes, so the largest coordinate counts for all.
pub(crate) fn rounding_error(corners: &[Vec3; 3]) -> f32 {
    let [a, b, c] = corners.map(|corner| corner.abs().max_element());
    a.max(b).max(c) * (16.0 * 0.5 * f32::EPSILON)
}

/// The smooth surface above a point of a flat triangle: where the tangent planes of its corners
/// put it. Rays from there do not see the facets of their own neighbourhood [Han21].
pub(crate) fn smooth_position(
    flat: Vec3,
    weights: [f32; 3],
    corners: &[Vec3; 3],
    normals: &[Vec3; 3],
) -> Vec3 {
    let above = |corner: usize| {
        let depth = (flat - corners[corner]).dot(normals[corner]).min(0.0);
        weights[corner] * -depth * normals[corner]
    };
    flat + above(0) + above(1) + above(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(position: Vec3, geometric: Vec3) -> Point {
        let error = rounding_error(&[position; 3]);
        Point { position, error, geometric, shading: geometric, albedo: Vec3::ONE, haze: 0.0 }
    }

    #[test]
    fn rays_start_outside_and_barely() {
        for scale in [1e-20, 1.0, 1e15] {
            let position = scale * Vec3::new(0.1, -3.0, 7.0);
            let normal = Vec3::new(1.0, 2.0, -2.0) / 3.0;
            let start = Vec3::from(point(position, normal).leave(normal).origin);
            let lift = (start - position).dot(normal);
            assert!(lift > 0.0 && lift < 2e-5 * scale, "{scale}: {lift}");
        }
    }

    #[test]
    fn rays_start_above_a_floor_at_height_zero() {
        let error = rounding_error(&[Vec3::new(5.0, 0.0, 5.0); 3]);
        let floor = Point { error, ..point(Vec3::new(5.0, 0.0, 5.0), Vec3::Y) };
        assert!(floor.leave(Vec3::Y).origin[1] > 1e-6);
    }

    #[test]
    fn no_ray_leaves_into_its_own_triangle() {
        let ray = point(Vec3::ONE, Vec3::Y).leave(Vec3::new(0.6, -0.8, 0.0));
        assert_eq!(ray.direction, [0.6, 0.8, 0.0]);
    }

    #[test]
    fn light_fades_where_the_triangle_turns_away() {
        let flat = point(Vec3::ONE, Vec3::Y);
        assert_eq!(flat.visibility(Vec3::new(0.6, 0.8, 0.0)), 1.0);
        let tilted = Point { shading: Vec3::new(0.6, 0.8, 0.0), ..flat };
        let at =
            |height: f32| tilted.visibility(Vec3::new((1.0 - height * height).sqrt(), height, 0.0));
        assert!(at(-0.1) == 0.0 && at(0.01) < 0.05 && at(0.1) < at(0.2) && at(0.9) == 1.0);
    }

    #[test]
    fn the_smooth_surface_bulges_over_a_facet_of_a_sphere() {
        let corners = [Vec3::X, Vec3::Y, Vec3::Z];
        let centre = Vec3::splat(1.0 / 3.0);
        let bulged = smooth_position(centre, [1.0 / 3.0; 3], &corners, &corners);
        assert!(bulged.length() > centre.length() && bulged.length() < 1.2);
    }
}
