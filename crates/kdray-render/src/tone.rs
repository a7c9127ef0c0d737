//! From light to the numbers of a picture.

use glam::Vec3;

use crate::pixel::luminance;

/// Where highlights begin to be compressed.
const SHOULDER: f32 = 0.76;

/// How fast compressed highlights lose their colour.
const BLEACH: f32 = 0.15;

/// Brings any radiance into 0..=1: what is below the shoulder stays as it is, what is above is
/// compressed and, the brighter the more, bleached (after the Khronos PBR neutral tone mapper).
pub(crate) fn map(light: Vec3) -> Vec3 {
    let peak = light.max_element();
    if peak <= SHOULDER {
        return light;
    }
    let room = 1.0 - SHOULDER;
    let compressed = 1.0 - room * room / (peak + room - SHOULDER);
    let bleached = 1.0 - 1.0 / (BLEACH * (peak - compressed) + 1.0);
    (light * (compressed / peak)).lerp(Vec3::splat(compressed), bleached)
}

/// The part of the pixels that may be darker than [`MIDDLE`].
const DARK_PART: f32 = 0.6;

/// How bright an exposed picture is in the middle.
const MIDDLE: f32 = 0.4;

/// The factor that brings dark pictures to a pleasant brightness; 1 for others.
pub(crate) fn exposure(pixels: impl Iterator<Item = Vec3>) -> f32 {
    let mut brightness: Vec<f32> = pixels.map(luminance).collect();
    if brightness.is_empty() {
        return 1.0;
    }
    let rank = ((brightness.len() - 1) as f32 * DARK_PART) as usize;
    let (_, middle, _) = brightness.select_nth_unstable_by(rank, f32::total_cmp);
    (MIDDLE / middle.max(1e-3)).clamp(1.0, 64.0)
}

/// The sRGB bytes of a linear colour.
pub(crate) fn encode(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|channel| {
        let x = channel.clamp(0.0, 1.0);
        let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (255.0 * encoded + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_light_is_never_darker_and_never_too_bright() {
        let mut last = 0.0;
        for step in 0..1000 {
            let mapped = map(Vec3::splat(0.01 * step as f32)).x;
            assert!(mapped >= last && mapped <= 1.0, "{step}: {last} {mapped}");
            last = mapped;
        }
        assert!(last > 0.95);
    }

    #[test]
    fn only_dark_pictures_are_lightened() {
        let grey = |light: f32| [Vec3::splat(light); 10].into_iter();
        assert_eq!(exposure(grey(0.5)), 1.0);
        assert!((exposure(grey(0.1)) - 4.0).abs() < 1e-4);
        assert_eq!(exposure(grey(0.0)), 64.0);
        assert_eq!(exposure(std::iter::empty()), 1.0);
    }

    #[test]
    fn the_transfer_curve_is_that_of_srgb() {
        let encoded = encode(Vec3::new(0.0, 0.215_861, 1.0));
        assert_eq!(encoded, [0, 128, 255]);
        assert_eq!(encode(Vec3::new(f32::NAN, -1.0, 9.0)), [0, 0, 255]);
    }
}
