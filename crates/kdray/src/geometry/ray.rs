//! Rays and what they hit.

/// A ray `origin + t * direction` with `t` in `t_min..=t_max`.
///
/// The direction need not have unit length: `t` is in units of its length. Coordinates are those
/// of the mesh ([`Frame::local_ray`](super::Frame::local_ray) makes them from world coordinates).
/// A ray hits nothing if it is not finite, or if the largest component of its direction is not in
/// 1e-21..=1e21: beyond that `t` would leave the range of f32.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Ray {
    /// Where `t` is zero.
    pub origin: [f32; 3],
    /// Smallest `t` that counts.
    pub t_min: f32,
    /// The step of one unit of `t`.
    pub direction: [f32; 3],
    /// Largest `t` that counts; may be infinite.
    pub t_max: f32,
}

/// Between these is the largest component of a direction.
pub(crate) const LEAST: f32 = 1e-21;
pub(crate) const MOST: f32 = 1e21;

impl Ray {
    /// The half-line from `origin` on: `t` from zero to infinity.
    #[must_use]
    pub const fn new(origin: [f32; 3], direction: [f32; 3]) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f32::INFINITY }
    }

    /// The point at `t`.
    #[must_use]
    pub fn at(&self, t: f32) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.origin[axis] + t * self.direction[axis])
    }

    /// Whether the ray can hit anything at all.
    #[inline]
    pub(crate) fn is_valid(&self) -> bool {
        // Magnitudes are in the order of their bits, and what is not a number is beyond all of them.
        let magnitude = |v: f32| v.abs().to_bits();
        let largest = |[x, y, z]: [f32; 3]| magnitude(x).max(magnitude(y)).max(magnitude(z));
        (largest(self.origin) <= f32::MAX.to_bits())
            & (LEAST.to_bits()..=MOST.to_bits()).contains(&largest(self.direction))
            & (self.t_min <= self.t_max)
    }
}

/// A crossing of a ray with a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Hit {
    /// Distance along the ray, in units of its direction's length.
    pub t: f32,
    /// Index of the triangle in the mesh.
    pub triangle: u32,
    /// Weight of the second vertex: `P = (1 - u - v) v0 + u v1 + v v2`.
    pub u: f32,
    /// Weight of the third vertex.
    pub v: f32,
}
