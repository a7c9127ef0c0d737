//! PLY: ASCII, little-endian and big-endian; any elements, properties and scalar types in any order.
//!
//! Read are the `x`, `y` and `z` of `vertex`, the list `vertex_indices` (or `vertex_index`) of `face`,
//! and the list of the same name of `tristrips`, where -1 starts a new strip. The rest is stepped over.
//!
//! A parser of our own, because `ply-rs-bw` 4.0 refuses ASCII numbers such as `.5`, `1.` and `nan`, merges
//! properties of one name (and then misreads the rows), and for an element without properties makes as
//! many values as the header claims.

mod body;
mod header;

use self::body::{Ascii, Binary, Body, Fault};
use self::header::{Element, Encoding, Header, Scalar};
use crate::Loaded;
use crate::error::{LoadError, Place, Reason};
use crate::faces::Faces;

/// Reads a PLY file.
pub(crate) fn read(bytes: &[u8]) -> Result<Loaded, LoadError> {
    let header = header::parse(bytes)?;
    match header.encoding {
        Encoding::Ascii => read_elements(&header, Ascii::new(bytes, &header)),
        Encoding::LittleEndian => read_elements(&header, Binary::<false>::new(bytes, &header)),
        Encoding::BigEndian => read_elements(&header, Binary::<true>::new(bytes, &header)),
    }
}

fn read_elements(header: &Header, mut body: impl Body) -> Result<Loaded, LoadError> {
    let mut sink = Sink::default();
    if !header.elements.iter().any(|element| element.name == "vertex") {
        return Err(LoadError::malformed(Place::whole(), "the header declares no vertex element"));
    }
    for element in &header.elements {
        let slots = slots(element)?;
        if slots.is_empty() {
            continue;
        }
        check_claim(element, &body)?;
        for row in 0..element.count {
            read_row(&slots, &mut body, &mut sink)
                .map_err(|fault| explain(fault, element, row, &body))?;
        }
    }
    Loaded::from_faces(sink.positions, &sink.faces)
}

/// Refuses more rows than the rest of the file can hold.
fn check_claim(element: &Element, body: &impl Body) -> Result<(), LoadError> {
    let Element { count, ref name, ref properties } = *element;
    let left = body.left();
    let least: usize = properties.iter().map(|property| body.least_size(property)).sum();
    if count.checked_mul(least).is_some_and(|bytes| bytes <= left) {
        return Ok(());
    }
    let reason = format!("{count} rows of element {name} are announced, but {left} bytes are left");
    Err(LoadError::truncated(body.place(), reason))
}

/// What becomes of a property.
#[derive(Clone, Copy, PartialEq)]
enum Use {
    Axis(usize),
    Corners,
    Strips,
    Nothing,
}

/// One property: its types, and its use.
struct Slot {
    list: Option<Scalar>,
    scalar: Scalar,
    usage: Use,
}

/// The uses of an element's properties; an error when it lacks what its name promises.
fn slots(element: &Element) -> Result<Vec<Slot>, LoadError> {
    let usage = |name: &str, is_list: bool| match (element.name.as_str(), name, is_list) {
        ("vertex", "x", false) => Use::Axis(0),
        ("vertex", "y", false) => Use::Axis(1),
        ("vertex", "z", false) => Use::Axis(2),
        ("face", "vertex_indices" | "vertex_index", true) => Use::Corners,
        ("tristrips", "vertex_indices" | "vertex_index", true) => Use::Strips,
        _ => Use::Nothing,
    };
    let slots: Vec<Slot> = element
        .properties
        .iter()
        .map(|property| Slot {
            list: property.list,
            scalar: property.scalar,
            usage: usage(&property.name, property.list.is_some()),
        })
        .collect();
    let needed: &[(Use, &str)] = match element.name.as_str() {
        "vertex" => &[(Use::Axis(0), "x"), (Use::Axis(1), "y"), (Use::Axis(2), "z")],
        "face" => &[(Use::Corners, "list vertex_indices")],
        "tristrips" => &[(Use::Strips, "list vertex_indices")],
        _ => &[],
    };
    for &(usage, name) in needed {
        if element.count > 0 && slots.iter().all(|slot| slot.usage != usage) {
            let place = Place::item(format!("element {}", element.name));
            return Err(LoadError::malformed(place, format!("it has no property {name}")));
        }
    }
    Ok(slots)
}

/// What is read so far.
#[derive(Default)]
struct Sink {
    positions: Vec<[f64; 3]>,
    faces: Faces,
    /// The corners so far of the strip that is being read.
    strip: Vec<u32>,
}

