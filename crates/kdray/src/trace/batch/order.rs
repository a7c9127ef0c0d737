//! Keys by which queries near each other come together: bits of their coordinates, interleaved.

use super::Batch;
use crate::geometry::Ray;

impl Batch<'_> {
    /// Nearby points have similar keys.
    pub(super) fn key_of_point(&self, point: &[f32; 3]) -> u64 {
        interleaved(self.cells(point))
    }

    /// Rays with similar origins have similar keys, and of those the ones that go the same way.
    pub(super) fn key_of_ray(&self, ray: &Ray) -> u64 {
        let length = ray.direction.iter().fold(0.0, |longest: f32, v| v.abs().max(longest));
        let direction = ray.direction.map(|v| cell(0.5 + 0.5 * (v / length)));
        interleaved(self.cells(&ray.origin)) << 30 | interleaved(direction)
    }

    /// Where in the box of the mesh, in 1024ths.
    fn cells(&self, point: &[f32; 3]) -> [u64; 3] {
        let bounds = self.tracer.bounds;
        [0, 1, 2].map(|axis| {
            let extent = bounds.upper[axis] - bounds.lower[axis];
            cell(0.25 + 0.5 * ((point[axis] - bounds.lower[axis]) / extent))
        })
    }
}

/// The 1024th of 0..1 that the number is in, or the nearest to it.
fn cell(number: f32) -> u64 {
    (1024.0 * number).clamp(0.0, 1023.0) as u64
}

/// The bits of three numbers of ten bits in turn, the highest first.
fn interleaved([x, y, z]: [u64; 3]) -> u64 {
    let spread = |value: u64| (0..10).fold(0, |all, bit| all | (value >> bit & 1) << (3 * bit));
    spread(x) << 2 | spread(y) << 1 | spread(z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_take_turns() {
        assert_eq!(interleaved([0b11, 0b00, 0b01]), 0b100_101);
        assert_eq!(interleaved([1023; 3]), (1 << 30) - 1);
    }

    #[test]
    fn numbers_without_meaning_have_cells_too() {
        assert_eq!([-1.0, 0.5, 7.0, f32::NAN, f32::INFINITY].map(cell), [0, 512, 1023, 0, 1023]);
    }
}
