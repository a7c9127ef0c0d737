//! The axis-aligned box.

use super::least::{greater, lesser};

/// An axis-aligned box, both corners included.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub lower: [f32; 3],
    /// The corner with the largest coordinates.
    pub upper: [f32; 3],
}

impl Aabb {
    /// The box of no points: `union` with anything gives that thing.
    pub const EMPTY: Self = Self { lower: [f32::INFINITY; 3], upper: [f32::NEG_INFINITY; 3] };

    /// The smallest box that holds all `points`.
    #[must_use]
    pub fn of_points(points: &[[f32; 3]]) -> Self {
        points.iter().fold(Self::EMPTY, |bounds, point| bounds.union_point(*point))
    }

    /// The smallest box that holds this one and `point`.
    #[must_use]
    pub fn union_point(mut self, point: [f32; 3]) -> Self {
        for axis in 0..3 {
            self.lower[axis] = self.lower[axis].min(point[axis]);
            self.upper[axis] = self.upper[axis].max(point[axis]);
        }
        self
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: &Self) -> Self {
        Self {
            lower: [0, 1, 2].map(|axis| lesser(self.lower[axis], other.lower[axis])),
            upper: [0, 1, 2].map(|axis| greater(self.upper[axis], other.upper[axis])),
        }
    }

    /// The box cut in two by the plane `axis = position`.
    #[must_use]
    pub fn cut(&self, axis: usize, position: f32) -> [Self; 2] {
        let (mut left, mut right) = (*self, *self);
        left.upper[axis] = position;
        right.lower[axis] = position;
        [left, right]
    }

    /// Edge lengths.
    #[must_use]
    pub fn extent(&self) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.upper[axis] - self.lower[axis])
    }

    /// Half the surface area, in double precision: 0 for a point, the area for a flat box.
    #[must_use]
    pub fn half_area(&self) -> f64 {
        let [x, y, z] =
            [0, 1, 2].map(|axis| f64::from(self.upper[axis]) - f64::from(self.lower[axis]));
        x * y + y * z + z * x
    }

    /// Whether no point is inside.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.lower[axis] > self.upper[axis])
    }

    /// Whether `other` lies inside this box, faces included.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            self.lower[axis] <= other.lower[axis] && other.upper[axis] <= self.upper[axis]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_area_of_a_unit_cube_is_three() {
        let cube = Aabb { lower: [0.0; 3], upper: [1.0; 3] };
        assert_eq!(cube.half_area(), 3.0);
        let [left, right] = cube.cut(1, 0.25);
        assert_eq!(left.half_area() + right.half_area(), 4.0);
    }

    #[test]
    fn the_empty_box_is_neutral_under_union() {
        let point = [1.0, -2.0, 3.0];
        assert!(Aabb::EMPTY.is_empty());
        let just_that = Aabb { lower: point, upper: point };
        assert_eq!(Aabb::EMPTY.union_point(point), just_that);
        assert_eq!(just_that.union(&Aabb::EMPTY), just_that);
        assert_eq!(Aabb::EMPTY.union(&just_that), just_that);
    }
}
