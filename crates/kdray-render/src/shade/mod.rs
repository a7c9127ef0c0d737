//! The ways to shade a picture.

pub(crate) mod ao;
mod cost;
pub(crate) mod normals;
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
    let scene = (&Scene::new(mesh, camera, options), tracer);
    options.check_cancelled()?;
    let film = match options.shading {
        Shading::Normals => normals::expose(scene, camera, options),
        Shading::Ao => ao::expose(scene, camera, options),
        Shading::Path => path::expose(scene, camera, options),
        Shading::Cost => cost::expose(scene, camera, options),
    };
    develop(film?, options)
}

/// The picture of a film on which light fell.
pub(crate) fn develop(film: Film, options: &RenderOptions) -> Result<Picture, Cancelled> {
    match options.shading {
        Shading::Normals => Ok(normals::develop(&film)),
        Shading::Ao => ao::develop(film, options),
        Shading::Path => path::develop(film, options),
        Shading::Cost => Ok(cost::develop(&film)),
    }
}

/// A film on which light fell, without the noise if that is asked for.
fn smoothed(mut film: Film, options: &RenderOptions) -> Result<Film, Cancelled> {
    if options.denoise {
        denoise(&mut film, options)?;
    }
    Ok(film)
}
