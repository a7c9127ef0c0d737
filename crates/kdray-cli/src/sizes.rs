//! Sizes as people write and read them.

use std::fmt;
use std::str::FromStr;

use bytesize::ByteSize;

/// The widest and highest picture.
const MOST_PIXELS: u32 = 16_384;

/// Width and height of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PictureSize {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl FromStr for PictureSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text.split_once(['x', 'X']).ok_or("not of the form 960x640")?;
        let side = |text: &str| match text.parse() {
            Ok(side @ 1..=MOST_PIXELS) => Ok(side),
            _ => Err(format!("{text:?} is not a number of pixels in 1..={MOST_PIXELS}")),
        };
        Ok(Self { width: side(width)?, height: side(height)? })
    }
}

impl fmt::Display for PictureSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// Bytes with a suffix: `64M`, `1.5GiB`.
pub(crate) fn parse_bytes(text: &str) -> Result<u64, String> {
    text.parse::<ByteSize>().map(|size| size.as_u64()).map_err(|error| error.to_string())
}

/// Bytes for people.
pub(crate) fn bytes(count: u64) -> String {
    ByteSize::b(count).display().si().to_string()
}

/// A count with its thousands apart.
pub(crate) fn count(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A point as `x,y,z`.
pub(crate) fn parse_point(text: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.map(<[f64; 3]>::try_from) {
        Ok(Ok(point)) if point.iter().all(|x| x.is_finite()) => Ok(point),
        _ => Err("not three numbers of the form 1,2.5,-3".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn picture_sizes() {
        assert_eq!("640x480".parse(), Ok(PictureSize { width: 640, height: 480 }));
        for wrong in ["640", "0x1", "1x99999", "ax1", "1x-1", "x"] {
            assert!(wrong.parse::<PictureSize>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn byte_counts_take_suffixes() {
        assert_eq!(parse_bytes("1000"), Ok(1000));
        assert_eq!(parse_bytes("64K"), Ok(64_000));
        assert_eq!(parse_bytes("2 MiB"), Ok(2 << 20));
        assert_eq!(parse_bytes("1.5GB"), Ok(1_500_000_000));
        assert!(parse_bytes("-3").is_err() && parse_bytes("3 apples").is_err());
    }

    #[test]
    fn counts_have_their_thousands_apart() {
        assert_eq!([0, 999, 1000, 1_234_567].map(count), ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn points() {
        assert_eq!(parse_point("1, -2.5,3e2"), Ok([1.0, -2.5, 300.0]));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,nan"] {
            assert!(parse_point(wrong).is_err(), "{wrong}");
        }
    }
}
