//! Surface directions as colours.

use glam::Vec3;

use crate::film::{Film, Sample};
use crate::scene::Scene;
use crate::{Camera, Cancelled, Picture, RenderOptions};

const BACKGROUND: Vec3 = Vec3::splat(0.05);

/// Red is right, green is up and blue is toward +z; the middle of each is 0.
pub(super) fn picture(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, Cancelled> {
    let film = Film::expose(scene, camera, options, |probe, ray, _| {
        let colour = |normal: Vec3| 0.5 * normal + 0.5;
        let light = probe.closest(ray).map_or(BACKGROUND, |point| colour(point.shading));
        Sample { light, surface: None }
    })?;
    let byte = |channel: f32| (255.0 * channel.clamp(0.0, 1.0) + 0.5) as u8;
    Ok(Picture::develop(&film, |pixel| pixel.light.to_array().map(byte)))
}
