//! The pixels while light falls on them.

use std::sync::atomic::{AtomicUsize, Ordering};

use kdray::{Ray, Tracer};
use rayon::prelude::*;

use crate::camera::Lens;
use crate::pixel::{Pixel, Sample};
use crate::probe::Probe;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::{Camera, Cancelled, RenderOptions};

/// Pixels along a side of the squares that threads take at a time.
const TILE: u32 = 16;

/// A picture that is not yet developed.
pub(crate) struct Film {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: Vec<Pixel>,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
}

impl Film {
    /// Shades every sample of every pixel, tile by tile on the threads of the current `rayon` pool.
    pub(crate) fn expose<S>(
        (scene, tracer): (&Scene, &Tracer),
        camera: &Camera,
        options: &RenderOptions,
        shade: S,
    ) -> Result<Self, Cancelled>
    where
        S: Fn(&mut Probe, &Ray, &mut Sampler) -> Sample + Sync,
    {
        let view = View::new(camera, options);
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

impl<'a> View<'a> {
    pub(crate) fn new(camera: &'a Camera, options: &'a RenderOptions<'a>) -> Self {
        Self { camera, lens: Lens::new(camera, options.aspect()), options }
    }

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
