//! A colour bar with numbers, for heat maps.

use crate::shade::heat;
use crate::{Picture, text};

const MARGIN: u32 = 16;
const BAR: [u32; 2] = [256, 12];

/// Draws a bar from 0 to `most` into the lower left corner, under its title. Pictures without room
/// for it stay as they are.
pub(crate) fn draw(picture: &mut Picture, most: f32, title: &str) {
    let line = text::LINE;
    let height = BAR[1] + 2 * line + 8;
    let [room_x, room_y] = [BAR[0] + 4 * MARGIN, height + 2 * MARGIN];
    if picture.width < room_x || picture.height < room_y {
        return;
    }
    let top = picture.height - MARGIN - height;
    picture.write([MARGIN, top], title);
    for (x, y) in (0..BAR[0]).flat_map(|x| (0..BAR[1]).map(move |y| (x, y))) {
        if let Some(pixel) = picture.pixel_mut(MARGIN + x, top + line + 4 + y) {
            *pixel = heat((x as f32 + 0.5) / BAR[0] as f32);
        }
    }
    let numbers = top + line + BAR[1] + 8;
    for (place, value) in [(0, 0.0), (BAR[0] / 2, 0.5 * most), (BAR[0], most)] {
        let text = format!("{value}");
        let width = text.len() as u32 * text::letter_width();
        picture.write([(MARGIN + place).saturating_sub(width / 2), numbers], &text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn black(width: u32, height: u32) -> Picture {
        let pixels = vec![[0; 3]; width as usize * height as usize];
        Picture { width, height, pixels, rays: 0, hits: 0 }
    }

    #[test]
    fn the_legend_has_a_bar_and_letters() {
        let mut picture = black(400, 200);
        draw(&mut picture, 40.0, "steps");
        let is_letter = |pixel: &&[u8; 3]| pixel[0] > 150 && pixel[0] == pixel[2];
        assert!(picture.pixels.iter().filter(is_letter).count() > 20, "letters");
        assert!(picture.pixels.contains(&heat(0.5 + 0.5 / 256.0)), "the middle of the bar");
        assert!(picture.pixels[..400 * 100].iter().all(|pixel| *pixel == [0; 3]));
    }

    #[test]
    fn small_pictures_stay_as_they_are() {
        let mut picture = black(100, 100);
        draw(&mut picture, 40.0, "steps");
        assert_eq!(picture, black(100, 100));
    }
}
