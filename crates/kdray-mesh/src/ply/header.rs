//! The header of a PLY file: elements, their properties, and where the body starts.

use crate::error::{LoadError, Place};
use crate::text::{Dialect, Scanner, quoted};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Byte offset of the body.
    pub(super) body: usize,
    /// Lines of the header.
    pub(super) lines: usize,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    /// Rows, as claimed.
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the length, for lists.
    pub(super) list: Option<Scalar>,
    /// The type of the value, or of each value of the list.
    pub(super) scalar: Scalar,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a value in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// Reads the header, up to the first byte of the body.
pub(super) fn parse(bytes: &[u8]) -> Result<Header, LoadError> {
    let mut scanner = Scanner::new(bytes, Dialect::default());
    if scanner.word() != Some(b"ply") {
        return Err(LoadError::malformed(
            scanner.place(),
            "a PLY file starts with the line \"ply\"",
        ));
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let is_more = scanner.next_line();
        let words = words_of_line(&mut scanner);
        match words[..] {
            [b"end_header", ..] => break,
            _ if !is_more => {
                let reason = "there is no line \"end_header\"";
                return Err(LoadError::truncated(scanner.place(), reason));
            }
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", name, _] => encoding = Some(parse_encoding(name, &scanner)?),
            [b"element", name, count] => add_element(&mut elements, name, count, &scanner)?,
            [b"property", ref rest @ ..] => add_property(&mut elements, rest, &scanner)?,
            [word, ..] => return Err(not_understood(word, &scanner)),
        }
    }
    let Some(encoding) = encoding else {
        return Err(LoadError::malformed(Place::whole(), "the header has no format line"));
    };
    scanner.next_line();
    Ok(Header { encoding, elements, body: scanner.offset(), lines: scanner.line() - 1 })
}

/// The words of the line, few of which matter; a header line of the format has five at most.
fn words_of_line<'a>(scanner: &mut Scanner<'a>) -> Vec<&'a [u8]> {
    std::iter::from_fn(|| scanner.word()).take(8).collect()
}

fn parse_encoding(name: &[u8], scanner: &Scanner) -> Result<Encoding, LoadError> {
    match name {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(LoadError::malformed(scanner.place(), format!("unknown format {}", quoted(name)))),
    }
}

fn add_element(
    elements: &mut Vec<Element>,
    name: &[u8],
    count: &[u8],
    scanner: &Scanner,
) -> Result<(), LoadError> {
    let name = String::from_utf8_lossy(name).into_owned();
    let parsed = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
    let Some(parsed) = parsed else {
        let reason = format!("{} is not a count of rows", quoted(count));
        return Err(LoadError::malformed(scanner.place(), reason));
    };
    if elements.iter().any(|element| element.name == name) {
        return Err(LoadError::malformed(scanner.place(), format!("a second element {name}")));
    }
    elements.push(Element { name, count: parsed, properties: Vec::new() });
    Ok(())
}

fn add_property(
    elements: &mut [Element],
    words: &[&[u8]],
    scanner: &Scanner,
) -> Result<(), LoadError> {
    let Some(element) = elements.last_mut() else {
        return Err(LoadError::malformed(scanner.place(), "a property before the first element"));
    };
    let (list, scalar, name) = match *words {
        [b"list", length, scalar, name] => (Some(length), scalar, name),
        [scalar, name] => (None, scalar, name),
        _ => {
            return Err(LoadError::malformed(
                scanner.place(),
                "a property needs a type and a name",
            ));
        }
    };
    let parse = |word| Scalar::parse(word).ok_or_else(|| not_understood(word, scanner));
    let property = Property {
        name: String::from_utf8_lossy(name).into_owned(),
        list: list.map(parse).transpose()?,
        scalar: parse(scalar)?,
    };
    if element.properties.iter().any(|other| other.name == property.name) {
        let reason = format!("a second property {} of {}", property.name, element.name);
        return Err(LoadError::malformed(scanner.place(), reason));
    }
    element.properties.push(property);
    Ok(())
}

fn not_understood(word: &[u8], scanner: &Scanner) -> LoadError {
    LoadError::malformed(scanner.place(), format!("{} is not part of a PLY header", quoted(word)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_with_comments_and_crlf() {
        let text = b"ply\r\ncomment a b\r\nformat binary_big_endian 1.0\r\nelement face 2\r\n\
            property list uchar int vertex_indices\r\nend_header\r\n\x01";
        let header = parse(text).expect("a sound header");
        assert_eq!((header.encoding, header.body), (Encoding::BigEndian, text.len() - 1));
        assert_eq!(header.elements[0].count, 2);
        assert_eq!(header.elements[0].properties[0].list, Some(Scalar::U8));
    }
}
