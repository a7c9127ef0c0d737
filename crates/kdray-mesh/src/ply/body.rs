//! The rows of a PLY file, value by value, in its three encodings.

use super::header::{Header, Property, Scalar};
use crate::error::Place;
use crate::text::{Dialect, Scanner, number};

/// What can be wrong with a row. Small, because it is made for every value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fault {
    /// The file ends.
    End,
    /// The line ends.
    Missing,
    /// The line goes on.
    Surplus,
    NotANumber,
    /// A list of this length cannot be.
    Length(f64),
    /// This is not a vertex index.
    Index(f64),
}

/// A source of values. Every scalar of the format is an `f64` without loss.
pub(super) trait Body {
    fn start_row(&mut self);
    fn value(&mut self, scalar: Scalar) -> Result<f64, Fault>;
    fn end_row(&mut self) -> Result<(), Fault>;
    /// Bytes that are left.
    fn left(&self) -> usize;
    /// The fewest bytes a value can take.
    fn least_scalar_size(&self, scalar: Scalar) -> usize;
    /// Where the last value read stands.
    fn place(&self) -> Place;
    /// The line of this row, where there are lines.
    fn line(&self) -> Option<usize>;
    /// How many vertices the header announces.
    fn vertices(&self) -> usize;

    /// The fewest bytes a property can take.
    fn least_size(&self, property: &Property) -> usize {
        self.least_scalar_size(property.list.unwrap_or(property.scalar))
    }
}

/// The body of an ASCII file: one row a line; blank lines do not count.
pub(super) struct Ascii<'a> {
    scanner: Scanner<'a>,
    header_lines: usize,
    vertices: usize,
    /// The first word of the row.
    first: Option<&'a [u8]>,
    is_at_end: bool,
    row_line: usize,
}

impl<'a> Ascii<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self {
            scanner: Scanner::new(&bytes[header.body..], Dialect::default()),
            header_lines: header.lines,
            vertices: announced_vertices(header),
            first: None,
            is_at_end: false,
            row_line: 0,
        }
    }
}

impl Body for Ascii<'_> {
    fn start_row(&mut self) {
        self.first = self.scanner.word_anywhere();
        self.is_at_end = self.first.is_none();
        self.row_line = self.scanner.line();
    }

    fn value(&mut self, _: Scalar) -> Result<f64, Fault> {
        let missing = if self.is_at_end { Fault::End } else { Fault::Missing };
        let word = self.first.take().or_else(|| self.scanner.word()).ok_or(missing)?;
        number(word).ok_or(Fault::NotANumber)
    }

    fn end_row(&mut self) -> Result<(), Fault> {
        if self.scanner.word().is_some() { Err(Fault::Surplus) } else { Ok(()) }
    }

    fn left(&self) -> usize {
        self.scanner.left()
    }

    fn least_scalar_size(&self, _: Scalar) -> usize {
        1
    }

    fn place(&self) -> Place {
        Place::line(self.header_lines + self.row_line)
    }

    fn line(&self) -> Option<usize> {
        Some(self.header_lines + self.row_line)
    }

    fn vertices(&self) -> usize {
        self.vertices
    }
}

/// The body of a binary file, most significant byte first if `BIG`.
pub(super) struct Binary<'a, const BIG: bool> {
    bytes: &'a [u8],
    rest: &'a [u8],
    vertices: usize,
}

impl<'a, const BIG: bool> Binary<'a, BIG> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self { bytes, rest: &bytes[header.body..], vertices: announced_vertices(header) }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let (head, rest) = self.rest.split_first_chunk::<N>().ok_or(Fault::End)?;
        self.rest = rest;
        let mut bytes = *head;
        if BIG {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl<const BIG: bool> Body for Binary<'_, BIG> {
    fn start_row(&mut self) {}

    fn value(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        Ok(match scalar {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn end_row(&mut self) -> Result<(), Fault> {
        Ok(())
    }

    fn left(&self) -> usize {
        self.rest.len()
    }

    fn least_scalar_size(&self, scalar: Scalar) -> usize {
        scalar.size()
    }

    fn place(&self) -> Place {
        Place::byte(self.bytes.len() - self.rest.len())
    }

    fn line(&self) -> Option<usize> {
        None
    }

    fn vertices(&self) -> usize {
        self.vertices
    }
}

fn announced_vertices(header: &Header) -> usize {
    header
        .elements
        .iter()
        .find(|element| element.name == "vertex")
        .map_or(0, |element| element.count)
}
