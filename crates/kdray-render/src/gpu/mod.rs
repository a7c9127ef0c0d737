//! Pictures that are made on a GPU.
//!
//! Samples go in waves. Kernels pass them on: `camera` makes their rays, kdray-gpu's tracer finds what
//! these hit, `surface` what is there, and `shade_normals`, `shade_ao` or `shade_path` what becomes of
//! it: shadow rays, whose light `sunlight` adds, and reflected rays, which are packed for the next turn.
//! `escape` gives the last of these the light of the sky, and `accumulate` adds samples to the film,
//! which stays on the device until all are there. Tone mapping, and smoothing noise away, are left to
//! the CPU.
//!
//! Random numbers are those of [`render`](crate::render), bit for bit, and so are hits. What is shaded
//! in between is rounded as the device likes. So a ray may start a hair beside its twin on the CPU and,
//! rarely, pass an edge on the other side: the pictures differ by a step of a colour's 255 here and
//! there, and by more in a few pixels. The tests say in how many.

mod film;
mod kernels;
mod looks;
mod room;
#[cfg(test)]
mod tests;
mod wave;

use std::ptr;

use kdray::Mesh;
use kdray_gpu::{Device, GpuError, Tracer};

use crate::scene::Scene;
use crate::{Camera, Cancelled, Picture, RenderOptions, Shading, shade};
use film::{PART, Parts};
use kernels::{KERNELS, Params};
use looks::Looks;
use room::Room;
use wave::Wave;

/// Samples that are on their way at a time. More of them keep a device busy; fewer take less memory, 304
/// bytes each, and let a picture be cancelled sooner.
const WAVE: u32 = 1 << 17;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The caller asked the picture to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// [`Shading::Cost`] is about the tracer on the CPU.
    #[error("only rays on the CPU have their cost shown")]
    Cost,
}

/// Makes pictures on a device, one after the other in the same memory.
///
/// ```no_run
/// use kdray::{BuildOptions, Mesh};
/// use kdray_gpu::{Device, Limits, Selection, Tracer};
/// use kdray_render::gpu::Renderer;
/// use kdray_render::{Camera, RenderOptions};
///
/// let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
/// let device = Device::open(&Selection::Best, &Limits::PORTABLE)?;
/// let (tracer, _) = Tracer::build(&device, &mesh, &BuildOptions::default())?;
/// let mut renderer = Renderer::new(&device)?;
/// let options = RenderOptions::default();
/// let camera = Camera::framing(&mesh.bounds(), Camera::Y_UP, options.aspect());
/// renderer.render(&tracer, &mesh, &camera, &options)?.save_png("triangle.png")?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Renderer<'a> {
    device: &'a Device,
    looks: Looks,
    room: Option<Room>,
    film: Parts,
}

/// A picture that is being made.
pub struct Exposure<'r, 'a> {
    renderer: &'r mut Renderer<'a>,
    tracer: &'r Tracer<'a>,
    options: &'r RenderOptions<'r>,
    params: Params,
    /// Samples of each pixel that are on the film.
    done: u32,
}

impl<'a> Renderer<'a> {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// If a kernel is refused, or the device fails.
    pub fn new(device: &'a Device) -> Result<Self, GpuError> {
        Tracer::prepare_first_hits(device)?;
        device.compile(KERNELS)?;
        let (looks, film) = (Looks::of_nothing(device)?, Parts::default());
        Ok(Self { device, looks, room: None, film })
    }

    /// The picture that [`render`](crate::render) makes of the tracer's mesh, up to roundings.
    ///
    /// # Errors
    ///
    /// As [`Renderer::begin`] and [`Exposure::advance`].
    ///
    /// # Panics
    ///
    /// As [`Renderer::begin`].
    pub fn render(
        &mut self,
        tracer: &Tracer<'a>,
        mesh: &Mesh,
        camera: &Camera,
        options: &RenderOptions,
    ) -> Result<Picture, RenderError> {
        let mut exposure = self.begin(tracer, mesh, camera, options)?;
        while exposure.advance()? {}
        exposure.picture()
    }

    /// Brings the looks of a scene to the device, for a picture whose samples are taken step by step.
    ///
    /// # Errors
    ///
    /// If the picture is cancelled, it is to be [`Shading::Cost`], or the device has no memory for it.
    ///
    /// # Panics
    ///
    /// If the tracer is on another device, or its mesh has another number of triangles.
    pub fn begin<'r>(
        &'r mut self,
        tracer: &'r Tracer<'a>,
        mesh: &Mesh,
        camera: &Camera,
        options: &'r RenderOptions<'r>,
    ) -> Result<Exposure<'r, 'a>, RenderError> {
        assert!(ptr::eq(tracer.device(), self.device), "the tracer is on another device");
        tracer.check_mesh(mesh);
        if options.shading == Shading::Cost {
            return Err(RenderError::Cost);
        }
        let scene = Scene::new(mesh, camera, options);
        options.check_cancelled()?;
        self.looks.replace(self.device, &scene)?;
        let pixels = u64::from(options.width) * u64::from(options.height);
        self.film.darken(self.device, pixels)?;
        let paths = pixels.saturating_mul(options.samples().into()).min(WAVE.into()) as u32;
        if self.room.as_ref().is_none_or(|room| room.capacity < paths) {
            self.room = None;
            self.room = Some(Room::new(self.device, paths)?);
        }
        let params = Params::of(&scene, camera, options);
        Ok(Exposure { renderer: self, tracer, options, params, done: 0 })
    }
}

impl Exposure<'_, '_> {
    /// Takes some samples more of each pixel. Gives whether there are more to come.
    ///
    /// # Errors
    ///
    /// If the picture is cancelled, or the device fails.
    pub fn advance(&mut self) -> Result<bool, RenderError> {
        let Params { width, height, samples, .. } = self.params;
        let Renderer { looks, room: Some(room), film, .. } = &*self.renderer else {
            return Ok(false);
        };
        let pixels = width * height;
        let samples_here = (WAVE / pixels.max(1)).clamp(1, samples - self.done);
        let pixels_here = room.capacity / samples_here;
        let mut first = 0;
        while first < pixels {
            self.options.check_cancelled()?;
            let (part, film_pixel) = (first / PART, first % PART);
            let count = pixels_here.min(pixels - first).min(PART - film_pixel);
            let first_sample = self.done;
            let params = Params {
                first_pixel: first,
                film_pixel,
                first_sample,
                samples_here,
                ..self.params
            };
            let wave = Wave { tracer: self.tracer, looks, room, params, pixels: count };
            wave.expose(film.part(part), self.options)?;
            first += count;
            if let Some(progress) = self.options.progress {
                let of_these = samples_here as f32 * (first as f32 / pixels as f32);
                progress((self.done as f32 + of_these) / samples as f32);
            }
        }
        self.done += samples_here;
        Ok(self.done < samples)
    }

    /// The picture with the samples taken so far; a black one if none were.
    ///
    /// # Errors
    ///
    /// If the picture is cancelled, or the device fails.
    pub fn picture(&self) -> Result<Picture, RenderError> {
        let Params { width, height, samples, .. } = self.params;
        let Renderer { film, device, .. } = &*self.renderer;
        let film = film.read(device, [width, height], [self.done.max(1), samples])?;
        Ok(shade::develop(film, self.options)?)
    }
}
