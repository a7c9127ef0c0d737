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
pub(crate) struct Corners(Vec<[[i16; 3]; 3]>);

impl Corners {
    pub(crate) fn new(mesh: &Mesh, welded: &[u32]) -> Self {
        let around = Neighbours::new(mesh, welded);
        let normals: Vec<Vec3> =
            (0..mesh.triangles().len()).into_par_iter().map(|t| flat_normal(mesh, t)).collect();
        let corners = |triangle: usize| {
            let flat = normals[triangle];
            mesh.triangles()[triangle].map(|vertex| {
                let vertex = welded[vertex as usize];
                pack(smooth_normal(mesh, welded, &normals, around.of(vertex), vertex, flat))
            })
        };
        Self((0..mesh.triangles().len()).into_par_iter().map(corners).collect())
    }

    /// The normals of a triangle's corners, of about unit length.
    pub(crate) fn normals(&self, triangle: usize) -> [Vec3; 3] {
        self.0[triangle].map(|packed| Vec3::from(packed.map(f32::from)) / 32767.0)
    }
}

/// The mean normal of the neighbours that continue a triangle smoothly at a vertex, weighted by
/// their angles there.
fn smooth_normal(
    mesh: &Mesh,
    welded: &[u32],
    normals: &[Vec3],
    neighbours: &[u32],
    vertex: u32,
    flat: Vec3,
) -> Vec3 {
    if neighbours.len() > MOST_NEIGHBOURS {
        return flat;
    }
    let mut sum = Vec3::ZERO;
    for neighbour in neighbours.iter().map(|index| *index as usize) {
        let cosine = normals[neighbour].dot(flat);
        if cosine.abs() > CREASE {
            let corner = mesh.triangles()[neighbour].map(|other| welded[other as usize]);
            let first = corner.iter().position(|other| *other == vertex).unwrap_or(0);
            let angle = angle_at(mesh.triangle(neighbour).map(Vec3::from), first);
            sum += cosine.signum() * angle * normals[neighbour];
        }
    }
    sum.try_normalize().unwrap_or(flat)
}

fn angle_at(corners: [Vec3; 3], corner: usize) -> f32 {
    let [here, next, last] = [0, 1, 2].map(|step| corners[(corner + step) % 3]);
    let unit = |v: Vec3| v.try_normalize().unwrap_or(Vec3::ZERO);
    unit(next - here).dot(unit(last - here)).clamp(-1.0, 1.0).acos()
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

/// The triangles around each vertex, one after the other.
struct Neighbours {
    first: Vec<u32>,
    triangles: Vec<u32>,
}

impl Neighbours {
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
        let mut triangles = vec![0; 3 * mesh.triangles().len()];
        for (corner, vertex) in vertices.enumerate() {
            let slot = &mut next[vertex as usize];
            triangles[*slot as usize] = corner as u32 / 3;
            *slot += 1;
        }
        Self { first, triangles }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        let [first, last] = [0, 1].map(|step| self.first[vertex as usize + step] as usize);
        &self.triangles[first..last]
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
    fn a_crease_stays_sharp() {
        for normal in fold(3.0, false).normals(0) {
            assert!(normal.distance(Vec3::Z) < 1e-3);
        }
    }
}
