//! A pixel: what its samples bring home, added up and averaged.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// What one camera ray brings home.
pub(crate) struct Sample {
    /// Radiance.
    pub(crate) light: Vec3,
    /// The surface it comes from, if its noise may be smoothed along it.
    pub(crate) surface: Option<Surface>,
}

/// A surface as a camera ray sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Surface {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) albedo: Vec3,
}

/// The mean of a pixel's samples.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pixel {
    /// Radiance of all samples.
    pub(crate) light: Vec3,
    /// The part of the samples that show one surface, the first that is seen.
    pub(crate) cover: f32,
    /// That surface.
    pub(crate) surface: Surface,
    /// Light that falls on it: radiance over albedo.
    pub(crate) irradiance: Vec3,
    /// Variance of the irradiance's mean luminance.
    pub(crate) variance: f32,
}

/// What a pixel's samples add up to.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Sums {
    /// Mean radiance of all samples, those to come counted as dark.
    light: Vec3,
    /// Samples that show the first surface.
    covered: f32,
    irradiance: Vec3,
    /// Luminance of the irradiance, squared.
    squares: f32,
    position: Vec3,
    normal: Vec3,
    albedo: Vec3,
    /// Of the first surface that was seen.
    first_position: Vec3,
    first_normal: Vec3,
}

impl Sums {
    /// Adds one of `count` samples.
    pub(crate) fn add(&mut self, Sample { light, surface }: &Sample, count: f32) {
        self.light += *light / count;
        let Some(surface) = surface else { return };
        if self.covered == 0.0 {
            (self.first_position, self.first_normal) = (surface.position, surface.normal);
        } else if !self.is_continued_by(surface) {
            return;
        }
        let irradiance = *light / surface.albedo.max(Vec3::splat(1e-3));
        self.covered += 1.0;
        self.squares += luminance(irradiance).powi(2);
        self.irradiance += irradiance;
        self.position += surface.position;
        self.normal += surface.normal;
        self.albedo += surface.albedo;
    }

    /// Makes the light brighter, for samples that never came.
    #[cfg(feature = "gpu")]
    pub(crate) fn brighten(&mut self, factor: f32) {
        self.light *= factor;
    }

    /// Whether a point can be of the first surface, if that is smooth.
    fn is_continued_by(&self, surface: &Surface) -> bool {
        let way = surface.position - self.first_position;
        self.first_normal.dot(surface.normal) > 0.8
            && way.dot(self.first_normal).abs() <= 0.5 * way.length()
    }

    /// The mean of `count` samples.
    pub(crate) fn mean(&self, count: f32) -> Pixel {
        let mut pixel = Pixel { light: self.light, ..Pixel::default() };
        let covered = self.covered;
        if covered > 0.0 {
            pixel.cover = covered / count;
            pixel.irradiance = self.irradiance / covered;
            pixel.surface.position = self.position / covered;
            pixel.surface.normal = self.normal.normalize_or_zero();
            pixel.surface.albedo = self.albedo / covered;
            let spread = self.squares / covered - luminance(pixel.irradiance).powi(2);
            pixel.variance = spread.max(0.0) / covered;
        }
        pixel
    }
}

impl Pixel {
    /// The mean of a pixel's samples.
    pub(crate) fn mean(samples: impl ExactSizeIterator<Item = Sample>) -> Self {
        let count = samples.len() as f32;
        let mut sums = Sums::default();
        samples.for_each(|sample| sums.add(&sample, count));
        sums.mean(count)
    }
}

/// How bright a linear colour looks.
pub(crate) fn luminance(colour: Vec3) -> f32 {
    colour.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(light: f32, height: f32, normal: Vec3) -> Sample {
        let surface = Surface { position: height * Vec3::Y, normal, albedo: Vec3::splat(0.5) };
        Sample { light: Vec3::splat(light), surface: Some(surface) }
    }

    #[test]
    fn a_pixel_keeps_the_light_of_all_and_the_surface_of_the_first() {
        let miss = Sample { light: Vec3::splat(4.0), surface: None };
        let samples =
            [miss, sample(1.0, 0.0, Vec3::Y), sample(2.0, 0.0, Vec3::Y), sample(9.0, 7.0, Vec3::X)];
        let pixel = Pixel::mean(samples.into_iter());
        assert_eq!((pixel.light, pixel.cover), (Vec3::splat(4.0), 0.5));
        assert_eq!((pixel.irradiance, pixel.surface.normal), (Vec3::splat(3.0), Vec3::Y));
        assert!((pixel.variance - 0.5).abs() < 1e-5, "{}", pixel.variance);
    }
}
