//! The triangles of a scene, checked once.

use super::vector::{cross, dot, minus};
use super::{Aabb, Frame};

/// Triangles that are known to be sound: every index is in range and every coordinate is finite.
///
/// Positions are f32 in the mesh's own [`Frame`]; for ordinary data that is the identity and the
/// positions are those that came in, bit for bit (but for -0, which becomes +0).
#[derive(Clone, Debug)]
pub struct Mesh {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    frame: Frame,
    bounds: Aabb,
}

/// Why vertices and indices are not a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is not finite: {position:?}")]
    NonFinite {
        /// The first such vertex.
        vertex: usize,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} uses vertex {index}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// The first such triangle.
        triangle: usize,
        /// The index it uses.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// More triangles than an index can name.
    #[error("{triangles} triangles are more than the {limit} that a tree can hold")]
    TooLarge {
        /// How many came in.
        triangles: usize,
        /// How many can be held.
        limit: usize,
    },
}

impl Mesh {
    /// The most triangles a mesh can have: a reference has 30 bits in an event.
    pub const MAX_TRIANGLES: usize = (1 << 29) - 1;

    /// A mesh of single-precision `positions`.
    ///
    /// # Errors
    ///
    /// [`MeshError`] names the first vertex that is not finite or the first index out of range.
    ///
    /// ```
    /// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = kdray::Mesh::new(&positions, &[[0, 1, 2]])?;
    /// assert_eq!(mesh.bounds().upper, [1.0, 1.0, 0.0]);
    /// # Ok::<(), kdray::MeshError>(())
    /// ```
    pub fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let world = |index: usize| positions[index].map(f64::from);
        Self::from_world(positions.len(), world, triangles.to_vec())
    }

    /// A mesh of double-precision `positions`, which keeps what f32 around its own origin can keep.
    ///
    /// # Errors
    ///
    /// As [`Mesh::new`].
    pub fn from_f64(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        Self::from_world(positions.len(), |index| positions[index], triangles.to_vec())
    }

    /// As [`Mesh::from_f64`], but triangles that touch a vertex that is not finite are dropped.
    /// Gives the mesh and how many triangles it lost; vertex indices stay as they were.
    ///
    /// # Errors
    ///
    /// [`MeshError::IndexOutOfRange`], [`MeshError::TooLarge`].
    pub fn dropping_non_finite(
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<(Self, usize), MeshError> {
        check_indices(positions.len(), triangles)?;
        let finite = |index: usize| positions[index].iter().all(|value| value.is_finite());
        let mut kept = triangles.to_vec();
        kept.retain(|triangle| triangle.iter().all(|index| finite(*index as usize)));
        let dropped = triangles.len() - kept.len();
        // A vertex that no triangle uses any more is parked at the zero of the world.
        let world = |index: usize| {
            if finite(index) { positions[index] } else { [0.0; 3] }
        };
        Ok((Self::from_world(positions.len(), world, kept)?, dropped))
    }

    /// Checks everything, picks the frame and moves the vertices into it.
    fn from_world(
        vertices: usize,
        world: impl Fn(usize) -> [f64; 3],
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        check_indices(vertices, &triangles)?;
        let non_finite = |index: &usize| world(*index).iter().any(|value| !value.is_finite());
        if let Some(vertex) = (0..vertices).find(non_finite) {
            return Err(MeshError::NonFinite { vertex, position: world(vertex) });
        }
        let (mut lower, mut upper) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for index in triangles.as_flattened() {
            let position = world(*index as usize);
            for axis in 0..3 {
                lower[axis] = lower[axis].min(position[axis]);
                upper[axis] = upper[axis].max(position[axis]);
            }
        }
        let frame =
            if triangles.is_empty() { Frame::IDENTITY } else { Frame::around(lower, upper) };
        // A vertex outside every triangle may lie out of reach of the frame; nothing uses it.
        let local = |index| frame.local_point(world(index)).map(|x| x.clamp(f32::MIN, f32::MAX));
        let positions: Vec<[f32; 3]> = (0..vertices).map(local).collect();
        Ok(Self::bounded(positions, triangles, frame))
    }

    /// A mesh of `positions` that are already those of `frame`, without -0.
    pub(super) fn from_local(
        positions: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
        frame: Frame,
    ) -> Result<Self, MeshError> {
        check_indices(positions.len(), &triangles)?;
        let is_finite = |position: &[f32; 3]| position.iter().all(|value| value.is_finite());
        if let Some(vertex) = positions.iter().position(|position| !is_finite(position)) {
            let position = positions[vertex].map(f64::from);
            return Err(MeshError::NonFinite { vertex, position });
        }
        Ok(Self::bounded(positions, triangles, frame))
    }

    /// The mesh of what has been checked.
    fn bounded(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>, frame: Frame) -> Self {
        let corners = triangles.as_flattened().iter().map(|index| positions[*index as usize]);
        let bounds = corners.fold(Aabb::EMPTY, Aabb::union_point);
        let bounds = if triangles.is_empty() { EMPTY_SCENE } else { bounds };
        Self { positions, triangles, frame, bounds }
    }

    /// The vertices, in the mesh's frame.
    #[must_use]
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Three vertex indices a triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    #[must_use]
    #[inline]
    pub fn triangle(&self, index: usize) -> [[f32; 3]; 3] {
        self.triangles[index].map(|vertex| self.positions[vertex as usize])
    }

    /// The unit normal of a triangle, toward where its corners are seen counter-clockwise; `None`
    /// if it has no area. Worked out in double precision and rounded once.
    ///
    /// ```
    /// use kdray::Mesh;
    ///
    /// let corners = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    /// let mesh = Mesh::new(&corners, &[[0, 1, 2], [0, 2, 1], [0, 1, 1]])?;
    /// assert_eq!(mesh.normal(0), Some([0.0, 0.0, 1.0]));
    /// assert_eq!(mesh.normal(1), Some([0.0, 0.0, -1.0]));
    /// assert_eq!(mesh.normal(2), None);
    /// # Ok::<(), kdray::MeshError>(())
    /// ```
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    #[must_use]
    pub fn normal(&self, index: usize) -> Option<[f32; 3]> {
        let [a, b, c] = self.triangle(index).map(|corner| corner.map(f64::from));
        let normal = cross(minus(b, a), minus(c, a));
        let length = dot(normal, normal).sqrt();
        (length > 0.0).then(|| normal.map(|component| (component / length) as f32))
    }

    /// Bounds of all triangles, in the mesh's frame; the point zero if there are none.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Where the mesh stands in the world.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// A fingerprint of the triangles, by which a tree knows its mesh.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        for triangle in 0..self.triangles.len() {
            hash.update(bytemuck::bytes_of(&self.triangle(triangle)));
        }
        hash.update(bytemuck::bytes_of(&self.frame.origin));
        hash.update(&self.frame.scale.to_le_bytes());
        hash.digest()
    }
}

