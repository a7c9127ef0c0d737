//! Ambient occlusion: the part of a surface's surroundings that is open [ZIK98].

use glam::Vec3;
use kdray::{Ray, Tracer};

use super::smoothed;
use crate::film::Film;
use crate::pixel::{Sample, Surface};
use crate::probe::Probe;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::warp::cosine_hemisphere;
use crate::{Camera, Cancelled, Picture, RenderOptions, tone};

/// Radiance of a surface with nothing near it.
pub(crate) const OPEN: Vec3 = Vec3::splat(0.86);

/// Radiance of what is behind all surfaces.
pub(crate) const BACKDROP: Vec3 = Vec3::splat(0.5);

pub(super) fn expose(
    scene: (&Scene, &Tracer),
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Film, Cancelled> {
    let reach = options.reach * scene.0.diagonal;
    let shade = |probe: &mut Probe, ray: &Ray, sampler: &mut Sampler| {
        let Some(point) = probe.closest(ray) else {
            return Sample { light: BACKDROP, surface: None };
        };
        let direction = cosine_hemisphere(point.shading, sampler.next());
        let feeler = Ray { t_max: reach, ..point.leave(direction) };
        let open = if probe.occluded(&feeler) { Vec3::ZERO } else { OPEN };
        let light = open.lerp(BACKDROP, point.haze);
        let surface =
            Surface { position: point.position, normal: point.shading, albedo: Vec3::ONE };
        Sample { light, surface: Some(surface) }
    };
    Film::expose(scene, camera, options, shade)
}

pub(super) fn develop(film: Film, options: &RenderOptions) -> Result<Picture, Cancelled> {
    let film = smoothed(film, options)?;
    Ok(Picture::develop(&film, |pixel| tone::encode(pixel.light)))
}
