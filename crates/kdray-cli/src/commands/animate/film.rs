//! Where the pictures go: a GIF file, or a folder of PNG files.

use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use anyhow::Context;
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame, RgbImage};
use kdray_render::Picture;

use crate::atomic;

/// How coarsely colours are chosen for a GIF, 1 to 30: lower is finer, and slower.
const GIF_SPEED: i32 = 10;

/// The place of the pictures.
pub(super) struct Film<'a> {
    target: &'a Path,
    rate: f64,
}

/// A film on which pictures are put.
pub(super) enum Reel {
    Gif { encoder: Box<GifEncoder<BufWriter<File>>>, delay: Delay },
    Folder { path: PathBuf, frames: usize },
}

impl<'a> Film<'a> {
    /// A GIF if `target` ends like one, else a folder, which is made if it is not there.
    pub(super) fn new(target: &'a Path, rate: f64) -> anyhow::Result<Self> {
        if is_gif(target) {
            atomic::check_writable(target)?;
        } else {
            fs::create_dir_all(target)
                .with_context(|| format!("cannot make the folder {}", target.display()))?;
        }
        Ok(Self { target, rate })
    }

    /// Lets `work` add pictures. A GIF is there only when all went well.
    pub(super) fn shoot(
        &self,
        work: impl FnOnce(&mut Reel) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        if !is_gif(self.target) {
            return work(&mut Reel::Folder { path: self.target.to_path_buf(), frames: 0 });
        }
        atomic::write(self.target, |file, _| {
            let mut encoder =
                GifEncoder::new_with_speed(BufWriter::new(file.try_clone()?), GIF_SPEED);
            encoder.set_repeat(Repeat::Infinite)?;
            let delay = Delay::from_numer_denom_ms(1_000_000, (1_000.0 * self.rate) as u32);
            work(&mut Reel::Gif { encoder: Box::new(encoder), delay })
        })
    }
}

impl Reel {
    pub(super) fn add(&mut self, picture: &Picture) -> anyhow::Result<()> {
        match self {
            Self::Gif { encoder, delay } => {
                let bytes = picture.pixels.as_flattened().to_vec();
                let image = RgbImage::from_raw(picture.width, picture.height, bytes);
                let image = DynamicImage::from(image.context("a picture has all of its pixels")?);
                encoder.encode_frame(Frame::from_parts(image.into_rgba8(), 0, 0, *delay))?;
            }
            Self::Folder { path, frames } => {
                let file = path.join(format!("frame_{frames:04}.png"));
                let png = picture.to_png()?;
                atomic::write(&file, |file, _| Ok(file.write_all(&png)?))?;
                *frames += 1;
            }
        }
        Ok(())
    }
}

fn is_gif(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif"))
}

/// Parses frames a second; a GIF counts in hundredths of a second.
pub(crate) fn parse_rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if (0.1..=100.0).contains(&rate) => Ok(rate),
        _ => Err("not a number of frames a second in 0.1..=100".into()),
    }
}
