//! `kdray view`, without a window.

mod common;

use std::fs;

use common::Bench;

const HOW: &str = "--headless --size 200x120 --spp 1 --no-statistics";

fn picture(bench: &Bench, arguments: &str) -> image::RgbImage {
    bench.kdray(&format!("view {arguments} -o view.png")).assert().success();
    image::open(bench.path("view.png")).expect("a picture").into_rgb8()
}

#[test]
fn without_cells_it_is_the_picture_of_render() {
    let bench = Bench::new();
    let viewed = picture(&bench, &format!("cube.off {HOW}"));
    let render = "render cube.off -o render.png --size 200x120 --spp 1 --shading normals";
    bench.kdray(render).assert().success();
    let rendered = image::open(bench.path("render.png")).expect("a picture").into_rgb8();
    let differ = viewed.pixels().zip(rendered.pixels()).filter(|(a, b)| a != b).count();
    // The camera's angles are rounded on the way.
    assert!(differ < 200 * 120 / 100, "{differ} pixels differ");
}

#[test]
fn cells_are_drawn_by_depth() {
    let bench = Bench::new();
    let ink = |depth: u32| {
        let cells = picture(&bench, &format!("knot.off {HOW} --cells {depth}"));
        let plain = picture(&bench, &format!("knot.off {HOW}"));
        plain.pixels().zip(cells.pixels()).filter(|(a, b)| a != b).count()
    };
    let inks = [0, 2, 6].map(ink);
    assert!(inks[0] > 300 && inks[0] < inks[1] && inks[1] < inks[2], "{inks:?}");
}

#[test]
fn statistics_are_on_the_picture() {
    let bench = Bench::new();
    let how = "cube.off --headless --size 500x200 --spp 1";
    let written = picture(&bench, how);
    let plain = picture(&bench, &format!("{how} --no-statistics"));
    let differ = |x: u32, y: u32| written.get_pixel(x, y) != plain.get_pixel(x, y);
    let count = |rows: std::ops::Range<u32>| {
        rows.flat_map(|y| (0..500).map(move |x| (x, y))).filter(|(x, y)| differ(*x, *y)).count()
    };
    assert!(count(0..64) > 20_000, "dark, under two lines");
    let bright = (0..64 * 500).filter(|at| written.get_pixel(at % 500, at / 500)[0] > 180);
    assert!(bright.count() > 300, "letters");
    assert_eq!(count(64..200), 0);
}

#[test]
fn frames_are_shown_one_by_one() {
    let bench = Bench::new();
    let cube = kdray_mesh::generate::cube();
    let numbers = |scale: f32| cube.positions.iter().flatten().map(move |x| scale * *x as f32);
    let bytes: Vec<u8> =
        [1.0, 0.5].into_iter().flat_map(numbers).flat_map(f32::to_le_bytes).collect();
    fs::write(bench.path("cube.f32"), bytes).expect("written");
    let arguments = format!("view cube.off cube.f32 {HOW} --eye 0,0,9 --target 0,0,0 --frame");
    let rays = |frame: usize| {
        let report = bench.json(&format!("{arguments} {frame} --json"));
        assert_eq!((&report["frames"], &report["frame"]), (&2.into(), &frame.into()));
        fs::read(bench.path("view.png")).expect("a picture")
    };
    assert_ne!(rays(0), rays(1));
    let error = bench.error(&format!("{arguments} 2"));
    assert_eq!(error, "--frame is 2, but there are 2 frames, from 0 on");
}

#[test]
fn what_cannot_be_shown_is_said() {
    let bench = Bench::new();
    assert!(bench.error("view nowhere.ply --headless").starts_with("nowhere.ply: "));
    bench.kdray("view cube.off --headless --cells 99").assert().code(2);
    bench.kdray("view cube.off -o view.png").assert().code(2);
    assert_eq!(bench.files(), ["cube.off", "knot.off"]);
}
