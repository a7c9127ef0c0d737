//! Path tracing: sun and sky, reflected by matt surfaces [Kaj86].

use glam::Vec3;
use kdray::{Ray, Tracer};

use super::smoothed;
use crate::film::Film;
use crate::pixel::{Sample, Surface};
use crate::point::Point;
use crate::probe::Probe;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::sky::Dome;
use crate::warp::cosine_hemisphere;
use crate::{Camera, Cancelled, Picture, RenderOptions, tone};

pub(super) fn expose(
    scene: (&Scene, &Tracer),
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Film, Cancelled> {
    let dome = Dome::over(camera, options);
    let shade = |probe: &mut Probe, ray: &Ray, sampler: &mut Sampler| {
        let background = dome.backdrop(Vec3::from(ray.direction));
        let Some(point) = probe.closest(ray) else {
            return Sample { light: background, surface: None };
        };
        let reflected = point.albedo * arriving(probe, &dome, point, sampler, options.bounces);
        let surface =
            Surface { position: point.position, normal: point.shading, albedo: point.albedo };
        Sample { light: reflected.lerp(background, point.haze), surface: Some(surface) }
    };
    Film::expose(scene, camera, options, shade)
}

pub(super) fn develop(film: Film, options: &RenderOptions) -> Result<Picture, Cancelled> {
    let film = smoothed(film, options)?;
    let lightened = || tone::exposure(film.pixels.iter().map(|pixel| pixel.light));
    let exposure = options.exposure.unwrap_or_else(lightened);
    Ok(Picture::develop(&film, |pixel| tone::encode(tone::map(exposure * pixel.light))))
}

/// The light that falls on a point, as the radiance of a white matt surface there: an estimate by
/// one path of at most `bounces` reflections more.
fn arriving(
    probe: &mut Probe,
    dome: &Dome,
    mut point: Point,
    sampler: &mut Sampler,
    bounces: u32,
) -> Vec3 {
    let (mut light, mut throughput) = (Vec3::ZERO, Vec3::ONE);
    for _bounce in 0..=bounces {
        light += throughput * from_sun(probe, dome, &point, sampler.next());
        let ray = point.leave(cosine_hemisphere(point.shading, sampler.next()));
        match probe.closest(&ray) {
            Some(next) => {
                throughput *= next.albedo;
                point = next;
            }
            None => return light + throughput * dome.radiance(Vec3::from(ray.direction)),
        }
    }
    light
}

/// The part of it that comes straight from the sun.
fn from_sun(probe: &mut Probe, dome: &Dome, point: &Point, square: [f32; 2]) -> Vec3 {
    let Some((direction, strength)) = dome.sun(square) else { return Vec3::ZERO };
    let visible = point.visibility(direction);
    if visible == 0.0 || probe.occluded(&point.leave(direction)) {
        return Vec3::ZERO;
    }
    visible * point.shading.dot(direction) * strength
}
