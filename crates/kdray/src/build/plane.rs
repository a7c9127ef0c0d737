//! The plane that cuts a node, and the side each reference takes.

use crate::geometry::Aabb;

/// A split plane. Flat references, which lie in it, all go to one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) position: f32,
    pub(super) flat: Side,
}

/// The children a reference reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
    /// A straddler.
    Both,
}

impl Plane {
    /// Bounds that only touch the plane do not cross it.
    pub(super) fn side_of(&self, bounds: &Aabb) -> Side {
        let (lower, upper) = (bounds.lower[self.axis], bounds.upper[self.axis]);
        match (lower < self.position, upper > self.position) {
            (true, true) => Side::Both,
            (true, false) => Side::Left,
            (false, true) => Side::Right,
            (false, false) => self.flat,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_the_plane_is_not_crossing_it() {
        let plane = Plane { axis: 0, position: 1.0, flat: Side::Right };
        let side = |lower, upper| {
            plane.side_of(&Aabb { lower: [lower, 0.0, 0.0], upper: [upper, 1.0, 1.0] })
        };
        assert_eq!([side(0.0, 1.0), side(1.0, 2.0)], [Side::Left, Side::Right]);
        assert_eq!([side(0.0, 2.0), side(1.0, 1.0)], [Side::Both, Side::Right]);
    }
}
