//! Smooth normals: one a corner, so that creases stay sharp.

use glam::Vec3;
use kdray::Mesh;
use rayon::prelude::*;

/// Triangles that meet at less than this angle shade as one smooth surface (cosine of 40 degrees).
const CREASE: f32 = 0.766;

/// Vertices of more triangles than this stay flat: averaging costs the square of it.
const MOST_NEIGHBOURS: usize = 64;

/// For each corner of each triangle the normal of the surface there, in units of 1/32767.
///
/// Corner normals are on the side of their own triangle's normal, whichever way its neighbours are
/// wound.
pub(crate) struct Corners(pub(crate) Vec<[[i16; 3]; 3]>);

impl Corners {
    pub(crate) fn new(mesh: &Mesh, welded: &[u32]) -> Self {
        let meetings = Meetings::new(mesh, welded);
        let triangles = (0..mesh.triangles().len()).into_par_iter();
        let flat: Vec<Vec3> =
            triangles.clone().map(|triangle| flat_normal(mesh, triangle)).collect();
        let angles: Vec<[f32; 3]> = triangles.clone().map(|t| angles(mesh.triangle(t))).collect();
        let corners = |triangle: usize| {
            mesh.triangles()[triangle].map(|vertex| {
                let corners = meetings.at(welded[vertex as usize]);
                pack(smooth_normal(flat[triangle], corners, &flat, angles.as_flattened()))
            })
        };
        Self(triangles.map(corners).collect())
    }

    /// Of a mesh that nobody looks at.
    pub(crate) fn none() -> Self {
        Self(Vec::new())
    }

    /// The normals of a triangle's corners, of about unit length.
    pub(crate) fn normals(&self, triangle: usize) -> [Vec3; 3] {
        self.0[triangle].map(|packed| Vec3::from(packed.map(f32::from)) / 32767.0)
    }
}

/// The mean of the normals around a vertex that continue `normal` smoothly, weighted by the angles
/// of their triangles there. Corner `3 t + k` is the k-th of triangle t.
fn smooth_normal(normal: Vec3, corners: &[u32], flat: &[Vec3], angles: &[f32]) -> Vec3 {
    if corners.len() > MOST_NEIGHBOURS {
        return normal;
    }
    let mut sum = Vec3::ZERO;
    for corner in corners.iter().map(|corner| *corner as usize) {
        let neighbour = flat[corner / 3];
        let cosine = neighbour.dot(normal);
        if cosine.abs() > CREASE {
            sum += cosine.signum() * angles[corner] * neighbour;
        }
    }
    sum.try_normalize().unwrap_or(normal)
}

/// The angles of a triangle in radians.
fn angles(triangle: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = triangle.map(Vec3::from);
    let unit = |v: Vec3| v.try_normalize().unwrap_or(Vec3::ZERO);
    let [ab, bc, ca] = [unit(b - a), unit(c - b), unit(a - c)];
    [-ca.dot(ab), -ab.dot(bc), -bc.dot(ca)].map(|cosine| cosine.clamp(-1.0, 1.0).acos())
}

/// The unit normal of a triangle, or zero for one without area.
pub(crate) fn flat_normal(mesh: &Mesh, triangle: usize) -> Vec3 {
    let [a, b, c] = mesh.triangle(triangle).map(Vec3::from);
    let (first, second) = (b - a, c - a);
    let size = first.abs().max(second.abs()).max_element();
    let normal = if size > 0.0 { (first / size).cross(second / size) } else { Vec3::ZERO };
    normal.try_normalize().unwrap_or(Vec3::ZERO)
}

fn pack(normal: Vec3) -> [i16; 3] {
    normal.to_array().map(|component| (component * 32767.0).round() as i16)
}

/// The corners that meet at each vertex, one vertex after the other.
struct Meetings {
    first: Vec<u32>,
    corners: Vec<u32>,
}

impl Meetings {
    fn new(mesh: &Mesh, welded: &[u32]) -> Self {
        let vertices = mesh.triangles().as_flattened().iter().map(|v| welded[*v as usize]);
        let mut first = vec![0; welded.len() + 1];
        for vertex in vertices.clone() {
            first[vertex as usize + 1] += 1;
        }
        for vertex in 1..first.len() {
            first[vertex] += first[vertex - 1];
        }
        let mut next = first.clone();
        let mut corners = vec![0; 3 * mesh.triangles().len()];
        for (corner, vertex) in vertices.enumerate() {
            let slot = &mut next[vertex as usize];
            corners[*slot as usize] = corner as u32;
            *slot += 1;
        }
        Self { first, corners }
    }

    fn at(&self, vertex: u32) -> &[u32] {
        let [first, last] = [0, 1].map(|step| self.first[vertex as usize + step] as usize);
        &self.corners[first..last]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weld::weld;

    /// Two triangles that share an edge along y, the second turned up by the given slope.
    fn fold(slope: f32, flipped: bool) -> Corners {
        let positions = [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, slope]];
        let second = if flipped { [1, 2, 3] } else { [1, 3, 2] };
        let mesh = Mesh::new(&positions, &[[0, 1, 2], second]).expect("finite");
        Corners::new(&mesh, &weld(&mesh))
    }

    #[test]
    fn a_gentle_fold_is_smoothed_whichever_way_it_is_wound() {
        for flipped in [false, true] {
            let [outer, inner, _] = fold(0.2, flipped).normals(0);
            assert!(outer.distance(Vec3::Z) < 1e-3);
            assert!(inner.x < -0.05 && inner.z > 0.9, "{inner}");
        }
    }

    #[test]
    fn angles_are_those_of_the_corners() {
        let found = angles([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 3_f32.sqrt(), 0.0]]);
        for (angle, degrees) in found.into_iter().zip([90.0, 60.0, 30.0]) {
            assert!((angle.to_degrees() - degrees).abs() < 1e-3, "{found:?}");
        }
    }

    #[test]
    fn a_crease_stays_sharp() {
        for normal in fold(3.0, false).normals(0) {
            assert!(normal.distance(Vec3::Z) < 1e-3);
        }
    }
}
