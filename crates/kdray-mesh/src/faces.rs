//! The polygons of a file, kept until all vertices are known, then made into triangles.

use crate::error::{LoadError, Place, Reason};
use crate::polygon::Triangulator;

/// Polygons in the order of the file.
#[derive(Default)]
pub(crate) struct Faces {
    corners: Vec<u32>,
    /// For each face, where its corners end.
    ends: Vec<usize>,
    /// For each face, its line; empty where the format has no lines.
    lines: Vec<usize>,
}

impl Faces {
    /// Adds a corner to the face that is being read.
    pub(crate) fn corner(&mut self, index: u32) {
        self.corners.push(index);
    }

    /// Ends the face that is being read; `line` is where it stands, in text formats.
    pub(crate) fn end_face(&mut self, line: Option<usize>) {
        self.ends.push(self.corners.len());
        self.lines.extend(line);
    }

    pub(crate) fn triangle(&mut self, corners: [u32; 3], line: Option<usize>) {
        self.corners.extend(corners);
        self.end_face(line);
    }

    /// How many faces have ended.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The triangles of all faces, in order.
    ///
    /// Faces of fewer than three corners are left out, with a note.
    pub(crate) fn triangles(
        &self,
        positions: &[[f64; 3]],
        notes: &mut Vec<String>,
    ) -> Result<Vec<[u32; 3]>, LoadError> {
        let mut triangles = Vec::with_capacity(self.ends.len());
        let mut triangulator = Triangulator::default();
        let (mut start, mut flat, mut tangled) = (0, 0_usize, 0_usize);
        for (face, &end) in self.ends.iter().enumerate() {
            let corners = &self.corners[start..end];
            start = end;
            self.check(face, corners, positions.len())?;
            match *corners {
                [a, b, c] => triangles.push([a, b, c]),
                [] | [_] | [_, _] => flat += 1,
                _ => {
                    let clean = triangulator.triangulate(corners, positions, &mut triangles);
                    tangled += usize::from(!clean);
                }
            }
        }
        note(notes, flat, "of fewer than three corners left out");
        note(
            notes,
            tangled,
            "crossing themselves, or too intricate: some of their triangles overlap",
        );
        Ok(triangles)
    }

    fn check(&self, face: usize, corners: &[u32], vertices: usize) -> Result<(), LoadError> {
        match corners.iter().find(|&&index| index as usize >= vertices) {
            None => Ok(()),
            Some(&index) => {
                let reason = Reason::IndexOutOfRange { index: index.into(), vertices };
                Err(LoadError::new(self.place(face), reason))
            }
        }
    }

    fn place(&self, face: usize) -> Place {
        let place = self.lines.get(face).map_or(Place::whole(), |&line| Place::line(line));
        place.at_item(format!("face {face}"))
    }
}

fn note(notes: &mut Vec<String>, count: usize, what: &str) {
    if count > 0 {
        notes.push(format!("{count} faces {what}"));
    }
}
