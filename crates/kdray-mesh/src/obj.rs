//! Wavefront OBJ: the `v` and `f` statements; polygons, negative indices, joined lines.
//!
//! A vertex can come after the face that uses it. Texture coordinates, normals, colours, groups and
//! materials are stepped over; lines, points and free-form surfaces too.
//!
//! A parser of our own, because `tobj` 4.0 knows no joined lines, gives errors without a place, triangulates
//! concave polygons wrongly, and splits vertices where groups meet, which opens closed meshes.

use crate::Loaded;
use crate::error::{LoadError, Place, Reason};
use crate::faces::Faces;
use crate::text::{Dialect, Scanner, coordinate, quoted};

const DIALECT: Dialect = Dialect { comment: Some(b'#'), continuation: true };

/// Reads an OBJ file.
pub(crate) fn read(bytes: &[u8]) -> Result<Loaded, LoadError> {
    let mut obj = Obj::new(bytes);
    loop {
        let line = obj.scanner.line();
        match obj.scanner.word() {
            Some(b"v") => obj.vertex(line)?,
            Some(b"f" | b"fo") => obj.face(line)?,
            Some(b"surf" | b"curv" | b"curv2") => obj.free_form += 1,
            Some(word) if !is_known(word) => {
                obj.unknown.get_or_insert((line, word));
            }
            _ => {}
        }
        if !obj.scanner.next_line() {
            return obj.finish();
        }
    }
}

struct Obj<'a> {
    scanner: Scanner<'a>,
    positions: Vec<[f64; 3]>,
    faces: Faces,
    free_form: usize,
    unknown: Option<(usize, &'a [u8])>,
}

impl<'a> Obj<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            scanner: Scanner::new(bytes, DIALECT),
            positions: Vec::new(),
            faces: Faces::default(),
            free_form: 0,
            unknown: None,
        }
    }

    fn vertex(&mut self, line: usize) -> Result<(), LoadError> {
        let mut position = [0.0; 3];
        for value in &mut position {
            let place = Place::line(line).at_item(format!("vertex {}", self.positions.len()));
            *value = coordinate(self.scanner.word(), place)?;
        }
        self.positions.push(position);
        Ok(())
    }

    fn face(&mut self, line: usize) -> Result<(), LoadError> {
        while let Some(word) = self.scanner.word() {
            let corner = self.corner(word).map_err(|reason| {
                LoadError::new(
                    Place::line(line).at_item(format!("face {}", self.faces.len())),
                    reason,
                )
            })?;
            self.faces.corner(corner);
        }
        self.faces.end_face(Some(line));
        Ok(())
    }

    /// The vertex that `v`, `v/vt`, `v//vn` or `v/vt/vn` names, counted from 0.
    fn corner(&self, word: &[u8]) -> Result<u32, Reason> {
        let vertices = self.positions.len();
        let slot = word.split(|&byte| byte == b'/').next().unwrap_or(word);
        let index: i64 = std::str::from_utf8(slot)
            .ok()
            .and_then(|slot| slot.parse().ok())
            .ok_or_else(|| Reason::Malformed(format!("{} is not a corner", quoted(word))))?;
        let resolved = match index {
            0 => {
                return Err(Reason::Malformed("vertex index 0: OBJ counts from 1".into()));
            }
            1.. => index - 1,
            _ => index.saturating_add_unsigned(vertices as u64),
        };
        u32::try_from(resolved).map_err(|_| Reason::IndexOutOfRange { index, vertices })
    }

    fn finish(self) -> Result<Loaded, LoadError> {
        if let (0, 0, Some((line, word))) = (self.positions.len(), self.faces.len(), self.unknown) {
            let reason = format!("{} is not an OBJ statement", quoted(word));
            return Err(LoadError::malformed(Place::line(line), reason));
        }
        let mut loaded = Loaded::from_faces(self.positions, &self.faces)?;
        if self.free_form > 0 {
            loaded.notes.push(format!("{} free-form curves and surfaces left out", self.free_form));
        }
        Ok(loaded)
    }
}

/// Statements that say nothing about triangles, and extensions that begin with an odd sign.
fn is_known(word: &[u8]) -> bool {
    const KNOWN: &[&[u8]] = &[
        b"vt",
        b"vn",
        b"vp",
        b"p",
        b"l",
        b"o",
        b"g",
        b"s",
        b"mg",
        b"usemtl",
        b"mtllib",
        b"usemap",
        b"maplib",
        b"cstype",
        b"deg",
        b"bmat",
        b"step",
        b"parm",
        b"trim",
        b"hole",
        b"scrv",
        b"sp",
        b"end",
        b"con",
        b"bevel",
        b"c_interp",
        b"d_interp",
        b"lod",
        b"shadow_obj",
        b"trace_obj",
        b"ctech",
        b"stech",
        b"call",
        b"csh",
    ];
    KNOWN.contains(&word)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VERTICES: &str = "v 0 0 0\nv 1. 0 0 1\nv 1e0 1 0\n";

    #[test]
    fn faces_before_vertices_and_every_corner_form() {
        let text = format!("f 1/1 2//7 \\\n 3/1/1\n{VERTICES}f -3 -2 -1\n");
        let loaded = read(text.as_bytes()).expect("a sound file");
        assert_eq!(loaded.triangles, [[0, 1, 2], [0, 1, 2]]);
        assert_eq!(loaded.positions[1], [1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_bad_corner_is_named_as_the_file_has_it() {
        let text = format!("{VERTICES}f 1 2 -4\n");
        let message = read(text.as_bytes()).expect_err("-4 of 3 vertices").to_string();
        assert_eq!(
            message,
            "line 4, face 0: vertex index -4 is out of range: there are 3 vertices"
        );
    }
}