/// The bounds of a mesh without triangles.
const EMPTY_SCENE: Aabb = Aabb { lower: [0.0; 3], upper: [0.0; 3] };

fn check_indices(vertices: usize, triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    if triangles.len() > Mesh::MAX_TRIANGLES {
        let limit = Mesh::MAX_TRIANGLES;
        return Err(MeshError::TooLarge { triangles: triangles.len(), limit });
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(index) = corners.iter().find(|index| **index as usize >= vertices) {
            return Err(MeshError::IndexOutOfRange { triangle, index: *index, vertices });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[u32; 3]; 1] = [[0, 1, 2]];

    #[test]
    fn map_coordinates_keep_their_millimetres() {
        let corner = [4_512_345.678_f64, 5_412_345.125, 312.5];
        let offset = |x: f64, y: f64| [corner[0] + x, corner[1] + y, corner[2]];
        let positions = [offset(0.0, 0.0), offset(0.001, 0.0), offset(0.0, 10.0)];
        let mesh = Mesh::from_f64(&positions, &TRIANGLE).unwrap();
        for (local, world) in mesh.positions().iter().zip(positions) {
            let back = mesh.frame().world_point(*local);
            for axis in 0..3 {
                assert!((back[axis] - world[axis]).abs() < 1e-6, "{back:?} {world:?}");
            }
        }
    }

    #[test]
    fn the_first_vertex_that_is_not_finite_is_named() {
        let positions = [[0.0; 3], [1.0, f32::NAN, 0.0], [f32::INFINITY; 3]];
        let error = Mesh::new(&positions, &TRIANGLE).unwrap_err();
        assert!(error.to_string().starts_with("vertex 1 is not finite"), "{error}");
    }

    #[test]
    fn triangles_of_such_vertices_can_be_dropped() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f64::NAN; 3]];
        let triangles = [[0, 1, 2], [1, 2, 3]];
        let (mesh, dropped) = Mesh::dropping_non_finite(&positions, &triangles).unwrap();
        assert_eq!((mesh.triangles(), dropped), (&triangles[..1], 1));
    }

    #[test]
    fn an_index_out_of_range_is_named() {
        let error = Mesh::new(&[[0.0; 3]; 3], &[[0, 1, 2], [0, 1, 7]]).unwrap_err();
        assert_eq!(error, MeshError::IndexOutOfRange { triangle: 1, index: 7, vertices: 3 });
    }

    #[test]
    fn unused_vertices_do_not_widen_the_bounds() {
        let positions = [[0.0; 3], [1.0; 3], [0.0, 1.0, 0.0], [9e9; 3]];
        let mesh = Mesh::new(&positions, &TRIANGLE).unwrap();
        assert_eq!(mesh.bounds().upper, [1.0; 3]);
    }
}
