//! Meshes and trees from the disk.
//!
//! A tree is kept as the bytes of its mesh, followed by its tree file.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kdray::Mesh;
use memmap2::Mmap;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{Vectors, threes};
use crate::error;
use crate::run::{run, run_owned};
use crate::tree::{Tree, table};

/// Vertices, faces, and what the loader left out, in words.
type Loaded<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i32>>, Vec<String>);

/// The mesh in a file.
#[pyfunction]
pub(crate) fn load(py: Python<'_>, path: PathBuf) -> PyResult<Loaded<'_>> {
    let asked = path.clone();
    let loaded = run_owned(py, 0, move || kdray_mesh::load(&asked))?;
    let loaded = loaded.map_err(|reason| error::load(&reason, &path))?;
    if i32::try_from(loaded.positions.len()).is_err() {
        return Err(error::value(format!(
            "{}: more vertices than an int32 counts",
            path.display()
        )));
    }
    let faces = loaded.triangles.into_iter().map(|face| face.map(|index| index as i32)).collect();
    Ok((table(py, loaded.positions), table(py, faces), loaded.notes))
}

/// The part of a mapped file from a byte on.
struct Rest(Arc<Mmap>, usize);

impl AsRef<[u8]> for Rest {
    fn as_ref(&self) -> &[u8] {
        &self.0[self.1..]
    }
}

#[pymethods]
impl Tree {
    /// The tree of `to_bytes`.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let tree = run(py, 0, None, |_| {
            let (mesh, length) = Mesh::from_bytes(bytes).map_err(error::value)?;
            let tree = kdray::Tree::from_bytes(&bytes[length..]).map_err(error::value)?;
            checked(mesh, tree)
        })?;
        tree?.ready(py, 0)
    }

    /// The tree in a file of `to_bytes`, or in a tree file of the given mesh; used where it is.
    #[staticmethod]
    #[pyo3(signature = (path, mesh=None))]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        mesh: Option<(Vectors<'_>, PyReadonlyArray2<'_, u32>)>,
    ) -> PyResult<Self> {
        let given = match &mesh {
            Some((vertices, faces)) => {
                let (vertices, faces) = (vertices.vertices()?, threes(faces)?);
                Some(run(py, 0, None, |_| vertices.mesh(faces))??)
            }
            None => None,
        };
        let tree = run_owned(py, 0, move || {
            let in_file = |reason: String| error::value(format!("{}: {reason}", path.display()));
            let map = Arc::new(mapped(&path)?);
            let (mesh, start) = match given {
                Some(mesh) => (mesh, 0),
                None => Mesh::from_bytes(&map).map_err(|reason| in_file(reason.to_string()))?,
            };
            let tree = kdray::Tree::from_shared(Arc::new(Rest(map, start)));
            checked(mesh, tree.map_err(|reason| in_file(reason.to_string()))?)
        })?;
        tree?.ready(py, 0)
    }
}

/// The two together, if they belong together.
fn checked(mesh: Mesh, tree: kdray::Tree) -> PyResult<Tree> {
    if !tree.is_of(&mesh) || tree.triangle_count() != mesh.triangles().len() {
        return Err(error::value("the tree is of another mesh"));
    }
    Ok(Tree::new(mesh, tree))
}

fn mapped(path: &Path) -> PyResult<Mmap> {
    let map = File::open(path).and_then(|file| {
        // SAFETY: nothing here writes to the file. Another program that changes it meanwhile breaks
        // what the map promises, as with every mapped file; `save` replaces trees by renaming.
        unsafe { Mmap::map(&file) }
    });
    map.map_err(|reason| error::system(&reason, path))
}
