//! Letters on a picture.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::Picture;

const SIZE: RasterHeight = RasterHeight::Size16;
const INK: [u8; 3] = [235, 235, 235];

/// How high a line is, in pixels.
pub(crate) const LINE: u32 = SIZE.val() as u32;

/// How wide every letter is, in pixels.
pub(crate) fn letter_width() -> u32 {
    get_raster_width(FontWeight::Regular, SIZE) as u32
}

impl Picture {
    /// Writes a line of text in light letters, 16 pixels high, its upper left corner at the pixel
    /// `x`, `y`; what is outside of the picture is cut off, and letters outside of Latin are left out.
    pub fn write(&mut self, [x, y]: [u32; 2], text: &str) {
        let letters = text.chars().filter_map(|c| get_raster(c, FontWeight::Regular, SIZE));
        for (index, letter) in (0..).zip(letters) {
            for (row, line) in (0..).zip(letter.rows()) {
                for (column, cover) in (0..).zip(line) {
                    let across = index * letter_width() + column;
                    if let Some(pixel) = self.pixel_mut(x + across, y + row) {
                        blend(pixel, *cover);
                    }
                }
            }
        }
    }
}

fn blend(pixel: &mut [u8; 3], cover: u8) {
    let cover = u32::from(cover);
    for (channel, ink) in pixel.iter_mut().zip(INK) {
        let mixed = u32::from(*channel) * (255 - cover) + u32::from(ink) * cover;
        *channel = ((mixed + 127) / 255) as u8;
    }
}
