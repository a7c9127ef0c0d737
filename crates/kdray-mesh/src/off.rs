//! OFF, with the prefixes ST, C and N; comments; colours, normals and texture coordinates stepped over.
//!
//! Each vertex and each face starts on a line of its own, and what follows its coordinates or corners on the
//! line is left out: that is how colours of unknown length can be told from the next vertex. The format is
//! small enough for a parser of our own.

use crate::Loaded;
use crate::error::{LoadError, Place, Reason};
use crate::faces::Faces;
use crate::text::{Dialect, Scanner, coordinate, quoted};

const DIALECT: Dialect = Dialect { comment: Some(b'#'), continuation: false };

/// Reads an OFF file.
pub(crate) fn read(bytes: &[u8]) -> Result<Loaded, LoadError> {
    let mut scanner = Scanner::new(bytes, DIALECT);
    let [vertices, faces] = read_counts(&mut scanner)?;
    // The shortest vertex line is "0 0 0", the shortest face line "0".
    check_claim(&scanner, vertices, 6, "vertices")?;
    let mut positions = Vec::with_capacity(vertices);
    for vertex in 0..vertices {
        scanner.next_line();
        positions.push(read_vertex(&mut scanner, vertex)?);
    }
    check_claim(&scanner, faces, 2, "faces")?;
    let mut polygons = Faces::default();
    for _ in 0..faces {
        scanner.next_line();
        read_face(&mut scanner, vertices, &mut polygons)?;
    }
    Loaded::from_faces(positions, &polygons)
}

/// The header: a keyword, which can be missing or stuck to the first count, then three counts.
fn read_counts(scanner: &mut Scanner) -> Result<[usize; 2], LoadError> {
    let first = scanner.word_anywhere().unwrap_or_default();
    let digits = first.iter().position(u8::is_ascii_digit).unwrap_or(first.len());
    let (keyword, stuck) = first.split_at(digits);
    match keyword {
        b"" | b"OFF" | b"COFF" | b"NOFF" | b"CNOFF" | b"STOFF" | b"STCOFF" | b"STNOFF"
        | b"STCNOFF" => {}
        _ if keyword.ends_with(b"OFF") => {
            let reason = format!("{}: vertices of other than three dimensions", quoted(keyword));
            return Err(LoadError::unsupported(scanner.place(), reason));
        }
        _ => {
            let reason = format!("{} is not an OFF header", quoted(first));
            return Err(LoadError::malformed(scanner.place(), reason));
        }
    }
    let first = if stuck.is_empty() { scanner.word_anywhere() } else { Some(stuck) };
    if first == Some(b"BINARY") {
        return Err(LoadError::unsupported(scanner.place(), "binary OFF"));
    }
    let vertices = read_count(first, scanner)?;
    let second = scanner.word_anywhere();
    // The third count, of edges, is often wrong and never needed.
    Ok([vertices, read_count(second, scanner)?])
}

fn read_count(word: Option<&[u8]>, scanner: &Scanner) -> Result<usize, LoadError> {
    let word = word.ok_or_else(|| LoadError::truncated(scanner.place(), "a count is missing"))?;
    let count = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
    count.ok_or_else(|| {
        LoadError::malformed(scanner.place(), format!("{} is not a count", quoted(word)))
    })
}

/// Refuses more items than the rest of the file can hold, each `least` bytes with its line end.
fn check_claim(
    scanner: &Scanner,
    count: usize,
    least: usize,
    items: &str,
) -> Result<(), LoadError> {
    let left = scanner.left();
    // The last line end can be missing.
    if count.checked_mul(least).is_some_and(|bytes| bytes <= left + 1) {
        return Ok(());
    }
    let reason = format!("{count} {items} are announced, but {left} bytes are left");
    Err(LoadError::truncated(scanner.place(), reason))
}

fn read_vertex(scanner: &mut Scanner, vertex: usize) -> Result<[f64; 3], LoadError> {
    let mut position = [0.0; 3];
    for value in &mut position {
        let word = scanner.word_anywhere();
        *value = coordinate(word, scanner.place().at_item(format!("vertex {vertex}")))?;
    }
    Ok(position)
}

fn read_face(scanner: &mut Scanner, vertices: usize, faces: &mut Faces) -> Result<(), LoadError> {
    let first = scanner.word_anywhere();
    let line = scanner.line();
    let place = || Place::line(line).at_item(format!("face {}", faces.len()));
    let corners = read_count(first, scanner)?;
    if corners > scanner.left() {
        let reason = format!("{corners} corners, but {} bytes are left", scanner.left());
        return Err(LoadError::truncated(place(), reason));
    }
    let mut indices = Vec::with_capacity(corners);
    for _ in 0..corners {
        let word = scanner.word_anywhere().unwrap_or_default();
        let index = std::str::from_utf8(word).ok().and_then(|word| word.parse::<i64>().ok());
        let Some(index) = index else {
            return Err(LoadError::malformed(place(), format!("{} is not an index", quoted(word))));
        };
        let fits = u32::try_from(index);
        indices.push(
            fits.map_err(|_| LoadError::new(place(), Reason::IndexOutOfRange { index, vertices }))?,
        );
    }
    indices.into_iter().for_each(|index| faces.corner(index));
    faces.end_face(Some(line));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_every_kind() {
        let body = "0 0 0 9 9\n1 0 0 # a comment\n\n0 1 0\n3 0 1 2 0.5 0.5 0.5\n";
        for header in
            ["OFF\n3 1 0\n", "OFF 3 1 3\n", "OFF3 1 0\n", "# c\nSTCNOFF\n# c\n3 1 0\n", "3 1 0\n"]
        {
            let loaded = read(format!("{header}{body}").as_bytes()).expect(header);
            assert_eq!((loaded.positions.len(), loaded.triangles.len()), (3, 1), "{header}");
        }
        for header in ["4OFF\n3 1 0\n", "nOFF 4\n3 1 0\n", "OFF BINARY\n3 1 0\n", "FOO\n3 1 0\n"] {
            read(format!("{header}{body}").as_bytes()).expect_err(header);
        }
    }
}
