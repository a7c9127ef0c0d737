//! Where a mesh stands in the world.

use super::Ray;

/// Maps between world coordinates (f64) and the local f32 coordinates of a mesh:
/// `world = origin + scale * local`.
///
/// Ordinary data has the identity frame. Geometry far from the origin gets an `origin` near
/// itself, so that f32 spends its bits on the shape and not on the distance; geometry whose size
/// would overflow or underflow f32 areas gets a `scale`, a power of two, so that scaling is exact.
/// `t` along a ray is the same in both spaces, because origin and direction are scaled together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// World position of the local zero.
    pub origin: [f64; 3],
    /// World length of one local unit: a power of two.
    pub scale: f64,
}

/// Sizes within this power of two of one need no scale: the areas of their smallest parts,
/// 24 bits down on two axes, are still normal f32 numbers.
const COMFORTABLE_EXPONENT: i32 = 32;

impl Frame {
    /// World and local coordinates are the same.
    pub const IDENTITY: Self = Self { origin: [0.0; 3], scale: 1.0 };

    /// The frame for geometry inside `lower..upper`.
    ///
    /// An axis keeps its zero unless the box is further from it than four times its extent, so
    /// that data whose distance does not matter keeps its very bits.
    #[must_use]
    pub(super) fn around(lower: [f64; 3], upper: [f64; 3]) -> Self {
        let mut origin = [0.0; 3];
        let mut size: f64 = 0.0;
        for axis in 0..3 {
            // Halves first: the sum of two large numbers may overflow.
            let center = 0.5 * lower[axis] + 0.5 * upper[axis];
            let half_extent = 0.5 * upper[axis] - 0.5 * lower[axis];
            if center.abs() > 8.0 * half_extent {
                origin[axis] = center;
            }
            let reach = |value: f64| (value - origin[axis]).abs();
            size = size.max(reach(lower[axis])).max(reach(upper[axis]));
        }
        Self { origin, scale: scale_for(size) }
    }

    /// Local coordinates of a world point, rounded to f32.
    #[must_use]
    pub fn local_point(&self, world: [f64; 3]) -> [f32; 3] {
        // Adding zero turns -0 into +0, so that equal coordinates have equal bits.
        [0, 1, 2].map(|axis| ((world[axis] - self.origin[axis]) / self.scale) as f32 + 0.0)
    }

    /// World coordinates of a local point.
    #[must_use]
    pub fn world_point(&self, local: [f32; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.origin[axis] + self.scale * f64::from(local[axis]))
    }

    /// The ray in local coordinates; `t` keeps its meaning.
    ///
    /// ```
    /// use kdray::Mesh;
    ///
    /// let corner = 4.5e6;
    /// let far = [[corner, 0.0, 0.0], [corner + 1.0, 0.0, 0.0], [corner, 1.0, 0.0]];
    /// let mesh = Mesh::from_f64(&far, &[[0, 1, 2]]).unwrap();
    /// let ray = mesh.frame().local_ray([corner + 0.25, 0.25, 2.0], [0.0, 0.0, -1.0], 0.0, f32::INFINITY);
    /// assert!(ray.origin[0].abs() < 1.0);
    /// ```
    #[must_use]
    pub fn local_ray(&self, origin: [f64; 3], direction: [f64; 3], t_min: f32, t_max: f32) -> Ray {
        let direction = direction.map(|component| (component / self.scale) as f32);
        Ray { origin: self.local_point(origin), direction, t_min, t_max }
    }
}

/// The power of two that brings `size` near one, or 1 where f32 is comfortable as it is.
fn scale_for(size: f64) -> f64 {
    if size == 0.0 || !size.is_normal() {
        return 1.0;
    }
    let exponent = ((size.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    if exponent.abs() <= COMFORTABLE_EXPONENT {
        return 1.0;
    }
    f64::from_bits(((exponent.clamp(-1000, 1000) + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinary_boxes_keep_their_bits() {
        assert_eq!(Frame::around([-1.0; 3], [2.0; 3]), Frame::IDENTITY);
        assert_eq!(Frame::around([0.5; 3], [0.75; 3]), Frame::IDENTITY);
    }

    #[test]
    fn far_boxes_are_brought_near() {
        let frame = Frame::around([1e6, -1.0, 4e6], [1e6 + 2.0, 1.0, 4e6 + 1.0]);
        assert_eq!(frame.origin, [1e6 + 1.0, 0.0, 4e6 + 0.5]);
        assert_eq!(frame.scale, 1.0);
    }

    #[test]
    fn huge_and_tiny_boxes_are_scaled_by_a_power_of_two() {
        for size in [1e-30, 1e-12, 1e12, 1e30, 1e300] {
            let frame = Frame::around([-size; 3], [size; 3]);
            let local = frame.local_point([size; 3]);
            assert!((1.0..2.0).contains(&local[0]), "{size}: {local:?}");
            assert_eq!(frame.scale.to_bits() << 12, 0, "a power of two");
        }
    }
}
