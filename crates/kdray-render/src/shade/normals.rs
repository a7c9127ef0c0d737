//! Surface directions as colours.

use glam::Vec3;
use kdray::Tracer;

use crate::film::Film;
use crate::pixel::Sample;
use crate::scene::Scene;
use crate::{Camera, Cancelled, Picture, RenderOptions};

pub(crate) const BACKGROUND: Vec3 = Vec3::splat(0.05);

/// Red is right, green is up and blue is toward +z; the middle of each is 0.
pub(super) fn expose(
    scene: (&Scene, &Tracer),
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Film, Cancelled> {
    Film::expose(scene, camera, options, |probe, ray, _| {
        let colour = |normal: Vec3| 0.5 * normal + 0.5;
        let light = probe.closest(ray).map_or(BACKGROUND, |point| colour(point.shading));
        Sample { light, surface: None }
    })
}

pub(super) fn develop(film: &Film) -> Picture {
    let byte = |channel: f32| (255.0 * channel.clamp(0.0, 1.0) + 0.5) as u8;
    Picture::develop(film, |pixel| pixel.light.to_array().map(byte))
}
