//! From the unit square to disks, hemispheres and cones.

use std::f32::consts::{FRAC_PI_4, TAU};

use glam::Vec3;

/// The unit disk, neighbours kept together [SC97].
pub(crate) fn disk([u, v]: [f32; 2]) -> [f32; 2] {
    let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0, 0.0];
    }
    let (radius, angle) = if x.abs() > y.abs() {
        (x, FRAC_PI_4 * (y / x))
    } else {
        (y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (x / y))
    };
    [radius * angle.cos(), radius * angle.sin()]
}

/// A direction around `normal` with density proportional to the cosine.
pub(crate) fn cosine_hemisphere(normal: Vec3, square: [f32; 2]) -> Vec3 {
    let [x, y] = disk(square);
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let height = (1.0 - x * x - y * y).max(0.0).sqrt();
    (x * tangent + y * bitangent + height * normal).normalize()
}

/// A direction uniformly in the cone around `axis` whose half angle has this cosine.
pub(crate) fn cone(axis: Vec3, cos_half_angle: f32, [u, v]: [f32; 2]) -> Vec3 {
    let cos = 1.0 - u * (1.0 - cos_half_angle);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (tangent, bitangent) = axis.any_orthonormal_pair();
    let (y, x) = (TAU * v).sin_cos();
    (sin * (x * tangent + y * bitangent) + cos * axis).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The centres of a fine grid over the unit square.
    fn grid() -> impl Iterator<Item = [f32; 2]> {
        let centre = |i: u32| (i as f32 + 0.5) / 64.0;
        (0..64 * 64).map(move |i| [centre(i % 64), centre(i / 64)])
    }

    #[test]
    fn the_disk_is_filled_evenly() {
        let inner = grid().filter(|square| {
            let [x, y] = disk(*square);
            assert!(x * x + y * y <= 1.0 + 1e-6);
            x * x + y * y < 0.25
        });
        assert!((inner.count() as f32 / 4096.0 - 0.25).abs() < 0.01);
    }

    #[test]
    fn the_mean_cosine_of_the_hemisphere_is_two_thirds() {
        let normal = Vec3::new(1.0, -2.0, 0.5).normalize();
        let sum: f32 = grid().map(|square| cosine_hemisphere(normal, square).dot(normal)).sum();
        assert!((sum / 4096.0 - 2.0 / 3.0).abs() < 2e-3, "{sum}");
    }

    #[test]
    fn cones_keep_to_their_angle() {
        let axis = Vec3::new(0.3, 0.9, -0.2).normalize();
        let inside = |square| cone(axis, 0.9, square).dot(axis) >= 0.9 - 1e-5;
        assert!(grid().all(inside));
    }
}
