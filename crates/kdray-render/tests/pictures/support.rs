//! How pictures are made and compared.

use std::path::Path;

use kdray::{BuildOptions, Mesh, Tracer, Tree};
use kdray_render::{Camera, Cancelled, Picture, RenderOptions, Shading, render};

/// Two pictures of the same samples, shaded with other roundings: this part of the pixels may differ
/// by more than [`STEPS`] of a channel's 255, where a ray passed an edge on the other side.
const FEW: f64 = 1e-3;

/// What roundings alone can do to a channel.
const STEPS: u8 = 2;

/// The mean difference of channels, of 255.
const MEAN: f64 = 0.01;

/// Options of a picture that takes no time.
pub(crate) fn small(shading: Shading) -> RenderOptions<'static> {
    RenderOptions { width: 96, height: 72, shading, ..RenderOptions::default() }
}

/// The picture of the CPU.
pub(crate) fn picture(mesh: &Mesh, options: &RenderOptions) -> Result<Picture, Cancelled> {
    let tree = Tree::build(mesh, &BuildOptions::default()).expect("nothing limits the build");
    let camera = Camera::framing_mesh(mesh, Camera::Y_UP, options.aspect());
    render(&Tracer::new(mesh, &tree), mesh, &camera, options)
}

/// The same, of options that do not cancel it.
#[cfg(feature = "gpu")]
pub(crate) fn on_cpu(mesh: &Mesh, options: &RenderOptions) -> Picture {
    picture(mesh, options).expect("not cancelled")
}

/// Fails unless two pictures are the same but for roundings; so are their numbers of rays and hits.
#[cfg(feature = "gpu")]
pub(crate) fn assert_alike(found: &Picture, expected: &Picture, name: &str) {
    let count = |a: u64, b: u64| a.abs_diff(b) as f64 <= FEW * b as f64;
    assert!(count(found.rays, expected.rays), "{name}: {} {}", found.rays, expected.rays);
    assert!(count(found.hits, expected.hits), "{name}: {} {}", found.hits, expected.hits);
    let difference = difference(&found.pixels, &expected.pixels);
    println!("{name}: {difference:?}");
    assert!(difference.is_small(), "{name}: {difference:?}");
}

/// Fails unless the picture is the one in the folder of snapshots.
pub(crate) fn snapshot(picture: &Picture, name: &str) {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/snapshots/{name}.png"));
    let found = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    picture.save_png(&found).expect("the folder can be written");
    let advice =
        format!("{} is what there is now: look, and copy it if it is right", found.display());
    let kept = image::open(&place).unwrap_or_else(|error| panic!("{error}. {advice}")).into_rgb8();
    assert_eq!(kept.dimensions(), (picture.width, picture.height), "{advice}");
    let kept: Vec<[u8; 3]> = kept.pixels().map(|pixel| pixel.0).collect();
    let difference = difference(&picture.pixels, &kept);
    assert!(difference.is_small(), "{difference:?}. {advice}");
}

#[derive(Debug)]
#[expect(dead_code, reason = "messages have all of it")]
struct Difference {
    /// The part of the pixels that differ by more than [`STEPS`].
    part: f64,
    mean: f64,
    most: u8,
}

impl Difference {
    fn is_small(&self) -> bool {
        self.part <= FEW && self.mean <= MEAN
    }
}

fn difference(found: &[[u8; 3]], expected: &[[u8; 3]]) -> Difference {
    assert_eq!(found.len(), expected.len());
    let channels = |(a, b): (&[u8; 3], &[u8; 3])| [0, 1, 2].map(|i| a[i].abs_diff(b[i]));
    let all: Vec<[u8; 3]> = found.iter().zip(expected).map(channels).collect();
    let of_pixel = |channels: &[u8; 3]| channels.iter().copied().max().unwrap_or(0);
    let far = all.iter().filter(|channels| of_pixel(channels) > STEPS).count();
    let sum: u64 = all.as_flattened().iter().map(|channel| u64::from(*channel)).sum();
    let pixels = all.len().max(1) as f64;
    Difference {
        part: far as f64 / pixels,
        mean: sum as f64 / (3.0 * pixels),
        most: all.iter().map(of_pixel).max().unwrap_or(0),
    }
}
