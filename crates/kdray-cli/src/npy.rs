//! Rays and points from `.npy` files.

use std::fs::File;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use kdray::{Frame, Ray};
use memmap2::Mmap;
use ndarray::ArrayView2;
use ndarray_npy::{ViewElement, ViewNpyError, ViewNpyExt};

/// Rays in the coordinates of `frame`: origin, direction and, with eight columns, `t_min` and
/// `t_max`, which are zero and infinity without. Doubles are moved into the frame before they are
/// rounded.
pub(crate) fn rays(path: &Path, frame: &Frame) -> anyhow::Result<Vec<Ray>> {
    let ray = |row: &[f64]| {
        let [x, y, z, dx, dy, dz] = [0, 1, 2, 3, 4, 5].map(|column| row[column]);
        let [t_min, t_max] = if row.len() == 8 { [row[6], row[7]] } else { [0.0, f64::INFINITY] };
        frame.local_ray([x, y, z], [dx, dy, dz], t_min as f32, t_max as f32)
    };
    rows(path, &[6, 8], ray)
}

/// Points in the coordinates of `frame`, as [`rays`].
pub(crate) fn points(path: &Path, frame: &Frame) -> anyhow::Result<Vec<[f32; 3]>> {
    rows(path, &[3], |row| frame.local_point([row[0], row[1], row[2]]))
}

/// What `convert` makes of every row of the table in the file, which has one of these numbers of
/// `columns`.
fn rows<T>(
    path: &Path,
    columns: &[usize],
    convert: impl Fn(&[f64]) -> T,
) -> anyhow::Result<Vec<T>> {
    let read = || {
        let file = File::open(path)?;
        ensure!(file.metadata()?.is_file(), "it is no file");
        // SAFETY: Nothing here writes to the file. Another program that changes it meanwhile breaks
        // what the map promises, as with every mapped file.
        let map = unsafe { Mmap::map(&file)? };
        convert_rows(&map, columns, convert)
    };
    read().with_context(|| path.display().to_string())
}

fn convert_rows<T>(
    bytes: &[u8],
    columns: &[usize],
    convert: impl Fn(&[f64]) -> T,
) -> anyhow::Result<Vec<T>> {
    check_header_length(bytes)?;
    if let Some(table) = view::<f32>(bytes)? {
        return convert_table(&table, columns, |value| f64::from(*value), convert);
    }
    match view::<f64>(bytes)? {
        Some(table) => convert_table(&table, columns, |value| *value, convert),
        None => bail!("its numbers are neither float32 nor float64"),
    }
}

/// The table where it lies, if its numbers are of this type. What the header claims has been
/// compared with the length of the file.
fn view<T: ViewElement>(bytes: &[u8]) -> anyhow::Result<Option<ArrayView2<'_, T>>> {
    match ArrayView2::view_npy(bytes) {
        Ok(table) => Ok(Some(table)),
        Err(ViewNpyError::WrongDescriptor(_)) => Ok(None),
        Err(ViewNpyError::WrongNdim(_, given)) => bail!("it has {given} dimensions instead of 2"),
        Err(error) => bail!("it is not a whole .npy file: {error}"),
    }
}

fn convert_table<N: Clone, T>(
    table: &ArrayView2<'_, N>,
    columns: &[usize],
    widen: impl Fn(&N) -> f64,
    convert: impl Fn(&[f64]) -> T,
) -> anyhow::Result<Vec<T>> {
    if !columns.contains(&table.ncols()) {
        let wanted: Vec<String> = columns.iter().map(|columns| format!("(n, {columns})")).collect();
        bail!("its shape is {:?} instead of {}", table.dim(), wanted.join(" or "));
    }
    let mut row = vec![0.0; table.ncols()];
    Ok(table
        .outer_iter()
        .map(|numbers| {
            for (number, place) in numbers.iter().zip(&mut row) {
                *place = widen(number);
            }
            convert(&row)
        })
        .collect())
}

/// Headers of plain arrays have 128 bytes. Longer ones could only keep the parser busy.
const LONGEST_HEADER: usize = 1024;

