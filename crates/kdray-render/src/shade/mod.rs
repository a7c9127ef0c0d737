//! The ways to shade a picture.

mod ao;
mod cost;
mod normals;
mod path;

use kdray::{Mesh, Tracer};

use crate::denoise::denoise;
use crate::film::Film;
use crate::scene::Scene;
use crate::{Camera, Cancelled, Picture, RenderOptions, Shading};

pub(crate) use cost::heat;

/// A picture of `mesh` as `camera` sees it, on the threads of the current `rayon` pool.
///
/// The tracer must be of the same mesh. The same input gives the same picture on any number of
/// threads.
///
/// # Errors
///
/// [`Cancelled`], if the caller asked for it.
///
/// # Panics
///
/// If the tracer is of a mesh with more triangles.
pub fn render(
    tracer: &Tracer,
    mesh: &Mesh,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, Cancelled> {
    options.check_cancelled()?;
    let scene = Scene::new(tracer, mesh, camera, options);
    match options.shading {
        Shading::Normals => normals::picture(&scene, camera, options),
        Shading::Ao => ao::picture(&scene, camera, options),
        Shading::Path => path::picture(&scene, camera, options),
        Shading::Cost => cost::picture(&scene, camera, options),
    }
}

/// A film on which light fell, without the noise if that is asked for.
fn smoothed(mut film: Film, options: &RenderOptions) -> Result<Film, Cancelled> {
    if options.denoise {
        denoise(&mut film, options)?;
    }
    Ok(film)
}
