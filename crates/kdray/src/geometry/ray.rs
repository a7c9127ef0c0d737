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
        let within = |v: &[f32; 3], most: f32| {
            (v[0].abs() <= most) & (v[1].abs() <= most) & (v[2].abs() <= most)
        };
        let [x, y, z] = self.direction.map(f32::abs);
        within(&self.origin, f32::MAX)
            & within(&self.direction, 1e21)
            & ((x >= 1e-21) | (y >= 1e-21) | (z >= 1e-21))
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
