//! The finished picture.

use std::io::Cursor;
use std::path::Path;

use image::{ImageError, ImageFormat, RgbImage};

use crate::film::Film;
use crate::pixel::Pixel;

/// A picture, and what it took.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// sRGB, row by row from the top left.
    pub pixels: Vec<[u8; 3]>,
    /// Rays that were traced through the tree.
    pub rays: u64,
    /// Those of them that hit a triangle.
    pub hits: u64,
}

impl Picture {
    /// Every pixel of `film` through `develop`.
    pub(crate) fn develop(film: &Film, develop: impl Fn(&Pixel) -> [u8; 3]) -> Self {
        Self {
            width: film.width,
            height: film.height,
            pixels: film.pixels.iter().map(develop).collect(),
            rays: film.rays,
            hits: film.hits,
        }
    }

    /// Writes a PNG file.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<(), ImageError> {
        self.image().save_with_format(path, ImageFormat::Png)
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    ///
    /// The picture cannot be encoded, which happens if it has no pixels.
    pub fn to_png(&self) -> Result<Vec<u8>, ImageError> {
        let mut bytes = Cursor::new(Vec::new());
        self.image().write_to(&mut bytes, ImageFormat::Png)?;
        Ok(bytes.into_inner())
    }

    fn image(&self) -> RgbImage {
        let mut image = RgbImage::new(self.width, self.height);
        for (target, source) in image.pixels_mut().zip(&self.pixels) {
            target.0 = *source;
        }
        image
    }

    /// The pixel in column `x` of row `y`.
    pub(crate) fn pixel_mut(&mut self, x: u32, y: u32) -> Option<&mut [u8; 3]> {
        if x >= self.width {
            return None;
        }
        self.pixels.get_mut(y as usize * self.width as usize + x as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_keeps_every_pixel_where_it_is() {
        let pixels: Vec<[u8; 3]> = (0..6).map(|i| [i, 100 + i, 200]).collect();
        let picture = Picture { width: 3, height: 2, pixels, rays: 0, hits: 0 };
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        picture.save_png(file.path()).expect("it can be written");
        let bytes = std::fs::read(file.path()).expect("it was written");
        assert_eq!(picture.to_png().expect("it can be encoded"), bytes);
        let image = image::load_from_memory(&bytes).expect("a PNG").into_rgb8();
        assert_eq!(image.dimensions(), (3, 2));
        assert_eq!(image.get_pixel(2, 1).0, [5, 105, 200]);
    }
}