fn read_row(slots: &[Slot], body: &mut impl Body, sink: &mut Sink) -> Result<(), Fault> {
    body.start_row();
    let mut position = None;
    for slot in slots {
        match (slot.list, slot.usage) {
            (None, Use::Axis(axis)) => {
                position.get_or_insert([0.0; 3])[axis] = body.value(slot.scalar)?;
            }
            (None, _) => {
                body.value(slot.scalar)?;
            }
            (Some(count), usage) => read_list(count, slot.scalar, usage, body, sink)?,
        }
    }
    sink.positions.extend(position);
    body.end_row()
}

fn read_list(
    count: Scalar,
    scalar: Scalar,
    usage: Use,
    body: &mut impl Body,
    sink: &mut Sink,
) -> Result<(), Fault> {
    let count = body.value(count)?;
    let length = whole(count).and_then(|count| usize::try_from(count).ok());
    let length = length.ok_or(Fault::Length(count))?;
    if length > body.left() / body.least_scalar_size(scalar) {
        return Err(Fault::Length(count));
    }
    for _ in 0..length {
        let value = body.value(scalar)?;
        match usage {
            Use::Corners => sink.faces.corner(index(value)?),
            Use::Strips => sink.strip_corner(value, body.line())?,
            Use::Axis(_) | Use::Nothing => {}
        }
    }
    match usage {
        Use::Corners => sink.faces.end_face(body.line()),
        _ => sink.strip.clear(),
    }
    Ok(())
}

impl Sink {
    /// Goes on with a strip: each corner from the third on makes a triangle with the two before it.
    fn strip_corner(&mut self, value: f64, line: Option<usize>) -> Result<(), Fault> {
        if value == -1.0 {
            self.strip.clear();
            return Ok(());
        }
        self.strip.push(index(value)?);
        if let [.., a, b, c] = self.strip[..] {
            let is_turned = self.strip.len().is_multiple_of(2);
            self.faces.triangle(if is_turned { [b, a, c] } else { [a, b, c] }, line);
        }
        Ok(())
    }
}

/// The whole number that `value` is.
fn whole(value: f64) -> Option<i64> {
    let truncated = value as i64;
    (truncated as f64 == value).then_some(truncated)
}

fn index(value: f64) -> Result<u32, Fault> {
    let index = value as u32;
    if f64::from(index) == value { Ok(index) } else { Err(Fault::Index(value)) }
}

/// The error for a row that could not be read.
fn explain(fault: Fault, element: &Element, row: usize, body: &impl Body) -> LoadError {
    let Element { name, count, .. } = element;
    let place = body.place().at_item(format!("{name} {row}"));
    match fault {
        Fault::End => LoadError::truncated(
            place,
            format!("{count} rows of {name} are announced, {row} are here"),
        ),
        Fault::Missing => LoadError::malformed(place, "the line has too few values"),
        Fault::Surplus => LoadError::malformed(place, "the line has too many values"),
        Fault::NotANumber => LoadError::malformed(place, "not a number"),
        Fault::Length(length) => {
            let reason = format!("a list of {length} values, but {} bytes are left", body.left());
            LoadError::malformed(place, reason)
        }
        Fault::Index(value) => match whole(value) {
            Some(index) => {
                let vertices = body.vertices();
                LoadError::new(place, Reason::IndexOutOfRange { index, vertices })
            }
            None => LoadError::malformed(place, format!("{value} is not a vertex index")),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_turn_and_start_anew() {
        let text = "ply\nformat ascii 1.0\nelement tristrips 1\n\
            property list int int vertex_indices\nelement vertex 4\nproperty double x\n\
            property double y\nproperty double z\nend_header\n8 0 1 2 3 -1 3 1 0\n\
            0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
        let loaded = read(text.as_bytes()).expect("a sound file");
        assert_eq!(loaded.triangles, [[0, 1, 2], [2, 1, 3], [3, 1, 0]]);
    }

    #[test]
    fn a_bad_index_is_named_with_its_face() {
        let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n\
            property float y\nproperty float z\nelement face 1\n\
            property list uchar int vertex_index\nend_header\n0 0 0\n3 0 0 CORNER\n";
        for (corner, message) in [
            ("1", "line 11, face 0: vertex index 1 is out of range: there are 1 vertices"),
            ("-2", "line 11, face 0: vertex index -2 is out of range: there are 1 vertices"),
            ("0.5", "line 11, face 0: 0.5 is not a vertex index"),
            ("x", "line 11, face 0: not a number"),
            ("0 0", "line 11, face 0: the line has too many values"),
            ("", "line 11, face 0: the line has too few values"),
        ] {
            let error = read(text.replace("CORNER", corner).as_bytes()).expect_err(message);
            assert_eq!(error.to_string(), message);
        }
    }
}
