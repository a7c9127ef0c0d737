//! Pictures of the CPU.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use kdray::Mesh;
use kdray_mesh::{Loaded, generate};
use kdray_render::{Cancelled, RenderOptions, Shading, Sky};

use crate::support::{picture, small, snapshot};

fn mesh(loaded: &Loaded) -> Mesh {
    loaded.mesh().expect("generated meshes are finite")
}

fn brightness(pixel: &[u8; 3]) -> u32 {
    pixel.iter().map(|channel| u32::from(*channel)).sum()
}

/// A white thing in a white world cannot be seen: no light is lost or made.
#[test]
fn white_surfaces_under_a_constant_sky_have_its_colour() {
    let options = RenderOptions {
        sky: Sky::constant([0.5; 3]),
        albedo: Some([1.0; 3]),
        ground: false,
        bounces: 200,
        exposure: Some(1.0),
        ..small(Shading::Path)
    };
    for loaded in [generate::sphere(4), generate::torus_knot([2, 3], 200, 24)] {
        let picture = picture(&mesh(&loaded), &options).expect("not cancelled");
        assert!(picture.hits > 10_000, "{}", picture.hits);
        for pixel in &picture.pixels {
            assert!(pixel.iter().all(|channel| channel.abs_diff(188) <= 1), "{pixel:?}");
        }
    }
}

/// Nothing convex is in its own way, wherever it is and however large.
#[test]
fn convex_surfaces_do_not_shadow_themselves() {
    for loaded in [generate::sphere(4), generate::cube(), generate::grid(3)] {
        for (scale, offset) in [(1.0, 0.0), (1e-3, 2e-3), (300.0, 1000.0), (7.0, -40.0)] {
            let mut moved = loaded.clone();
            for position in &mut moved.positions {
                *position = position.map(|x| scale * x + offset);
            }
            let options = RenderOptions {
                ground: false,
                samples: Some(1),
                denoise: false,
                ..small(Shading::Ao)
            };
            let picture = picture(&mesh(&moved), &options).expect("not cancelled");
            assert!(picture.hits > 0);
            let black = picture.pixels.iter().filter(|pixel| **pixel == [0; 3]).count();
            assert_eq!(black, 0, "pixels at scale {scale}, offset {offset}");
        }
    }
}

#[test]
fn pictures_are_those_of_the_snapshots() {
    let mesh = mesh(&generate::showcase(3000));
    for (shading, name) in
        [(Shading::Normals, "normals"), (Shading::Ao, "ao"), (Shading::Path, "path")]
    {
        snapshot(&picture(&mesh, &small(shading)).expect("not cancelled"), name);
    }
}

#[test]
fn the_picture_does_not_depend_on_the_threads() {
    let mesh = mesh(&generate::showcase(3000));
    for shading in [Shading::Normals, Shading::Ao, Shading::Path, Shading::Cost] {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let picture = || picture(&mesh, &small(shading)).expect("not cancelled");
            pool.expect("threads").install(picture)
        };
        assert_eq!(on(1), on(3), "{shading:?}");
    }
}

/// The statistics of a picture that people have looked at.
#[test]
fn the_showcase_has_sky_sunlight_and_shadows() {
    let picture = picture(&mesh(&generate::showcase(20_000)), &small(Shading::Path)).unwrap();
    let (sky, rest) = picture.pixels.split_at(96 * 6);
    assert!(sky.iter().all(|[r, g, b]| r <= g && g <= b && *b > 200), "a pale blue sky");
    let part = |of: &dyn Fn(&[u8; 3]) -> bool| {
        rest.iter().filter(|pixel| of(pixel)).count() as f32 / rest.len() as f32
    };
    let [bright, dark] = [part(&|p| brightness(p) > 600), part(&|p| brightness(p) < 330)];
    assert!((0.2..0.8).contains(&bright), "sunlit ground: {bright}");
    assert!((0.02..0.4).contains(&dark), "shadows: {dark}");
    assert!(part(&|[r, g, _]| *r > 180 && *g < 140) > 0.02, "something red");
    assert!(part(&|[r, g, b]| *r < 100 && g.min(b) > &70) > 0.02, "something teal");
}

#[test]
fn more_samples_are_less_noise() {
    let mesh = mesh(&generate::torus_knot([2, 3], 200, 24));
    let sampled = |samples, denoise| {
        let options = RenderOptions { samples: Some(samples), denoise, ..small(Shading::Path) };
        picture(&mesh, &options).expect("not cancelled")
    };
    let reference = sampled(256, false);
    let error = |picture: kdray_render::Picture| {
        let pairs = picture.pixels.iter().zip(&reference.pixels);
        let squares = pairs.map(|(a, b)| f64::from(a[1].abs_diff(b[1])).powi(2));
        (squares.sum::<f64>() / picture.pixels.len() as f64).sqrt()
    };
    let [noisy, finer, smooth] =
        [error(sampled(4, false)), error(sampled(32, false)), error(sampled(4, true))];
    assert!(finer < 0.55 * noisy, "{noisy} {finer}");
    assert!(smooth < 0.9 * noisy, "{noisy} {smooth}");
}

#[test]
fn the_cost_is_high_where_the_mesh_is_and_nothing_beside_it() {
    let picture = picture(&mesh(&generate::sphere(5)), &small(Shading::Cost)).unwrap();
    let at = |x: usize, y: usize| brightness(&picture.pixels[y * 96 + x]);
    assert!(at(48, 36) > at(0, 0), "the middle of the sphere costs more than a miss");
    let mut shades = picture.pixels.clone();
    shades.sort_unstable();
    shades.dedup();
    assert!(shades.len() > 50, "{} shades", shades.len());
}

#[test]
fn normals_of_a_cube_have_three_colours() {
    let options = RenderOptions { samples: Some(1), ..small(Shading::Normals) };
    let picture = picture(&mesh(&generate::cube()), &options).expect("not cancelled");
    for face in [[255, 128, 128], [128, 255, 128], [128, 128, 255]] {
        let count = picture.pixels.iter().filter(|pixel| **pixel == face).count();
        assert!(count > 100, "{face:?}: {count} pixels");
    }
}

#[test]
fn a_mesh_without_triangles_is_a_picture_of_the_sky() {
    let empty = Mesh::new(&[], &[]).expect("nothing is wrong with it");
    for shading in [Shading::Normals, Shading::Ao, Shading::Path, Shading::Cost] {
        assert_eq!(picture(&empty, &small(shading)).expect("not cancelled").hits, 0);
    }
}

#[test]
fn pictures_can_be_watched_and_cancelled() {
    let mesh = mesh(&generate::cube());
    let seen = Mutex::new(Vec::new());
    let watch = |fraction| seen.lock().expect("no panic").push(fraction);
    let options = RenderOptions { progress: Some(&watch), ..small(Shading::Ao) };
    picture(&mesh, &options).expect("not cancelled");
    let seen = seen.lock().expect("no panic");
    assert!(seen.contains(&1.0) && seen.iter().all(|fraction| (0.0..=1.0).contains(fraction)));
    let cancel = AtomicBool::new(true);
    let options = RenderOptions { cancel: Some(&cancel), ..small(Shading::Path) };
    assert_eq!(picture(&mesh, &options), Err(Cancelled));
}
