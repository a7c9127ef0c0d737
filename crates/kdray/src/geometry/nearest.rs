//! The point of a triangle nearest to another point.

use super::vector::{Vector, cross, dot, minus};

/// A point of a triangle: `(1 - u - v) v0 + u v1 + v v2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    pub(crate) point: [f64; 3],
    pub(crate) squared_distance: f64,
    pub(crate) u: f64,
    pub(crate) v: f64,
}

/// The nearest point of the triangle, in double precision: the foot on its plane, or the nearest of
/// the nearest points of its edges \[Eri05].
///
/// Degenerate triangles are the segments or points that they are.
pub(crate) fn nearest_on_triangle(point: [f32; 3], corners: &[[f32; 3]; 3]) -> Nearest {
    let p = point.map(f64::from);
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let normal = cross(minus(b, a), minus(c, a));
    let length = dot(normal, normal);
    let inward = |from: Vector, to: Vector| dot(cross(normal, minus(to, from)), minus(p, from));
    let edges = [on_edge(p, a, b), on_edge(p, a, c), on_edge(p, b, c)];
    let candidates = [
        at(p, [a, b, c], edges[0], 0.0),
        at(p, [a, b, c], 0.0, edges[1]),
        at(p, [a, b, c], 1.0 - edges[2], edges[2]),
    ];
    let nearer = |best: Nearest, other: Nearest| {
        if other.squared_distance < best.squared_distance { other } else { best }
    };
    let outline = nearer(nearer(candidates[0], candidates[1]), candidates[2]);
    let sides = [inward(b, c), inward(c, a), inward(a, b)];
    if length > 0.0 && sides.iter().all(|side| *side > 0.0) {
        // The foot on the plane is precise where weighted corners of a sliver would not be.
        let height = dot(normal, minus(p, a)) / length;
        let point = [0, 1, 2].map(|axis| p[axis] - height * normal[axis]);
        let [_, u, v] = sides.map(|side| side / length);
        let foot = Nearest { point, squared_distance: height * height * length, u, v };
        return nearer(foot, outline);
    }
    outline
}

/// How far along the edge from `a` to `b` its nearest point is.
fn on_edge(p: Vector, a: Vector, b: Vector) -> f64 {
    let along = minus(b, a);
    let length = dot(along, along);
    if length == 0.0 { 0.0 } else { (dot(along, minus(p, a)) / length).clamp(0.0, 1.0) }
}

fn at(p: Vector, [a, b, c]: [Vector; 3], u: f64, v: f64) -> Nearest {
    let (ab, ac) = (minus(b, a), minus(c, a));
    let point = [0, 1, 2].map(|axis| a[axis] + (u * ab[axis] + v * ac[axis]));
    let away = minus(p, point);
    Nearest { point, squared_distance: dot(away, away), u, v }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn faces_edges_and_corners_are_found() {
        let cases = [
            ([1.0, 1.0, 3.0], [1.0, 1.0, 0.0]),
            ([2.0, -5.0, 0.0], [2.0, 0.0, 0.0]),
            ([-1.0, -1.0, 2.0], [0.0, 0.0, 0.0]),
            ([9.0, -1.0, 0.0], [4.0, 0.0, 0.0]),
            ([3.0, 3.0, 1.0], [2.0, 2.0, 0.0]),
        ];
        for (point, expected) in cases {
            assert_eq!(nearest_on_triangle(point, &CORNERS).point, expected, "{point:?}");
        }
    }

    #[test]
    fn degenerate_triangles_have_nearest_points_too() {
        let segment = [[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        assert_eq!(nearest_on_triangle([1.5, 1.0, 0.0], &segment).point, [1.5, 0.0, 0.0]);
        let point = [[1.0, 2.0, 3.0]; 3];
        assert_eq!(nearest_on_triangle([0.0; 3], &point).point, [1.0, 2.0, 3.0]);
    }
}
