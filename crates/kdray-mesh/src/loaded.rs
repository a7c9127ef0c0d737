//! A mesh as it comes from a file or a generator.

use kdray::{Mesh, MeshError};

use crate::error::{LoadError, Place};
use crate::faces::Faces;

/// Positions and triangles, before they become a [`kdray::Mesh`].
///
/// From a loader every index is in range; positions are as the file has them, so they can be
/// infinite or not a number. The turning of corners (which side is the front) is the file's.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Loaded {
    /// Vertex positions, in the units of the file.
    pub positions: Vec<[f64; 3]>,
    /// Three indices into `positions` a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// What was left out or repaired on the way, in plain sentences; empty for most files.
    pub notes: Vec<String>,
}

impl Loaded {
    /// The mesh to build a tree over.
    ///
    /// # Errors
    /// A position that is not finite; see [`Mesh::from_f64`].
    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        Mesh::from_f64(&self.positions, &self.triangles)
    }

    /// The mesh without the triangles that have a corner which is not finite, and how many those were.
    ///
    /// # Errors
    /// See [`Mesh::dropping_non_finite`].
    pub fn mesh_dropping_non_finite(&self) -> Result<(Mesh, usize), MeshError> {
        Mesh::dropping_non_finite(&self.positions, &self.triangles)
    }

    /// Positions and polygons made into triangles, every index checked.
    pub(crate) fn from_faces(positions: Vec<[f64; 3]>, faces: &Faces) -> Result<Self, LoadError> {
        check_vertex_count(positions.len())?;
        let mut loaded = Self { positions, ..Self::default() };
        loaded.triangles = faces.triangles(&loaded.positions, &mut loaded.notes)?;
        Ok(loaded)
    }
}

/// Refuses more vertices than a 32-bit index can name.
pub(crate) fn check_vertex_count(vertices: usize) -> Result<(), LoadError> {
    if u32::try_from(vertices).is_ok() {
        return Ok(());
    }
    let reason = format!("{vertices} vertices; a mesh can have {}", u32::MAX);
    Err(LoadError::unsupported(Place::whole(), reason))
}
