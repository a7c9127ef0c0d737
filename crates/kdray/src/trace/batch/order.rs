//! Keys by which queries near each other come together: bits of their coordinates, interleaved.

use super::Batch;
use crate::geometry::{Aabb, Ray};

impl Batch<'_> {
    /// Nearby points have similar keys.
    pub(super) fn key_of_point(&self, point: &[f32; 3]) -> u32 {
        self.key_in_box(point, 1024.0)
    }

    /// Rays with similar origins have similar keys, and of those the ones that go the same way.
    pub(super) fn key_of_ray(&self, ray: &Ray) -> u32 {
        let length = ray.direction.iter().fold(0.0, |longest: f32, v| v.abs().max(longest));
        let direction = ray.direction.map(|v| cell(0.5 + 0.5 * (v / length), 8.0));
        self.key_in_box(&ray.origin, 128.0) << 9 | by_threes(direction)
    }

    /// Points whose [ways out](crate::Tracer::way_out) are beside each other have similar keys.
    pub(super) fn key_across(&self, point: &[f32; 3]) -> u32 {
        let Some(Ray { direction, .. }) = self.tracer.way_out(*point) else { return u32::MAX };
        let Aabb { lower, upper } = self.tracer.bounds;
        let along = self.tracer.shortest_side();
        let across = [(along + 1) % 3, (along + 2) % 3];
        let cells = across
            .map(|axis| cell((point[axis] - lower[axis]) / (upper[axis] - lower[axis]), 32_768.0));
        (u32::from(direction[along] < 0.0) << 30) | by_twos(cells)
    }

    /// Where in the box of the mesh, of so many cells along each axis.
    fn key_in_box(&self, point: &[f32; 3], cells: f32) -> u32 {
        let bounds = self.tracer.bounds;
        by_threes([0, 1, 2].map(|axis| {
            let extent = bounds.upper[axis] - bounds.lower[axis];
            cell(0.25 + 0.5 * ((point[axis] - bounds.lower[axis]) / extent), cells)
        }))
    }
}

/// The cell of 0..1 that the number is in, or the nearest to it.
fn cell(number: f32, cells: f32) -> u32 {
    (cells * number).clamp(0.0, cells - 1.0) as u32
}

/// The bits of three numbers of ten bits in turn, the highest first.
fn by_threes([x, y, z]: [u32; 3]) -> u32 {
    let spread = |mut x: u32| {
        x = (x | x << 16) & 0x0300_00ff;
        x = (x | x << 8) & 0x0300_f00f;
        x = (x | x << 4) & 0x030c_30c3;
        (x | x << 2) & 0x0924_9249
    };
    spread(x) << 2 | spread(y) << 1 | spread(z)
}

/// The bits of two numbers of sixteen bits in turn, the highest first.
fn by_twos([x, y]: [u32; 2]) -> u32 {
    let spread = |mut x: u32| {
        x = (x | x << 8) & 0x00ff_00ff;
        x = (x | x << 4) & 0x0f0f_0f0f;
        x = (x | x << 2) & 0x3333_3333;
        (x | x << 1) & 0x5555_5555
    };
    spread(x) << 1 | spread(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_take_turns() {
        assert_eq!(by_threes([0b11, 0b00, 0b01]), 0b100_101);
        assert_eq!(by_threes([1023; 3]), (1 << 30) - 1);
        assert_eq!(by_twos([0b11, 0b01]), 0b1011);
        assert_eq!(by_twos([0xffff; 2]), u32::MAX);
    }

    #[test]
    fn numbers_without_meaning_have_cells_too() {
        let cells = [-1.0, 0.5, 7.0, f32::NAN, f32::INFINITY].map(|number| cell(number, 1024.0));
        assert_eq!(cells, [0, 512, 1023, 0, 1023]);
    }
}
