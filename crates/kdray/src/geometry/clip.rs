//! Clip a triangle to a box: the bounds of the part inside ("perfect splits" \[WH06]).
//!
//! Sutherland and Hodgman's polygon clipping in single precision, made conservative: the result
//! may be larger than the true part by a few ulps of the triangle's coordinates, and is never
//! smaller. Every exact builder, on any device, uses this very recipe, because the bounds it gives
//! are the candidate planes of the levels below.
//!
//! Why it is conservative: let `u` be half an ulp of one, `M` the largest coordinate and `D` the
//! largest extent of the triangle. An intersection `p + (q - p) t` computed from polygon corners
//! is off by at most `u (5 D + M)`. Planes are moved outwards by the sum of these errors over
//! all cuts, so nothing that belongs to the part is cut away, and the bounds are widened by the
//! same sum at the end. Since they are then cut back to the bounds of the whole triangle, a corner
//! of the triangle inside the box gives its exact coordinate, and a flat triangle stays flat.

use super::Aabb;

/// A triangle cut by six planes has at most nine corners; rounding can give a sliver a few more.
const MAX_CORNERS: usize = 12;

/// Half an ulp of one.
const HALF_ULP: f32 = f32::EPSILON * 0.5;

/// Bounds of the part of `triangle` inside `bounds`, or `None` if there is no such part.
#[must_use]
pub fn clip(triangle: &[[f32; 3]; 3], bounds: &Aabb) -> Option<Aabb> {
    let whole = Aabb::of_points(triangle);
    let margin = margin(&whole, bounds);
    let mut polygon = Polygon::new(triangle);
    for axis in 0..3 {
        if whole.lower[axis] < bounds.lower[axis] {
            polygon.cut(axis, bounds.lower[axis] - margin, |value, plane| value >= plane);
        }
        if whole.upper[axis] > bounds.upper[axis] {
            polygon.cut(axis, bounds.upper[axis] + margin, |value, plane| value <= plane);
        }
    }
    if polygon.overflowed {
        return overlap(triangle, bounds);
    }
    let part = polygon.bounds();
    let mut clipped = Aabb::EMPTY;
    for axis in 0..3 {
        let lower = part.lower[axis] - margin;
        let upper = part.upper[axis] + margin;
        // Adding zero turns -0 into +0: events compare bits.
        clipped.lower[axis] = lower.max(whole.lower[axis]).max(bounds.lower[axis]) + 0.0;
        clipped.upper[axis] = upper.min(whole.upper[axis]).min(bounds.upper[axis]) + 0.0;
    }
    (!clipped.is_empty()).then_some(clipped)
}

/// The part of the triangle's own bounds inside `bounds`: what a builder that does not clip uses.
#[must_use]
pub fn overlap(triangle: &[[f32; 3]; 3], bounds: &Aabb) -> Option<Aabb> {
    let mut part = Aabb::of_points(triangle);
    for axis in 0..3 {
        part.lower[axis] = part.lower[axis].max(bounds.lower[axis]) + 0.0;
        part.upper[axis] = part.upper[axis].min(bounds.upper[axis]) + 0.0;
    }
    (!part.is_empty()).then_some(part)
}

/// How far the corners of the clipped polygon can be from where they belong.
fn margin(whole: &Aabb, bounds: &Aabb) -> f32 {
    let mut cuts = 0;
    let (mut largest, mut extent) = (0.0_f32, 0.0_f32);
    for axis in 0..3 {
        cuts += i32::from(whole.lower[axis] < bounds.lower[axis]);
        cuts += i32::from(whole.upper[axis] > bounds.upper[axis]);
        largest = largest.max(whole.lower[axis].abs()).max(whole.upper[axis].abs());
        extent = extent.max(whole.upper[axis] - whole.lower[axis]);
    }
    // One cut more than there are pays for the roundings of the margin itself.
    (cuts + 1) as f32 * (HALF_ULP * (5.0 * extent + largest))
}

/// A convex polygon on the stack.
struct Polygon {
    corners: [[f32; 3]; MAX_CORNERS],
    len: usize,
    overflowed: bool,
}

impl Polygon {
    fn new(triangle: &[[f32; 3]; 3]) -> Self {
        let mut polygon = Self::empty();
        polygon.corners[..3].copy_from_slice(triangle);
        polygon.len = 3;
        polygon
    }

    fn empty() -> Self {
        Self { corners: [[0.0; 3]; MAX_CORNERS], len: 0, overflowed: false }
    }

    /// Keeps the side of the plane where `inside(coordinate, plane)` holds.
    fn cut(&mut self, axis: usize, plane: f32, inside: impl Fn(f32, f32) -> bool) {
        let mut kept = Self { overflowed: self.overflowed, ..Self::empty() };
        for index in 0..self.len {
            let corner = self.corners[index];
            let next = self.corners[if index + 1 == self.len { 0 } else { index + 1 }];
            let (here, there) = (inside(corner[axis], plane), inside(next[axis], plane));
            if here {
                kept.push(corner);
            }
            if here != there {
                kept.push(crossing(corner, next, axis, plane));
            }
        }
        *self = kept;
    }

    fn push(&mut self, corner: [f32; 3]) {
        match self.corners.get_mut(self.len) {
            Some(free) => {
                *free = corner;
                self.len += 1;
            }
            None => self.overflowed = true,
        }
    }

    fn bounds(&self) -> Aabb {
        Aabb::of_points(&self.corners[..self.len])
    }
}

/// Where the edge from `p` to `q` meets the plane.
fn crossing(p: [f32; 3], q: [f32; 3], axis: usize, plane: f32) -> [f32; 3] {
    let t = (plane - p[axis]) / (q[axis] - p[axis]);
    let mut point = [0, 1, 2].map(|other| p[other] + (q[other] - p[other]) * t);
    point[axis] = plane;
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb { lower: [0.0; 3], upper: [1.0; 3] };

    #[test]
    fn a_triangle_inside_keeps_its_bounds() {
        let triangle = [[0.1, 0.2, 0.3], [0.9, 0.2, 0.3], [0.1, 0.8, 0.7]];
        assert_eq!(clip(&triangle, &UNIT), Some(Aabb::of_points(&triangle)));
    }

    #[test]
    fn a_triangle_whose_box_only_overlaps_has_no_part() {
        // It passes the corner (1, 1, z) on the outside: x + y >= 2.2.
        let triangle = [[2.2, 0.0, 0.5], [0.0, 2.2, 0.5], [3.0, 3.0, 0.5]];
        assert_eq!(clip(&triangle, &UNIT), None);
        assert!(overlap(&triangle, &UNIT).is_some());
    }

    #[test]
    fn the_part_is_tight() {
        let triangle = [[-1.0, 0.0, 0.5], [1.0, 0.0, 0.5], [-1.0, 1.0, 0.5]];
        let part = clip(&triangle, &UNIT).unwrap();
        assert_eq!((part.lower, part.upper[0], part.upper[2]), ([0.0, 0.0, 0.5], 1.0, 0.5));
        assert!((0.5..0.500_002).contains(&part.upper[1]), "{part:?}");
    }

    #[test]
    fn a_flat_triangle_stays_flat() {
        let triangle = [[-3.0, 0.3, -5.0], [4.0, 0.3, -5.0], [0.0, 0.3, 7.0]];
        let part = clip(&triangle, &UNIT).unwrap();
        assert_eq!((part.lower[1], part.upper[1]), (0.3, 0.3));
    }
}
