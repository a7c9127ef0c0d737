//! Ambient occlusion: the part of a surface's surroundings that is open [ZIK98].

use glam::Vec3;
use kdray::Ray;

use super::smoothed;
use crate::film::{Film, Sample, Surface};
use crate::probe::Probe;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::warp::cosine_hemisphere;
use crate::{Camera, Cancelled, Picture, RenderOptions, tone};

/// Radiance of a surface with nothing near it.
const OPEN: Vec3 = Vec3::splat(0.86);

/// Radiance of what is behind all surfaces.
const BACKDROP: Vec3 = Vec3::splat(0.5);

pub(super) fn picture(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, Cancelled> {
    let reach = options.reach * scene.diagonal;
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
    let film = smoothed(Film::expose(scene, camera, options, shade)?, options)?;
    Ok(Picture::develop(&film, |pixel| tone::encode(pixel.light)))
}
