//! Where the light comes from.

use glam::Vec3;

use crate::warp::cone;
use crate::{Camera, RenderOptions};

/// A sky that changes from horizon to zenith, and perhaps a sun. Colours are linear radiances; 1 is
/// the white of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Radiance overhead.
    pub zenith: [f32; 3],
    /// Radiance at the horizon.
    pub horizon: [f32; 3],
    /// Radiance from below the horizon.
    pub below: [f32; 3],
    /// The sun, if it shines.
    pub sun: Option<Sun>,
}

/// A disk that shines evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Height above the horizon in degrees.
    pub elevation: f32,
    /// Degrees to the left of the viewer's back.
    pub azimuth: f32,
    /// Radiance of a white matt surface that faces the sun.
    pub strength: [f32; 3],
    /// Angle across half the disk in degrees: more makes shadows softer.
    pub radius: f32,
}

impl Default for Sky {
    /// A clear day, the sun behind the viewer's left shoulder.
    fn default() -> Self {
        Self {
            zenith: [0.22, 0.38, 0.68],
            horizon: [0.72, 0.80, 0.88],
            below: [0.55, 0.52, 0.47],
            sun: Some(Sun {
                elevation: 40.0,
                azimuth: 72.0,
                strength: [1.5, 1.28, 0.98],
                radius: 1.8,
            }),
        }
    }
}

impl Sky {
    /// The same light from everywhere.
    #[must_use]
    pub const fn constant(radiance: [f32; 3]) -> Self {
        Self { zenith: radiance, horizon: radiance, below: radiance, sun: None }
    }
}

/// A sky over a world in which a given direction is up.
pub(crate) struct Dome {
    pub(crate) up: Vec3,
    pub(crate) sky: Sky,
    /// Direction, cosine of the radius and strength of the sun.
    pub(crate) sun: Option<(Vec3, f32, Vec3)>,
}

impl Dome {
    /// The sky of a picture.
    pub(crate) fn over(camera: &Camera, options: &RenderOptions) -> Self {
        let toward_viewer = Vec3::from(camera.eye) - Vec3::from(camera.target);
        Self::new(options.sky, camera.vertical(), toward_viewer)
    }

    /// `toward_viewer` is the direction that the sun's azimuth is counted from.
    pub(crate) fn new(sky: Sky, up: Vec3, toward_viewer: Vec3) -> Self {
        let sun = sky.sun.map(|sun| {
            let level = toward_viewer.reject_from_normalized(up).try_normalize();
            let level = level.unwrap_or_else(|| up.any_orthonormal_vector());
            let (sin, cos) = sun.azimuth.to_radians().sin_cos();
            let heading = cos * level + sin * level.cross(up);
            let (climb, reach) = sun.elevation.to_radians().sin_cos();
            let direction = climb * up + reach * heading;
            (direction, sun.radius.to_radians().cos(), Vec3::from(sun.strength))
        });
        Self { up, sky, sun }
    }

    /// Light that comes in against `direction`, the sun's left out.
    pub(crate) fn radiance(&self, direction: Vec3) -> Vec3 {
        let height = direction.dot(self.up);
        let horizon = Vec3::from(self.sky.horizon);
        if height >= 0.0 {
            horizon.lerp(self.sky.zenith.into(), 1.0 - (1.0 - height).max(0.0).powi(3))
        } else {
            horizon.lerp(self.sky.below.into(), (-6.0 * height).min(1.0))
        }
    }

    /// What is behind everything: the sky, which ends at the horizon.
    pub(crate) fn backdrop(&self, direction: Vec3) -> Vec3 {
        let height = direction.dot(self.up);
        self.radiance(direction - height.min(0.0) * self.up)
    }

    /// A direction toward the sun, and the radiance of a white surface that faces it.
    pub(crate) fn sun(&self, square: [f32; 2]) -> Option<(Vec3, Vec3)> {
        let (direction, cos_radius, strength) = self.sun?;
        Some((cone(direction, cos_radius, square), strength))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_stands_where_it_is_told() {
        let dome = Dome::new(Sky::default(), Vec3::Y, Vec3::Z);
        let (direction, _) = dome.sun([0.0, 0.0]).expect("it shines");
        assert!((direction.y.asin().to_degrees() - 40.0).abs() < 0.01);
        assert!(direction.x < 0.0 && direction.z > 0.0, "behind on the left: {direction}");
    }

    #[test]
    fn a_constant_sky_is_constant() {
        let dome = Dome::new(Sky::constant([0.5; 3]), Vec3::Y, Vec3::Z);
        for direction in [Vec3::Y, Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.8, 0.0)] {
            assert!(dome.radiance(direction).distance(Vec3::splat(0.5)) < 1e-6);
        }
        assert!(dome.sun([0.5, 0.5]).is_none());
    }
}
