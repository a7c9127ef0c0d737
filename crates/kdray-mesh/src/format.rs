//! Which format a file is in: by its name, else by its first bytes.

use std::path::Path;

use crate::stl;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Polygon file format: ASCII, little-endian and big-endian.
    Ply,
    /// Wavefront OBJ.
    Obj,
    /// Stereolithography: ASCII and binary.
    Stl,
    /// Object file format, with its C, N and ST variants.
    Off,
    /// glTF 2.0: JSON (`.gltf`) and binary (`.glb`), told apart by content.
    Gltf,
}

impl Format {
    /// The format that the extension of `path` names, in any case.
    ///
    /// ```
    /// use kdray_mesh::Format;
    /// assert_eq!(Format::from_extension("scans/Dragon.PLY".as_ref()), Some(Format::Ply));
    /// assert_eq!(Format::from_extension("notes.txt".as_ref()), None);
    /// ```
    pub fn from_extension(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "ply" => Some(Self::Ply),
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "off" | "coff" | "noff" => Some(Self::Off),
            "gltf" | "glb" => Some(Self::Gltf),
            _ => None,
        }
    }

    /// The format that the first bytes of a file look like.
    ///
    /// ```
    /// use kdray_mesh::Format;
    /// assert_eq!(Format::sniff(b"OFF\n8 6 12\n"), Some(Format::Off));
    /// assert_eq!(Format::sniff(b"Dear diary"), None);
    /// ```
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        let text = bytes.trim_ascii_start();
        let word_end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        let word = &text[..word_end];
        match word {
            b"ply" => Some(Self::Ply),
            _ if bytes.starts_with(b"glTF") || text.starts_with(b"{") => Some(Self::Gltf),
            _ if stl::looks_binary(bytes) || word == b"solid" => Some(Self::Stl),
            _ if word.len() <= 8 && word.ends_with(b"OFF") => Some(Self::Off),
            _ if has_obj_statement(text) => Some(Self::Obj),
            _ => None,
        }
    }
}

/// Whether one of the first lines is a vertex or face of an OBJ file.
fn has_obj_statement(text: &[u8]) -> bool {
    const LINES: usize = 200;
    let is_statement = |line: &[u8]| line.starts_with(b"v ") || line.starts_with(b"f ");
    text.split(|&byte| byte == b'\n').take(LINES).any(is_statement)
}
