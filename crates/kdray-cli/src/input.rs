//! Meshes and tree files from the disk.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use anyhow::Context;
use kdray::{Mesh, MeshError, Tree};
use kdray_mesh::Loaded;

use crate::arguments::Repair;

/// The built-in scene's name, where a mesh's file name would be.
pub(crate) const SHOWCASE: &str = "showcase";

/// The mesh in the file at `path`. What the loader left out is said on standard error.
pub(crate) fn mesh(path: &Path, repair: &Repair) -> anyhow::Result<Mesh> {
    let loaded = kdray_mesh::load(path)?;
    for note in &loaded.notes {
        eprintln!("kdray: note: {}: {note}", path.display());
    }
    sound(&loaded, repair, path).with_context(|| path.display().to_string())
}

/// The built-in scene with about this many triangles.
pub(crate) fn showcase(triangles: usize) -> anyhow::Result<Mesh> {
    Ok(kdray_mesh::generate::showcase(triangles).mesh()?)
}

fn sound(loaded: &Loaded, repair: &Repair, path: &Path) -> anyhow::Result<Mesh> {
    if repair.drop_non_finite {
        let (mesh, dropped) = loaded.mesh_dropping_non_finite()?;
        if dropped > 0 {
            eprintln!("kdray: note: {}: {dropped} triangles are not finite", path.display());
        }
        return Ok(mesh);
    }
    loaded.mesh().map_err(|error| match error {
        MeshError::NonFinite { .. } => {
            anyhow::anyhow!("{error} (--drop-non-finite leaves such triangles out)")
        }
        other => other.into(),
    })
}

/// Whether the file at `path` begins like a tree file.
pub(crate) fn is_tree(path: &Path) -> anyhow::Result<bool> {
    let read = || {
        let mut start = Vec::new();
        File::open(path)?.take(8).read_to_end(&mut start)?;
        anyhow::Ok(start == b"kdray-kd")
    };
    read().with_context(|| path.display().to_string())
}

/// The tree in the file at `path`, used where it is.
pub(crate) fn tree(path: &Path) -> anyhow::Result<Tree> {
    let open = || {
        let file = File::open(path)?;
        // SAFETY: Nothing here writes to the file. Another program that changes it meanwhile breaks
        // what the map promises, as with every mapped file; trees are replaced by renaming.
        let map = unsafe { memmap2::Mmap::map(&file)? };
        anyhow::Ok(Tree::from_shared(Arc::new(map))?)
    };
    open().with_context(|| path.display().to_string())
}
