//! STL, ASCII and binary; corners at equal positions become one vertex.
//!
//! A file is binary when its length is what a binary file with its count has, or when its first bytes are
//! not text: many binary files start with `solid`. Normals and attributes are stepped over.
//!
//! A parser of our own, because `stl_io` 0.11 stops at the first `endsolid`, so it silently loses all
//! solids but the first, and gives errors without a place.

use std::collections::HashMap;

use crate::Loaded;
use crate::error::{LoadError, Place};
use crate::faces::Faces;
use crate::text::{Dialect, Scanner, coordinate, quoted};

/// Bytes before the first triangle: a free header, and the count.
const HEADER: usize = 84;
/// Bytes of a triangle: a normal, three corners, and an attribute.
const RECORD: usize = 50;

/// Reads an STL file.
pub(crate) fn read(bytes: &[u8]) -> Result<Loaded, LoadError> {
    if !looks_binary(bytes) && looks_ascii(bytes) { read_ascii(bytes) } else { read_binary(bytes) }
}

/// Whether the length is that of a binary file with its count.
pub(crate) fn looks_binary(bytes: &[u8]) -> bool {
    claimed(bytes).is_some_and(|count| bytes.len() as u64 == HEADER as u64 + count * RECORD as u64)
}

/// The count of triangles in a binary header.
fn claimed(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?).into())
}

fn looks_ascii(bytes: &[u8]) -> bool {
    const SAMPLE: usize = 512;
    let sample = &bytes[..bytes.len().min(SAMPLE)];
    sample.trim_ascii_start().starts_with(b"solid") && !sample.contains(&0)
}

fn read_binary(bytes: &[u8]) -> Result<Loaded, LoadError> {
    let Some(count) = claimed(bytes) else {
        let reason = format!("neither ASCII, nor the {HEADER} bytes of a binary header");
        return Err(LoadError::truncated(Place::whole(), reason));
    };
    let records = &bytes[HEADER..];
    let here = (records.len() / RECORD) as u64;
    if here < count {
        let reason = format!("{count} triangles are announced, {here} are here");
        return Err(LoadError::truncated(Place::byte(bytes.len()), reason));
    }
    let mut welded = Welded::default();
    for record in records.chunks_exact(RECORD).take(count as usize) {
        let value = |at: usize| {
            f64::from(f32::from_le_bytes([
                record[at],
                record[at + 1],
                record[at + 2],
                record[at + 3],
            ]))
        };
        for at in [12, 24, 36] {
            welded.corner([value(at), value(at + 4), value(at + 8)]);
        }
        welded.faces.end_face(None);
    }
    let mut loaded = welded.finish()?;
    let surplus = records.len() - count as usize * RECORD;
    if surplus > 0 {
        loaded.notes.push(format!("{surplus} bytes after the last triangle left out"));
    }
    Ok(loaded)
}

/// Reads the keywords of any number of solids; corners count between `outer loop` and `endloop`.
fn read_ascii(bytes: &[u8]) -> Result<Loaded, LoadError> {
    let mut scanner = Scanner::new(bytes, Dialect::default());
    let mut welded = Welded::default();
    let mut loop_line = None;
    while let Some(word) = scanner.word_anywhere() {
        let face = welded.faces.len();
        let place = scanner.place().at_item(format!("facet {face}"));
        match (word.to_ascii_lowercase().as_slice(), loop_line) {
            (b"solid" | b"endsolid", None) => drop(scanner.next_line()),
            (b"facet", None) => step_over_normal(&mut scanner),
            (b"outer", None) => loop_line = Some(scanner.line()),
            (b"loop", Some(_)) | (b"endfacet", None) => {}
            (b"vertex", Some(_)) => {
                let mut position = [0.0; 3];
                for value in &mut position {
                    *value = coordinate(scanner.word_anywhere(), place.clone())?;
                }
                welded.corner(position);
            }
            (b"endloop", Some(_)) => welded.faces.end_face(loop_line.take()),
            _ => {
                let reason = format!("{} is not expected here", quoted(word));
                return Err(LoadError::malformed(place, reason));
            }
        }
    }
    if loop_line.is_some() {
        let place = scanner.place().at_item(format!("facet {}", welded.faces.len()));
        return Err(LoadError::truncated(place, "the facet has no endloop"));
    }
    welded.finish()
}

/// Steps over `normal` and what follows it on the line, which is often not a number.
fn step_over_normal(scanner: &mut Scanner) {
    for _ in 0..4 {
        scanner.word();
    }
}

/// Faces whose equal corners are one vertex, numbered by first appearance.
#[derive(Default)]
struct Welded {
    positions: Vec<[f64; 3]>,
    faces: Faces,
    /// By the bits of a position; the hash is seeded, so no file can make it slow.
    known: HashMap<[u64; 3], u32>,
}

impl Welded {
    fn corner(&mut self, position: [f64; 3]) {
        // Adding zero makes negative zero equal to zero.
        let key = position.map(|value| (value + 0.0).to_bits());
        // Beyond 32 bits `finish` refuses the mesh, whatever the index.
        let fresh = self.positions.len() as u32;
        let index = *self.known.entry(key).or_insert(fresh);
        if index == fresh {
            self.positions.push(position);
        }
        self.faces.corner(index);
    }

    fn finish(self) -> Result<Loaded, LoadError> {
        Loaded::from_faces(self.positions, &self.faces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str = "facet normal nan nan nan outer loop\nvertex 0 0 0\nvertex 1 0 0\n\
        vertex 0 1 -0\nendloop\nendfacet\n";

    #[test]
    fn every_solid_counts_and_corners_weld() {
        let text = format!("solid\nendsolid\nSolid b c\n{FACET}{FACET}endsolid b c\n");
        let loaded = read(text.as_bytes()).expect("two solids");
        assert_eq!((loaded.positions.len(), loaded.triangles.len()), (3, 2));
    }

    #[test]
    fn an_open_facet_is_named() {
        let text = format!("solid a\n{FACET}facet normal 0 0 1\nouter loop\nvertex 0 0 0\n");
        let message = read(text.as_bytes()).expect_err("no endloop").to_string();
        assert!(message.contains("facet 1"), "{message}");
    }
}
