//! What a ray's traversal needs, worked out once.

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

impl Shear {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let [x, y, z] = ray.direction.map(f32::abs);
        let largest = if x > y {
            if x > z { 0 } else { 2 }
        } else if y > z {
            1
        } else {
            2
        };
        let direction = ray.direction;
        // Two axes change places where the ray looks down, so that windings keep their sense.
        let next = [1, 2, 0][largest];
        let last = [2, 0, 1][largest];
        let axes =
            if direction[largest] < 0.0 { [last, next, largest] } else { [next, last, largest] };
        let origin = [ray.origin[axes[0]], ray.origin[axes[1]], ray.origin[axes[2]]];
        let t_per_z = 1.0 / f64::from(direction[axes[2]]);
        let precise_shear =
            [f64::from(direction[axes[0]]) * t_per_z, f64::from(direction[axes[1]]) * t_per_z];
        let shear = [precise_shear[0] as f32, precise_shear[1] as f32];
        Self { axes, origin, shear, precise_shear, t_per_z }
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
const THICKNESS: f32 = 20.0 * 0.5 * f32::EPSILON;

/// Directions are not let be smaller, relative to their largest component: that moves the ray by
/// less than a plane is thick, and keeps one over them finite.
const SMALLEST: f32 = 1e-9;

impl Slabs {
    /// Planes get a thickness that covers every rounding of the triangle tests and of the planes'
    /// own `t`, so that the leaf of every hit is visited: a box is entered if the ray meets it
    /// grown by that thickness.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, reach: f32) -> Self {
        let magnitude = |v: &[f32; 3]| greater(greater(v[0].abs(), v[1].abs()), v[2].abs());
        let smallest = SMALLEST * magnitude(&ray.direction);
        let thickness = THICKNESS * (magnitude(&ray.origin) + reach);
        let mut slabs =
            Self { inverse: [0.0; 3], enter: [0.0; 3], leave: [0.0; 3], backward: [0; 3] };
        for axis in 0..3 {
            let d = ray.direction[axis];
            let inverse = 1.0 / if d.abs() < smallest { smallest.copysign(d) } else { d };
            let offset = ray.origin[axis] * inverse;
            let thick = thickness * inverse.abs();
            slabs.inverse[axis] = inverse;
            slabs.enter[axis] = offset + thick;
            slabs.leave[axis] = offset - thick;
            slabs.backward[axis] = usize::from(inverse < 0.0);
        }
        slabs
    }
}

/// The largest coordinate of a box.
pub(super) fn reach(bounds: &Aabb) -> f32 {
    bounds.lower.iter().chain(&bounds.upper).fold(0.0, |largest, v| v.abs().max(largest))
}

/// The lesser of two numbers; one instruction, because neither is NaN.
#[inline(always)]
pub(super) fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two numbers; one instruction, because neither is NaN.
#[inline(always)]
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
