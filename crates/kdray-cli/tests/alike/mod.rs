//! Pictures of the CPU and of a GPU.

use std::path::Path;

/// Fails if more than a thousandth of the pixels differ by more than 2 of a channel's 255: where
/// roundings let a ray pass an edge on the other side.
pub(crate) fn assert_alike(found: &Path, expected: &Path) {
    let open = |path: &Path| image::open(path).expect("a picture").into_rgb8();
    let [found_pixels, expected_pixels] = [found, expected].map(open);
    assert_eq!(found_pixels.dimensions(), expected_pixels.dimensions());
    let pairs = found_pixels.pixels().zip(expected_pixels.pixels());
    let is_far = |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 2)
    };
    let far = pairs.filter(is_far).count();
    assert!(1000 * far <= found_pixels.pixels().len(), "{}: {far} pixels", found.display());
}
