//! The pixels while light falls on them.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use kdray::Ray;
use rayon::prelude::*;

use crate::camera::Lens;
use crate::caster::Source;
use crate::probe::Probe;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::{Camera, Cancelled, RenderOptions, waves};

/// Pixels along a side of the squares that threads take at a time.
const TILE: u32 = 16;

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

/// A picture that is not yet developed.
pub(crate) struct Film {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: Vec<Pixel>,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
}

impl Film {
    /// Shades every sample of every pixel, tile by tile on the threads of the current `rayon` pool;
    /// wave by wave where rays are traced many at a time.
    pub(crate) fn expose<S>(
        scene: &Scene,
        camera: &Camera,
        options: &RenderOptions,
        shade: S,
    ) -> Result<Self, Cancelled>
    where
        S: Fn(&mut Probe, &Ray, &mut Sampler) -> Sample + Sync,
    {
        let view = View { camera, lens: Lens::new(camera, options.aspect()), options };
        let tracer = match &scene.source {
            Source::Tracer(tracer) => *tracer,
            Source::Caster(casting) => return waves::expose(scene, casting, &view, &shade),
        };
        let across = options.width.div_ceil(TILE);
        let tiles = (across * options.height.div_ceil(TILE)) as usize;
        let done = AtomicUsize::new(0);
        let expose_tile = |tile: usize| {
            options.check_cancelled()?;
            let corner = [tile as u32 % across * TILE, tile as u32 / across * TILE];
            let exposed = Tile::expose(&view, corner, &mut Probe::new(scene, tracer), &shade);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if let Some(progress) = options.progress {
                progress(done as f32 / tiles as f32);
            }
            Ok(exposed)
        };
        let tiles: Result<Vec<Tile>, Cancelled> =
            (0..tiles).into_par_iter().map(expose_tile).collect();
        Ok(Self::assembled(options, &tiles?))
    }

    fn assembled(options: &RenderOptions, tiles: &[Tile]) -> Self {
        let (width, height) = (options.width, options.height);
        let mut pixels = vec![Pixel::default(); width as usize * height as usize];
        let (mut rays, mut hits) = (0, 0);
        for tile in tiles {
            rays += tile.rays;
            hits += tile.hits;
            let row_length = TILE.min(width - tile.corner[0]) as usize;
            for (row, source) in tile.pixels.chunks(row_length).enumerate() {
                let y = tile.corner[1] as usize + row;
                let first = y * width as usize + tile.corner[0] as usize;
                pixels[first..first + row_length].copy_from_slice(source);
            }
        }
        Self { width, height, pixels, rays, hits }
    }
}

/// What all pixels look through.
pub(crate) struct View<'a> {
    camera: &'a Camera,
    lens: Lens,
    pub(crate) options: &'a RenderOptions<'a>,
}

impl View<'_> {
    /// The camera ray of a sample, and the random numbers that are left for it.
    pub(crate) fn sample(&self, [x, y]: [u32; 2], sample: u32) -> (Ray, Sampler) {
        let RenderOptions { width, height, .. } = *self.options;
        let mut sampler = Sampler::new([x, y], sample, self.options.samples());
        let [dx, dy] = sampler.next();
        let right = 2.0 * (x as f32 + dx) / width as f32 - 1.0;
        let up = 1.0 - 2.0 * (y as f32 + dy) / height as f32;
        let ray = Ray::new(self.camera.eye, self.lens.direction(right, up).to_array());
        (ray, sampler)
    }
}

/// A square of the film.
struct Tile {
    corner: [u32; 2],
    pixels: Vec<Pixel>,
    rays: u64,
    hits: u64,
}

impl Tile {
    fn expose<S>(view: &View, corner: [u32; 2], probe: &mut Probe, shade: &S) -> Self
    where
        S: Fn(&mut Probe, &Ray, &mut Sampler) -> Sample,
    {
        let RenderOptions { width, height, .. } = *view.options;
        let samples = view.options.samples();
        let rows = corner[1]..(corner[1] + TILE).min(height);
        let columns = corner[0]..(corner[0] + TILE).min(width);
        let mut expose = |x, y| {
            let samples = (0..samples).map(|sample| {
                let (ray, mut sampler) = view.sample([x, y], sample);
                shade(probe, &ray, &mut sampler)
            });
            Pixel::mean(samples)
        };
        let pixels = rows.flat_map(|y| columns.clone().map(move |x| [x, y]));
        let pixels = pixels.map(|[x, y]| expose(x, y)).collect();
        Self { corner, pixels, rays: probe.rays, hits: probe.hits }
    }
}

impl Surface {
    /// Whether two points can be of one smooth surface.
    fn continues_to(&self, other: &Self) -> bool {
        let way = other.position - self.position;
        self.normal.dot(other.normal) > 0.8 && way.dot(self.normal).abs() <= 0.5 * way.length()
    }
}

impl Pixel {
    pub(crate) fn mean(samples: impl ExactSizeIterator<Item = Sample>) -> Self {
        let count = samples.len() as f32;
        let mut pixel = Self::default();
        let mut first: Option<Surface> = None;
        let (mut squares, mut covered) = (0.0, 0.0_f32);
        for Sample { light, surface } in samples {
            pixel.light += light / count;
            let Some(surface) = surface else { continue };
            if !first.get_or_insert(surface).continues_to(&surface) {
                continue;
            }
            let irradiance = light / surface.albedo.max(Vec3::splat(1e-3));
            covered += 1.0;
            squares += luminance(irradiance).powi(2);
            pixel.irradiance += irradiance;
            pixel.surface.position += surface.position;
            pixel.surface.normal += surface.normal;
            pixel.surface.albedo += surface.albedo;
        }
        if covered > 0.0 {
            pixel.cover = covered / count;
            pixel.irradiance /= covered;
            pixel.surface.position /= covered;
            pixel.surface.normal = pixel.surface.normal.normalize_or_zero();
            pixel.surface.albedo /= covered;
            let spread = squares / covered - luminance(pixel.irradiance).powi(2);
            pixel.variance = spread.max(0.0) / covered;
        }
        pixel
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