/// Refuses headers that are no header of a plain array, before they are parsed.
fn check_header_length(bytes: &[u8]) -> anyhow::Result<()> {
    ensure!(bytes.starts_with(b"\x93NUMPY"), "it does not begin like a .npy file");
    let length = match bytes[6..] {
        [1, _, a, b, ..] => u32::from_le_bytes([a, b, 0, 0]),
        [2 | 3, _, a, b, c, d, ..] => u32::from_le_bytes([a, b, c, d]),
        [0 | 4.., ..] => bail!("its version of the .npy format is {}, which is unknown", bytes[6]),
        _ => bail!("it ends within its header"),
    };
    ensure!(
        length as usize <= LONGEST_HEADER,
        "its header has {length} bytes, too many for a table"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray_npy::WriteNpyExt;

    fn written(table: &ndarray::Array2<f64>) -> Vec<u8> {
        let mut bytes = Vec::new();
        table.write_npy(&mut bytes).expect("written");
        bytes
    }

    fn read(bytes: &[u8]) -> anyhow::Result<Vec<Vec<f64>>> {
        let file = tempfile::NamedTempFile::new()?;
        std::fs::write(file.path(), bytes)?;
        rows(file.path(), &[3], <[f64]>::to_vec)
    }

    fn header(text: &str) -> Vec<u8> {
        let text = format!("{text:<118}");
        let length = u16::try_from(text.len()).expect("short");
        [b"\x93NUMPY\x01\x00", &length.to_le_bytes()[..], text.as_bytes()].concat()
    }

    #[test]
    fn tables_come_back_in_either_order_and_type() {
        let table = ndarray::array![[1.0, 2.0, 3.0], [4.0, 5.0, 6.5]];
        let wanted = vec![vec![1.0, 2.0, 3.0], vec![4.0, 5.0, 6.5]];
        assert_eq!(read(&written(&table)).expect("sound"), wanted);
        let columns = table.t().as_standard_layout().to_owned();
        assert_eq!(read(&written(&columns.reversed_axes())).expect("sound"), wanted);
        let mut single = Vec::new();
        table.mapv(|value| value as f32).write_npy(&mut single).expect("written");
        assert_eq!(read(&single).expect("sound"), wanted);
    }

    #[test]
    fn what_is_no_table_of_points_is_refused() {
        let claims = |descr: &str, shape: &str| {
            let text =
                format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
            let text = format!("{text:<117}\n");
            format!("{:#}", read(&header(&text)).unwrap_err())
        };
        let cases = [
            (claims("<f8", "(1000000000000, 3)"), "it is not a whole .npy file"),
            (
                claims("<f8", "(18446744073709551615, 18446744073709551615)"),
                "not a whole .npy file",
            ),
            (claims("<f8", "(0, 4)"), "its shape is (0, 4) instead of (n, 3)"),
            (claims("<f8", "(0,)"), "it has 1 dimensions instead of 2"),
            (claims("<i8", "(0, 3)"), "neither float32 nor float64"),
            (claims("|O", "(0, 3)"), "neither float32 nor float64"),
            (claims(">f8", "(0, 3)"), "it is not a whole .npy file"),
            (
                format!("{:#}", read(&header(&"[".repeat(60_000))).unwrap_err()),
                "60000 bytes, too many",
            ),
            (
                format!("{:#}", read(&header(&"[".repeat(1024))).unwrap_err()),
                "not a whole .npy file",
            ),
            (
                format!("{:#}", read(b"\x93NUMPY\x09\x00abcdef").unwrap_err()),
                "is 9, which is unknown",
            ),
            (format!("{:#}", read(b"ply\n").unwrap_err()), "does not begin like a .npy file"),
        ];
        for (error, wanted) in cases {
            assert!(error.contains(wanted), "{error}");
        }
    }

    /// Every truncation is an error, and no single wrong byte is more than an error or other rows.
    #[test]
    fn damaged_files_are_harmless() {
        let whole = written(&ndarray::array![[1.0, 2.0, 3.0], [4.0, 5.0, 6.5]]);
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length} bytes");
        }
        for place in 0..whole.len() {
            for byte in [0, b'9', b'(', 0xff] {
                let mut damaged = whole.clone();
                damaged[place] = byte;
                let rows = read(&damaged).map_or(0, |rows| rows.len());
                assert!(rows <= 2, "byte {place} is {byte}");
            }
        }
    }
}
