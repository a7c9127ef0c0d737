//! Whether a triangle and a box have a point in common.

use super::Aabb;
use super::vector::{cross, dot};

/// Whether the triangle and the box meet, touching included: no axis separates them \[AM01].
///
/// In double precision; degenerate triangles are the segments or points that they are.
pub(crate) fn overlaps(corners: &[[f32; 3]; 3], bounds: &Aabb) -> bool {
    let wide = |point: [f32; 3]| point.map(f64::from);
    let (lower, upper) = (wide(bounds.lower), wide(bounds.upper));
    let center = [0, 1, 2].map(|axis| 0.5 * (lower[axis] + upper[axis]));
    let half = [0, 1, 2].map(|axis| 0.5 * (upper[axis] - lower[axis]));
    let corners =
        corners.map(|corner| [0, 1, 2].map(|axis| f64::from(corner[axis]) - center[axis]));
    let edges = [0, 1, 2].map(|corner: usize| {
        let (from, to) = (corners[corner], corners[(corner + 1) % 3]);
        [0, 1, 2].map(|axis| to[axis] - from[axis])
    });
    let faces = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let normal = cross(edges[0], edges[1]);
    let mut axes = faces
        .into_iter()
        .chain([normal])
        .chain(edges.into_iter().flat_map(|edge| faces.map(|face| cross(face, edge))));
    !axes.any(|axis| separates(axis, &corners, half))
}

/// Whether the triangle and the box around the origin lie apart along `axis`.
fn separates(axis: [f64; 3], corners: &[[f64; 3]; 3], half: [f64; 3]) -> bool {
    let along = corners.map(|corner| dot(axis, corner));
    let lowest = along[0].min(along[1]).min(along[2]);
    let highest = along[0].max(along[1]).max(along[2]);
    let reach = dot(axis.map(f64::abs), half);
    lowest > reach || highest < -reach
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb { lower: [0.0; 3], upper: [1.0; 3] };

    #[test]
    fn a_triangle_around_a_corner_of_the_box_does_not_meet_it() {
        assert!(!overlaps(&[[2.2, 0.0, 0.5], [0.0, 2.2, 0.5], [3.0, 3.0, 0.5]], &UNIT));
        assert!(overlaps(&[[1.8, 0.0, 0.5], [0.0, 1.8, 0.5], [3.0, 3.0, 0.5]], &UNIT));
    }

    #[test]
    fn a_triangle_that_cuts_through_without_corners_inside_meets_it() {
        assert!(overlaps(&[[-9.0, 0.5, -9.0], [9.0, 0.5, -9.0], [0.0, 0.5, 9.0]], &UNIT));
    }

    #[test]
    fn touching_and_degenerate_triangles_count() {
        assert!(overlaps(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]], &UNIT));
        assert!(overlaps(&[[0.5; 3]; 3], &UNIT));
        assert!(!overlaps(&[[1.5; 3]; 3], &UNIT));
    }
}
