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
use super::corner::Corner;

/// A triangle cut by six planes has at most nine corners; rounding can give a sliver a few more.
const MAX_CORNERS: usize = 12;

/// Half an ulp of one.
const HALF_ULP: f32 = f32::EPSILON * 0.5;

/// Bounds of the part of `triangle` inside `bounds`, or `None` if there is no such part.
#[must_use]
pub fn clip(triangle: &[[f32; 3]; 3], bounds: &Aabb) -> Option<Aabb> {
    let [a, b, c] = triangle.map(Corner::new);
    let whole = [a.min(b).min(c), a.max(b).max(c)];
    let [lower, upper] = [bounds.lower, bounds.upper].map(Corner::new);
    let (below, above) = (whole[0].is_less(lower), upper.is_less(whole[1]));
    let margin = margin(whole, (below.count_ones() + above.count_ones()) as i32);
    let mut part = whole;
    if below | above != 0 {
        let mut polygon = Polygon::new([a, b, c]);
        let planes = [lower.minus(margin), upper.plus(margin)];
        polygon.cut::<0>([below, above], planes);
        polygon.cut::<1>([below, above], planes);
        polygon.cut::<2>([below, above], planes);
        if polygon.overflowed {
            return overlap(triangle, bounds);
        }
        part = polygon.bounds();
    }
    let zero = Corner::all(0.0);
    // Adding zero turns -0 into +0: events compare bits.
    let first = part[0].minus(margin).max(whole[0]).max(lower).plus(zero);
    let last = part[1].plus(margin).min(whole[1]).min(upper).plus(zero);
    let clipped = Aabb { lower: first.coordinates(), upper: last.coordinates() };
    (last.is_less(first) == 0).then_some(clipped)
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

/// How far the corners of a polygon that is cut so often can be from where they belong.
#[inline(always)]
fn margin([lower, upper]: [Corner; 2], cuts: i32) -> Corner {
    let greatest = |[x, y, z]: [f32; 3]| {
        let pair = if x > y { x } else { y };
        if pair > z { pair } else { z }
    };
    let zero = Corner::all(0.0);
    let largest = greatest(upper.max(zero.minus(lower)).coordinates());
    let extent = greatest(upper.minus(lower).coordinates());
    // One cut more than there are pays for the roundings of the margin itself.
    Corner::all((cuts + 1) as f32 * (HALF_ULP * (5.0 * extent + largest)))
}

/// A convex polygon on the stack.
struct Polygon {
    /// Places behind the last that counts are written and never read.
    corners: [Corner; PLACES],
    len: usize,
    overflowed: bool,
}

/// A power of two above [`MAX_CORNERS`]: what is written beyond goes to the front again.
const PLACES: usize = 16;

impl Polygon {
    #[inline(always)]
    fn new([a, b, c]: [Corner; 3]) -> Self {
        let mut corners = [a; PLACES];
        (corners[1], corners[2]) = (b, c);
        Self { corners, len: 3, overflowed: false }
    }

    /// Keeps what is between the planes along an axis, of those that cut.
    #[inline(always)]
    fn cut<const AXIS: usize>(&mut self, [below, above]: [u32; 2], planes: [Corner; 2]) {
        if below >> AXIS & 1 == 1 {
            self.cut_with::<AXIS>(planes[0].get::<AXIS>(), |value, plane| value >= plane);
        }
        if above >> AXIS & 1 == 1 {
            self.cut_with::<AXIS>(planes[1].get::<AXIS>(), |value, plane| value <= plane);
        }
    }

    /// Keeps the side of the plane where `inside(coordinate, plane)` holds. Whatever may be a corner
    /// is written, and counts if it is one: which it is, nobody could foretell.
    #[inline(always)]
    fn cut_with<const AXIS: usize>(&mut self, plane: f32, inside: impl Fn(f32, f32) -> bool) {
        let mut kept = [Corner::all(0.0); PLACES];
        let mut len = 0;
        let count = self.len.min(MAX_CORNERS);
        if count > 0 {
            self.corners[count] = self.corners[0];
        }
        let mut corner = self.corners[0];
        let mut is_inside = inside(corner.get::<AXIS>(), plane);
        for next in &self.corners[1..][..count] {
            let is_next_inside = inside(next.get::<AXIS>(), plane);
            kept[len % PLACES] = corner;
            len += usize::from(is_inside);
            kept[len % PLACES] = crossing::<AXIS>(corner, *next, plane);
            len += usize::from(is_inside != is_next_inside);
            (corner, is_inside) = (*next, is_next_inside);
        }
        self.overflowed |= len > MAX_CORNERS;
        (self.corners, self.len) = (kept, len);
    }

    #[inline(always)]
    fn bounds(&self) -> [Corner; 2] {
        let mut bounds = [Corner::all(f32::INFINITY), Corner::all(f32::NEG_INFINITY)];
        for corner in &self.corners[..self.len.min(MAX_CORNERS)] {
            bounds = [bounds[0].min(*corner), bounds[1].max(*corner)];
        }
        bounds
    }
}

/// Where the edge from `p` to `q` meets the plane.
#[inline(always)]
fn crossing<const AXIS: usize>(p: Corner, q: Corner, plane: f32) -> Corner {
    let along = q.minus(p);
    let t = (plane - p.get::<AXIS>()) / along.get::<AXIS>();
    p.plus(along.times(t)).with::<AXIS>(plane)
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
