//! The ways to shade a picture.

mod ao;
mod cost;
mod normals;
mod path;

use kdray::{Mesh, Tracer};

use crate::caster::{Caster, Casting, RenderError, Source};
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
    picture(&Scene::new(Source::Tracer(tracer), mesh, camera, options), camera, options)
}

/// [`render`] with rays that are traced elsewhere, such as on a GPU. Surfaces are shaded here, on the
/// threads of the current `rayon` pool.
///
/// A caster that gives the hits of [`Tracer`] makes the picture of [`render`], bit for bit.
///
/// # Errors
///
/// [`RenderError`]: the picture was cancelled, the caster failed, or it was asked for
/// [`Shading::Cost`], which is about [`Tracer`] only.
///
/// # Panics
///
/// If the caster gives hits of triangles that the mesh does not have.
pub fn render_with(
    caster: &dyn Caster,
    mesh: &Mesh,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, RenderError> {
    if options.shading == Shading::Cost {
        return Err(RenderError::Caster("only rays on the CPU have their cost shown".into()));
    }
    let scene = Scene::new(Source::Caster(Casting::new(caster)), mesh, camera, options);
    let picture = picture(&scene, camera, options);
    match scene.source {
        Source::Caster(casting) => match casting.into_failure() {
            Some(error) => Err(RenderError::Caster(error)),
            None => Ok(picture?),
        },
        Source::Tracer(_) => Ok(picture?),
    }
}

fn picture(scene: &Scene, camera: &Camera, options: &RenderOptions) -> Result<Picture, Cancelled> {
    options.check_cancelled()?;
    match options.shading {
        Shading::Normals => normals::picture(scene, camera, options),
        Shading::Ao => ao::picture(scene, camera, options),
        Shading::Path => path::picture(scene, camera, options),
        Shading::Cost => cost::picture(scene, camera, options),
    }
}

/// A film on which light fell, without the noise if that is asked for.
fn smoothed(mut film: Film, options: &RenderOptions) -> Result<Film, Cancelled> {
    if options.denoise {
        denoise(&mut film, options)?;
    }
    Ok(film)
}
