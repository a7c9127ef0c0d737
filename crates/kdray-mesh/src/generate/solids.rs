//! Closed solids.

use std::collections::HashMap;

use super::surface::{Ends, add_box, add_sheet, add_vertex};
use super::vector::{Vector, add, cross, dot, normalise, scale, sin_cos, subtract};
use crate::Loaded;

/// The cube from -1 to 1 on every axis: 8 vertices, 12 triangles, all in axis-aligned planes.
///
/// ```
/// assert_eq!(kdray_mesh::generate::cube().triangles.len(), 12);
/// ```
pub fn cube() -> Loaded {
    let mut mesh = Loaded::default();
    add_box(&mut mesh, [0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    mesh
}

/// The unit sphere as an icosahedron whose triangles were divided into four so many times.
///
/// It has `20 * 4^subdivisions` triangles of nearly equal size; more than 12 subdivisions count as 12.
///
/// ```
/// assert_eq!(kdray_mesh::generate::sphere(3).triangles.len(), 1280);
/// ```
pub fn sphere(subdivisions: u32) -> Loaded {
    let mut mesh = icosahedron();
    for _ in 0..subdivisions.min(12) {
        subdivide(&mut mesh);
    }
    mesh
}

fn icosahedron() -> Loaded {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut mesh = Loaded::default();
    for axis in 0..3 {
        for (short, long) in [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)] {
            let mut point = [0.0; 3];
            point[(axis + 1) % 3] = short;
            point[(axis + 2) % 3] = long;
            add_vertex(&mut mesh, normalise(point));
        }
    }
    let corners = |[a, b, c]: [u32; 3]| [a, b, c].map(|index| mesh.positions[index as usize]);
    let near = |a: Vector, b: Vector| dot(a, b) > 0.4;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = corners([a, b, c]);
                if near(p, q) && near(q, r) && near(r, p) {
                    let normal = cross(subtract(q, p), subtract(r, p));
                    triangles.push(if dot(normal, p) > 0.0 { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    mesh.triangles = triangles;
    mesh
}

/// Divides every triangle into four at the middles of its edges, pushed out to the unit sphere.
fn subdivide(mesh: &mut Loaded) {
    let mut middles: HashMap<[u32; 2], u32> = HashMap::with_capacity(mesh.triangles.len() * 3 / 2);
    let coarse = std::mem::take(&mut mesh.triangles);
    mesh.triangles.reserve(coarse.len() * 4);
    for [a, b, c] in coarse {
        let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]| {
            let edge = [from.min(to), from.max(to)];
            *middles.entry(edge).or_insert_with(|| {
                let [from, to] = edge.map(|index| mesh.positions[index as usize]);
                add_vertex(mesh, normalise(add(from, to)))
            })
        });
        mesh.triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
}

/// A tube around a torus knot that winds `windings[0]` times around the axis, and `windings[1]` times
/// around the ring: `[2, 3]` is the trefoil.
///
/// The knot lies on a torus of radii 1 and 0.4 around the z axis; the tube has radius 0.2. It has
/// `2 * segments * sides` triangles; fewer than three of either count as three. It is embedded, not only
/// closed, when the windings have no common divisor and are small.
///
/// ```
/// let knot = kdray_mesh::generate::torus_knot([2, 3], 200, 12);
/// assert_eq!(knot.triangles.len(), 4800);
/// ```
pub fn torus_knot(windings: [u32; 2], segments: usize, sides: usize) -> Loaded {
    let mut mesh = Loaded::default();
    add_knot(&mut mesh, windings, [segments.max(3), sides.max(3)], 0.2, |point| point);
    mesh
}

/// Adds a knot, each point of which is `placed`.
pub(super) fn add_knot(
    mesh: &mut Loaded,
    [around_axis, around_ring]: [u32; 2],
    cells: [usize; 2],
    tube: f64,
    placed: impl Fn(Vector) -> Vector,
) {
    const RING: f64 = 0.4;
    let (p, q) = (f64::from(around_axis), f64::from(around_ring));
    add_sheet(mesh, cells, [Ends::Joined; 2], |u, v| {
        let ((sin_p, cos_p), (sin_q, cos_q)) = (sin_cos(p * u), sin_cos(q * u));
        let radius = 1.0 + RING * cos_q;
        let centre = [radius * cos_p, radius * sin_p, RING * sin_q];
        // The normal of the torus is at right angles to the knot, and closes with it.
        let normal = [cos_q * cos_p, cos_q * sin_p, sin_q];
        let slope = -RING * q * sin_q;
        let tangent = normalise([
            slope * cos_p - radius * p * sin_p,
            slope * sin_p + radius * p * cos_p,
            RING * q * cos_q,
        ]);
        let (sin, cos) = sin_cos(v);
        let offset = add(scale(normal, cos), scale(cross(normal, tangent), sin));
        placed(add(centre, scale(offset, tube)))
    });
}
