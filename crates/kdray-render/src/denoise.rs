//! Smooths the noise of few samples, and nothing else.
//!
//! An edge-avoiding wavelet filter [DSHL10]: the light that falls on a surface, not its colour, is
//! averaged over a growing neighbourhood of pixels that lie in the same plane, face the same way and
//! differ in brightness by no more than their noise explains [SKW+17].

use glam::Vec3;
use rayon::prelude::*;

use crate::film::Film;
use crate::pixel::{Pixel, luminance};
use crate::{Cancelled, RenderOptions};

/// Passes; each reaches twice as far as the one before.
const PASSES: u32 = 5;

/// How many standard deviations of noise two pixels may differ by.
const TOLERANCE: f32 = 3.0;

/// How fast the weight falls with the angle between normals: the power of its cosine.
const NORMAL_POWER: i32 = 32;

/// Weights of the five taps in a row.
const KERNEL: [f32; 5] = [1.0 / 16.0, 1.0 / 4.0, 3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];

/// The light on a surface and the variance of its luminance.
#[derive(Clone, Copy)]
struct Light {
    irradiance: Vec3,
    variance: f32,
}

/// Smooths the light on surfaces.
pub(crate) fn denoise(film: &mut Film, options: &RenderOptions) -> Result<(), Cancelled> {
    let light = |pixel: &Pixel| Light { irradiance: pixel.irradiance, variance: pixel.variance };
    let mut current: Vec<Light> = film.pixels.iter().map(light).collect();
    for pass in 0..PASSES {
        options.check_cancelled()?;
        let filter = Filter { film, light: &current, step: 1 << pass };
        current = (0..film.pixels.len()).into_par_iter().map(|index| filter.at(index)).collect();
    }
    for (pixel, smooth) in film.pixels.iter_mut().zip(&current) {
        let change = smooth.irradiance - pixel.irradiance;
        pixel.light += pixel.cover * pixel.surface.albedo * change;
        pixel.light = pixel.light.max(Vec3::ZERO);
    }
    Ok(())
}

/// One pass.
struct Filter<'a> {
    film: &'a Film,
    light: &'a [Light],
    step: isize,
}

impl Filter<'_> {
    fn at(&self, index: usize) -> Light {
        let (center, here) = (&self.film.pixels[index], self.light[index]);
        if center.cover == 0.0 {
            return here;
        }
        let deviation = TOLERANCE * self.smooth_variance(index).sqrt() + 1e-4;
        let brightness = luminance(here.irradiance);
        let (mut irradiance, mut variance, mut total) = (Vec3::ZERO, 0.0, 0.0);
        for (row, column, kernel) in taps() {
            let Some(index) = self.neighbour(index, [column, row]) else { continue };
            let (pixel, light) = (&self.film.pixels[index], &self.light[index]);
            let difference = (luminance(light.irradiance) - brightness).abs() / deviation;
            let weight = kernel * self.likeness(center, pixel, [column, row]) * (-difference).exp();
            irradiance += weight * light.irradiance;
            variance += weight * weight * light.variance;
            total += weight;
        }
        Light { irradiance: irradiance / total, variance: variance / (total * total) }
    }

    /// How surely two pixels show one surface, in 0..=1.
    fn likeness(&self, center: &Pixel, other: &Pixel, tap: [isize; 2]) -> f32 {
        if tap == [0, 0] {
            return 1.0;
        }
        let (a, b) = (&center.surface, &other.surface);
        let facing = a.normal.dot(b.normal).max(0.0).powi(NORMAL_POWER);
        let apart = b.position - a.position;
        let off_plane = apart.dot(a.normal).abs() / (0.1 * apart.length() + f32::MIN_POSITIVE);
        other.cover * facing * (-off_plane).exp()
    }

    /// Variance is noisy too, at first more than the light itself: its mean over some pixels.
    fn smooth_variance(&self, index: usize) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0_f32);
        let reach = if self.step == 1 { 3 } else { 1 };
        let around = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| [dx, dy]));
        for index in around.filter_map(|offset| self.offset(index, offset)) {
            if self.film.pixels[index].cover > 0.0 {
                sum += self.light[index].variance;
                count += 1.0;
            }
        }
        sum / count.max(1.0)
    }

    fn neighbour(&self, index: usize, [column, row]: [isize; 2]) -> Option<usize> {
        let index = self.offset(index, [column * self.step, row * self.step])?;
        (self.film.pixels[index].cover > 0.0).then_some(index)
    }

    fn offset(&self, index: usize, [dx, dy]: [isize; 2]) -> Option<usize> {
        let (width, height) = (self.film.width as isize, self.film.height as isize);
        let (x, y) = (index as isize % width + dx, index as isize / width + dy);
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        inside.then_some((y * width + x) as usize)
    }
}

/// Row, column and weight of each tap.
fn taps() -> impl Iterator<Item = (isize, isize, f32)> {
    (0..25).map(|tap| {
        let (row, column) = (tap / 5, tap % 5);
        (row as isize - 2, column as isize - 2, KERNEL[row] * KERNEL[column])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pixel::Surface;

    /// A wall that is dark on the left and bright on the right, with noise from a hash.
    fn wall(width: u32, contrast: f32) -> Film {
        let pixel = |index: u32| {
            let (x, y) = (index % width, index / width);
            let noise = (index.wrapping_mul(2_654_435_769) >> 16) as f32 / 65_536.0 - 0.5;
            let side = if x < width / 2 { -contrast } else { contrast };
            let irradiance = Vec3::splat(1.0 + side + 0.2 * noise);
            let position = Vec3::new(x as f32, y as f32, 0.0);
            let surface = Surface { position, normal: Vec3::Z, albedo: Vec3::splat(0.5) };
            let variance = 0.04 / 12.0;
            Pixel { light: 0.5 * irradiance, cover: 1.0, surface, irradiance, variance }
        };
        let pixels = (0..width * width).map(pixel).collect();
        Film { width, height: width, pixels, rays: 0, hits: 0 }
    }

    fn mean_and_deviation(film: &Film, columns: std::ops::Range<usize>) -> [f32; 2] {
        let width = film.width as usize;
        let inside = |(index, _): &(usize, &Pixel)| columns.contains(&(index % width));
        let values: Vec<f32> =
            film.pixels.iter().enumerate().filter(inside).map(|(_, p)| p.light.x).collect();
        let count = values.len() as f32;
        let mean = values.iter().sum::<f32>() / count;
        [mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / count).sqrt()]
    }

    #[test]
    fn noise_goes_and_the_mean_stays() {
        let mut film = wall(32, 0.0);
        let [mean, deviation] = mean_and_deviation(&film, 0..32);
        denoise(&mut film, &RenderOptions::default()).expect("not cancelled");
        let [smooth_mean, smooth_deviation] = mean_and_deviation(&film, 0..32);
        assert!((mean - smooth_mean).abs() < 0.005, "{mean} {smooth_mean}");
        assert!(smooth_deviation < 0.25 * deviation, "{deviation} {smooth_deviation}");
    }

    #[test]
    fn edges_that_noise_does_not_explain_stay() {
        let mut film = wall(32, 0.5);
        denoise(&mut film, &RenderOptions::default()).expect("not cancelled");
        let [left, _] = mean_and_deviation(&film, 14..16);
        let [right, _] = mean_and_deviation(&film, 16..18);
        assert!((left - 0.25).abs() < 0.02 && (right - 0.75).abs() < 0.02, "{left} {right}");
    }
}
