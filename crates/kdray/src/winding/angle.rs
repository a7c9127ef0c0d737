//! Solid angles of triangles.

use std::f64::consts::TAU;

use crate::geometry::vector::{cross, dot};

/// Triangles in a fan.
pub(super) const LANES: usize = 8;

/// Corners of up to eight triangles, by corner and axis. Free lanes are triangles without area.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Fan {
    corners: [[[f32; LANES]; 3]; 3],
}

impl Fan {
    /// A fan of at least one triangle and at most eight.
    pub(super) fn new(triangles: impl Iterator<Item = [[f32; 3]; 3]>) -> Self {
        let mut fan = Self { corners: [[[0.0; LANES]; 3]; 3] };
        for (lane, triangle) in triangles.enumerate() {
            for corner in 0..3 {
                for axis in 0..3 {
                    fan.corners[corner][axis][lane] = triangle[corner][axis];
                }
            }
        }
        fan
    }

    /// By lane, a complex number whose argument is half the solid angle of the triangle \[VS83].
    #[inline(always)]
    fn halves(&self, point: [f64; 3]) -> [[f64; LANES]; 2] {
        let (mut real, mut imaginary) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let corner = |corner: usize| {
                let [x, y, z] = &self.corners[corner];
                [
                    f64::from(x[lane]) - point[0],
                    f64::from(y[lane]) - point[1],
                    f64::from(z[lane]) - point[2],
                ]
            };
            let (a, b, c) = (corner(0), corner(1), corner(2));
            let (a_length, b_length, c_length) =
                (dot(a, a).sqrt(), dot(b, b).sqrt(), dot(c, c).sqrt());
            let volume = dot(a, cross(b, c));
            let flat = a_length * b_length * c_length
                + dot(a, b) * c_length
                + dot(b, c) * a_length
                + dot(c, a) * b_length;
            let size = flat.abs() + volume.abs();
            real[lane] = if size > 0.0 { flat / size } else { 1.0 };
            imaginary[lane] = if size > 0.0 { volume / size } else { 0.0 };
        }
        [real, imaginary]
    }
}

/// A sum of angles: whole turns, and the argument of a complex number.
///
/// Angles are added by multiplying complex numbers, and a turn is counted wherever the product
/// crosses the negative real axis. So one arctangent is enough for all triangles.
pub(super) struct Turns {
    turns: f64,
    real: f64,
    imaginary: f64,
}

impl Default for Turns {
    fn default() -> Self {
        Self { turns: 0.0, real: 1.0, imaginary: 0.0 }
    }
}

impl Turns {
    /// Adds half the solid angles of a fan.
    #[inline(always)]
    pub(super) fn add(&mut self, fan: &Fan, point: [f64; 3]) {
        let [real, imaginary] = fan.halves(point);
        for lane in 0..LANES {
            self.turn(real[lane], imaginary[lane]);
        }
        // Neither part of the product may leave the range of f64, however many factors it has.
        let size = self.real.abs() + self.imaginary.abs();
        self.real /= size;
        self.imaginary /= size;
    }

    #[inline(always)]
    fn turn(&mut self, real: f64, imaginary: f64) {
        let product_real = self.real * real - self.imaginary * imaginary;
        let product_imaginary = self.real * imaginary + self.imaginary * real;
        let (first, second) = (self.imaginary >= 0.0, imaginary >= 0.0);
        let crossed = (first == second) & (first != (product_imaginary >= 0.0));
        let turn = if first { 1.0 } else { -1.0 };
        self.turns += if crossed { turn } else { 0.0 };
        (self.real, self.imaginary) = (product_real, product_imaginary);
    }

    /// The solid angle over that of the sphere, twice two right angles.
    pub(super) fn number(&self) -> f64 {
        self.turns + self.imaginary.atan2(self.real) / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_add_up_as_angles_do() {
        let angles = [3.0, 3.0, -1.0, 2.5, -3.1, -3.1, -3.1, -3.1, 0.5, 3.1, 3.1, 1.6, 1.6];
        let (mut turns, mut sum) = (Turns::default(), 0.0);
        for angle in angles {
            let (sin, cos) = f64::sin_cos(angle);
            turns.turn(cos, sin);
            sum += angle;
            assert!((turns.number() - sum / TAU).abs() < 1e-12, "{} {sum}", turns.number());
        }
    }

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere() {
        let fan = Fan::new([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]].into_iter());
        let mut turns = Turns::default();
        turns.add(&fan, [0.0; 3]);
        assert!((turns.number() - 0.125).abs() < 1e-15, "{}", turns.number());
    }
}
