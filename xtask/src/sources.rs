//! The files of the repository that people write.

use std::io::{Error, Result};
use std::path::Path;

/// A text file.
pub(crate) struct Source {
    /// Its path from the root of the repository, with slashes.
    pub(crate) path: String,
    pub(crate) text: String,
}

/// Folders of things that are made and not written.
const MADE: [&str; 2] = ["target", "node_modules"];

/// All files below `root` with one of `extensions`, in order of their paths.
pub(crate) fn read(root: &Path, extensions: &[&str]) -> Result<Vec<Source>> {
    let mut sources = Vec::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root.join(&folder))? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = if folder.is_empty() { name.clone() } else { format!("{folder}/{name}") };
            let is_made = name.starts_with('.') || MADE.contains(&name.as_str());
            if entry.file_type()?.is_dir() {
                folders.extend((!is_made).then_some(path));
            } else if name.rsplit_once('.').is_some_and(|(_, end)| extensions.contains(&end)) {
                sources.push(Source { text: read_text(root, &path)?, path });
            }
        }
    }
    sources.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(sources)
}

/// The text of a file; an error names it.
pub(crate) fn read_text(root: &Path, path: &str) -> Result<String> {
    let named = |error: Error| Error::new(error.kind(), format!("{path}: {error}"));
    std::fs::read_to_string(root.join(path)).map_err(named)
}
