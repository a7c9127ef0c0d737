//! What a ray's traversal needs, worked out once.

pub(super) use crate::geometry::least::{greater, lesser};
use crate::geometry::{Aabb, Ray};

/// A ray that will be intersected with triangles: the shear that takes it to the z axis \[WBA13].
#[derive(Clone, Copy, Debug)]
pub(super) struct Shear {
    /// Axes in the order x, y, z of ray space; z is where the direction is largest.
    pub(super) axes: [usize; 3],
    pub(super) origin: [f32; 3],
    /// What x and y lose per unit of z.
    pub(super) shear: [f32; 2],
    pub(super) precise_shear: [f64; 2],
    /// `t` per unit of z.
    pub(super) t_per_z: f64,
}

/// By [`frame`]: the axes of ray space.
pub(super) const AXES: [[usize; 3]; 6] =
    [[1, 2, 0], [2, 0, 1], [0, 1, 2], [2, 1, 0], [0, 2, 1], [1, 0, 2]];

/// The largest axis of a direction, or three more where it goes down there: then two axes of ray space
/// change places, so that windings keep their sense.
#[inline(always)]
pub(super) fn frame(direction: &[f32; 3]) -> usize {
    let [x, y, z] = direction.map(f32::abs);
    let largest = if x > y {
        if x > z { 0 } else { 2 }
    } else if y > z {
        1
    } else {
        2
    };
    if direction[largest] < 0.0 { largest + 3 } else { largest }
}

impl Shear {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let axes = Self::axes(&ray.direction);
        let [origin, direction] =
            [ray.origin, ray.direction].map(|numbers| axes.map(|axis| numbers[axis]));
        let t_per_z = 1.0 / f64::from(direction[2]);
        let precise_shear = [f64::from(direction[0]) * t_per_z, f64::from(direction[1]) * t_per_z];
        let shear = [precise_shear[0] as f32, precise_shear[1] as f32];
        Self { axes, origin, shear, precise_shear, t_per_z }
    }

    /// The axes of ray space for a direction.
    #[inline(always)]
    pub(super) fn axes(direction: &[f32; 3]) -> [usize; 3] {
        AXES[frame(direction)]
    }
}

/// A ray that will be clipped against planes.
///
/// The planes of a box at `lower` and `upper` are passed at `t = position * inverse - offset`, a
/// little earlier by `enter` or a little later by `leave`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slabs {
    /// One over the direction; huge where the direction is zero.
    pub(super) inverse: [f32; 3],
    pub(super) enter: [f32; 3],
    pub(super) leave: [f32; 3],
    /// By axis: 1 where the ray goes down, so that the upper plane comes first.
    pub(super) backward: [usize; 3],
}

/// Rounding moves a ray, as its triangle tests and its planes see it, by less than this many half
/// ulps of the largest coordinate in play: three for translating and shearing a corner, those of
/// `t`, and three for the products and differences here.
pub(super) const THICKNESS: f32 = 20.0 * 0.5 * f32::EPSILON;

/// Directions are not let be smaller, relative to their largest component: that moves the ray by
/// less than a plane is thick, and keeps one over them finite.
pub(super) const SMALLEST: f32 = 1e-9;

impl Slabs {
    /// Planes get a thickness that covers every rounding of the triangle tests and of the planes'
    /// own `t`, so that the leaf of every hit is visited: a box is entered if the ray meets it
    /// grown by that thickness.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, reach: f32) -> Self {
        let smallest = SMALLEST * largest(&ray.direction);
        let thickness = THICKNESS * (largest(&ray.origin) + reach);
        let kept = |d: f32| if d.abs() < smallest { smallest.copysign(d) } else { d };
        let inverse = ray.direction.map(|d| 1.0 / kept(d));
        let [x, y, z] = inverse;
        let offset = [ray.origin[0] * x, ray.origin[1] * y, ray.origin[2] * z];
        let thick = inverse.map(|inverse| thickness * inverse.abs());
        Self {
            inverse,
            enter: [offset[0] + thick[0], offset[1] + thick[1], offset[2] + thick[2]],
            leave: [offset[0] - thick[0], offset[1] - thick[1], offset[2] - thick[2]],
            backward: inverse.map(|inverse| usize::from(inverse < 0.0)),
        }
    }

    /// Which way the ray goes: a bit for every axis, set where it goes down.
    #[inline(always)]
    pub(super) fn octant(&self) -> usize {
        self.backward[0] | self.backward[1] << 1 | self.backward[2] << 2
    }
}

/// The largest magnitude of a component.
#[inline(always)]
pub(super) fn largest([x, y, z]: &[f32; 3]) -> f32 {
    greater(greater(x.abs(), y.abs()), z.abs())
}

/// The largest coordinate of a box.
pub(super) fn reach(bounds: &Aabb) -> f32 {
    bounds.lower.iter().chain(&bounds.upper).fold(0.0, |largest, v| v.abs().max(largest))
}
