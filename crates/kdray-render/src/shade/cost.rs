//! What camera rays cost in the tree.

use glam::Vec3;
use kdray::{Ray, Tracer};

use crate::film::Film;
use crate::pixel::Sample;
use crate::probe::Probe;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::{Camera, Cancelled, Picture, RenderOptions, legend};

/// The part of the pixels that may be too expensive for the scale.
const OFF_SCALE: f32 = 0.002;

/// Inner nodes, leaves and blocks of triangles that the rays of a pixel meet, as a heat map.
pub(super) fn expose(
    scene: (&Scene, &Tracer),
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Film, Cancelled> {
    let shade = |probe: &mut Probe, ray: &Ray, _: &mut Sampler| {
        let counts = probe.cost(ray);
        let total = counts.steps + counts.leaves + counts.tests;
        Sample { light: Vec3::splat(total as f32), surface: None }
    };
    Film::expose(scene, camera, options, shade)
}

pub(super) fn develop(film: &Film) -> Picture {
    let most = scale(film.pixels.iter().map(|pixel| pixel.light.x).collect());
    let mut picture = Picture::develop(film, |pixel| heat(pixel.light.x / most));
    legend::draw(&mut picture, most, "nodes + triangle blocks a ray");
    picture
}

/// The colour of a value in 0..=1, in even steps of perception.
pub(crate) fn heat(value: f32) -> [u8; 3] {
    colorous::INFERNO.eval_continuous(f64::from(value.clamp(0.0, 1.0))).as_array()
}

/// A round number that nearly all values are below.
fn scale(mut values: Vec<f32>) -> f32 {
    if values.is_empty() {
        return 1.0;
    }
    let rank = (values.len() - 1) as f32 * (1.0 - OFF_SCALE);
    let (_, high, _) = values.select_nth_unstable_by(rank as usize, f32::total_cmp);
    let power = 10_f32.powf(high.max(1.0).log10().floor());
    let round = [1.0, 1.2, 1.6, 2.0, 2.4, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    round.into_iter().map(|step| step * power).find(|step| *step >= *high).unwrap_or(*high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_ends_in_a_round_number_above_nearly_all() {
        assert_eq!(scale((0..1000).map(|value| value as f32).collect()), 1000.0);
        assert_eq!(scale(vec![37.0; 9]), 40.0);
        assert_eq!(scale(vec![0.0; 9]), 1.0);
        assert_eq!(scale(Vec::new()), 1.0);
    }

    #[test]
    fn hotter_is_brighter() {
        let brightness = |value| heat(value).map(u32::from).iter().sum::<u32>();
        assert!((0..10).all(|i| brightness(0.1 * i as f32) < brightness(0.1 * (i + 1) as f32)));
    }
}
