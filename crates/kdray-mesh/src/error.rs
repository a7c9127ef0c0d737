//! Why a mesh could not be loaded, and where the trouble is.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// A mesh that could not be loaded: which file, where in it, and why.
///
/// The message reads `path: place: reason`, with the parts that are known.
#[derive(Debug)]
pub struct LoadError {
    /// The file, when the input came from one.
    pub path: Option<PathBuf>,
    /// Where in the input.
    pub place: Place,
    /// What is wrong there.
    pub reason: Reason,
}

/// A place in a file, as closely as it is known.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Place {
    /// Line, counted from 1.
    pub line: Option<usize>,
    /// Byte offset from the start of the file.
    pub byte: Option<usize>,
    /// The item in the words of the format, such as `face 3` or `accessor 0`, counted from 0.
    pub item: Option<String>,
}

/// What is wrong with an input.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The file, or a file it refers to, cannot be read.
    #[error("{0}")]
    Io(io::Error),
    /// Neither the name nor the content tells the format.
    #[error("neither the name nor the content is that of a PLY, OBJ, STL, OFF, glTF or GLB file")]
    UnknownFormat,
    /// There is not one byte.
    #[error("the file is empty")]
    Empty,
    /// The content ends before everything that is announced has come.
    #[error("the content ends early: {0}")]
    Truncated(String),
    /// The content breaks the rules of its format.
    #[error("{0}")]
    Malformed(String),
    /// A face names a vertex that is not there.
    #[error("vertex index {index} is out of range: there are {vertices} vertices")]
    IndexOutOfRange {
        /// The index as the file has it.
        index: i64,
        /// How many vertices there are.
        vertices: usize,
    },
    /// The content is sound, but uses a part of the format that is not read here.
    #[error("not supported: {0}")]
    Unsupported(String),
}

impl LoadError {
    pub(crate) fn new(place: Place, reason: Reason) -> Self {
        Self { path: None, place, reason }
    }

    pub(crate) fn malformed(place: Place, reason: impl Into<String>) -> Self {
        Self::new(place, Reason::Malformed(reason.into()))
    }

    pub(crate) fn truncated(place: Place, reason: impl Into<String>) -> Self {
        Self::new(place, Reason::Truncated(reason.into()))
    }

    pub(crate) fn unsupported(place: Place, reason: impl Into<String>) -> Self {
        Self::new(place, Reason::Unsupported(reason.into()))
    }

    /// The same error, said of the file at `path`.
    pub(crate) fn in_file(mut self, path: impl Into<PathBuf>) -> Self {
        self.path.get_or_insert_with(|| path.into());
        self
    }
}

impl Place {
    /// The input as a whole.
    pub(crate) fn whole() -> Self {
        Self::default()
    }

    pub(crate) fn line(line: usize) -> Self {
        Self { line: Some(line), ..Self::default() }
    }

    pub(crate) fn byte(byte: usize) -> Self {
        Self { byte: Some(byte), ..Self::default() }
    }

    pub(crate) fn item(item: impl Into<String>) -> Self {
        Self { item: Some(item.into()), ..Self::default() }
    }

    /// This place, narrowed to an item of the format.
    pub(crate) fn at_item(mut self, item: impl Into<String>) -> Self {
        self.item = Some(item.into());
        self
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            self.line.map(|line| format!("line {line}")),
            self.byte.map(|byte| format!("byte {byte}")),
            self.item.clone(),
        ];
        let known: Vec<String> = parts.into_iter().flatten().collect();
        f.write_str(&known.join(", "))
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(path) = &self.path {
            write!(f, "{}: ", path.display())?;
        }
        if self.place != Place::default() {
            write!(f, "{}: ", self.place)?;
        }
        self.reason.fmt(f)
    }
}

impl Error for LoadError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match &self.reason {
            Reason::Io(error) => Some(error),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_file_place_and_reason() {
        let place = Place::line(22).at_item("face 0");
        let reason = Reason::IndexOutOfRange { index: 12, vertices: 8 };
        let error = LoadError::new(place, reason).in_file("cube.obj");
        assert_eq!(
            error.to_string(),
            "cube.obj: line 22, face 0: vertex index 12 is out of range: there are 8 vertices"
        );
    }
}
