//! Points, directions and random numbers.

use std::f64::consts::TAU;

use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};

pub(super) type Vector = [f64; 3];

pub(super) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn scale(a: Vector, factor: f64) -> Vector {
    a.map(|value| value * factor)
}

pub(super) fn subtract(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn normalise(a: Vector) -> Vector {
    scale(a, 1.0 / dot(a, a).sqrt())
}

/// The sine and cosine of `turns` full turns.
pub(super) fn sin_cos(turns: f64) -> (f64, f64) {
    let angle = turns * TAU;
    (libm::sin(angle), libm::cos(angle))
}

/// Between `from` and `to`, as far as `part` says.
pub(super) fn mix(from: f64, to: f64, part: f64) -> f64 {
    from + (to - from) * part
}

/// A source of random numbers that depends on its seed alone.
pub(super) struct Random(Pcg32);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    /// At least 0, less than 1.
    pub(super) fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    /// At least `from`, less than `to`.
    pub(super) fn between(&mut self, from: f64, to: f64) -> f64 {
        mix(from, to, self.unit())
    }
}
