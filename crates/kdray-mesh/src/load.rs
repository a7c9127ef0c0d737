//! The two ways in: a path, or bytes.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path};

use crate::error::{LoadError, Place, Reason};
use crate::{Format, Loaded, gltf, obj, off, ply, stl};

/// Loads the mesh in the file at `path`.
///
/// The extension says the format; where it says nothing, the content does. Buffers that a glTF file
/// keeps in files of their own are found relative to it.
///
/// ```
/// let path = std::env::temp_dir().join("kdray-doc-triangle.obj");
/// std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
/// let loaded = kdray_mesh::load(&path)?;
/// assert_eq!(loaded.triangles, [[0, 1, 2]]);
/// let mesh = loaded.mesh()?;
/// assert_eq!(mesh.bounds().upper, [1.0, 1.0, 0.0]);
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The file cannot be read, is in no known format, or breaks the rules of its format. The error names
/// the file, the place in it and the reason.
pub fn load(path: impl AsRef<Path>) -> Result<Loaded, LoadError> {
    let path = path.as_ref();
    load_file(path).map_err(|error| error.in_file(path))
}

fn load_file(path: &Path) -> Result<Loaded, LoadError> {
    let bytes =
        fs::read(path).map_err(|error| LoadError::new(Place::whole(), Reason::Io(error)))?;
    let format = Format::from_extension(path).or_else(|| Format::sniff(&bytes));
    let reason = if bytes.is_empty() { Reason::Empty } else { Reason::UnknownFormat };
    let format = format.ok_or_else(|| LoadError::new(Place::whole(), reason))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    read_with(&bytes, format, |name, limit| read_beside(folder, name, limit))
}

/// Reads the mesh in `bytes`, which must hold all that it needs.
///
/// ```
/// use kdray_mesh::{Format, read};
/// let loaded = read(b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", Format::Off)?;
/// assert_eq!(loaded.positions.len(), 3);
/// # Ok::<(), kdray_mesh::LoadError>(())
/// ```
///
/// # Errors
/// As for [`load`]; and where a glTF file refers to another file.
pub fn read(bytes: &[u8], format: Format) -> Result<Loaded, LoadError> {
    let nowhere = |_: &str, _| Err(io::Error::other("it is in another file, and none was given"));
    read_with(bytes, format, nowhere)
}

/// Reads the mesh in `bytes`, and asks `external` for the files that a glTF file refers to.
///
/// `external` gets the decoded relative path and how many bytes are of use at most.
///
/// # Errors
/// As for [`load`].
pub fn read_with(
    bytes: &[u8],
    format: Format,
    external: impl Fn(&str, u64) -> io::Result<Vec<u8>>,
) -> Result<Loaded, LoadError> {
    if bytes.is_empty() {
        return Err(LoadError::new(Place::whole(), Reason::Empty));
    }
    match format {
        Format::Ply => ply::read(bytes),
        Format::Obj => obj::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Off => off::read(bytes),
        Format::Gltf => gltf::read(bytes, &external),
    }
}

/// At most `limit` bytes of the plain file `name` in `folder` or below.
pub(crate) fn read_beside(folder: &Path, name: &str, limit: u64) -> io::Result<Vec<u8>> {
    let below = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    if !Path::new(name).components().all(below) {
        return Err(io::Error::other("it is outside the folder of the file"));
    }
    let path = folder.join(name);
    if !fs::metadata(&path)?.is_file() {
        return Err(io::Error::other("it is not a plain file"));
    }
    let mut bytes = Vec::new();
    File::open(&path)?.take(limit).read_to_end(&mut bytes)?;
    Ok(bytes)
}
