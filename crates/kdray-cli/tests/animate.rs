//! `kdray animate`.

mod alike;
mod common;

use std::fs;

use alike::assert_alike;
use common::Bench;
use image::AnimationDecoder as _;
use image::codecs::gif::GifDecoder;
use kdray_test::vulkan;
use serde_json::Value;

/// A cube whose positions move to the right over three frames.
fn bench() -> Bench {
    let bench = Bench::new();
    let cube = kdray_mesh::generate::cube();
    let step = |step: usize| {
        let moved = move |p: &[f64; 3]| [p[0] + step as f64, p[1], p[2]].map(|x| x as f32);
        cube.positions.iter().flat_map(moved)
    };
    let bytes: Vec<u8> = (0..3).flat_map(step).flat_map(f32::to_le_bytes).collect();
    fs::write(bench.path("cube.f32"), bytes).expect("written");
    bench
}

fn pictures(bench: &Bench, folder: &str) -> Vec<image::RgbImage> {
    let open = |index: usize| image::open(bench.path(&format!("{folder}/frame_{index:04}.png")));
    (0..3).map(|index| open(index).expect("a picture").into_rgb8()).collect()
}

#[test]
fn frames_become_a_gif() {
    let bench = bench();
    let report = bench.json("animate cube.off cube.f32 -o cube.gif --size 48x32 --spp 1 --json");
    assert_eq!((&report["triangles"], &report["device"]), (&12.into(), &"cpu".into()));
    let frames = report["frames"].as_array().expect("frames");
    assert_eq!(frames.len(), 3);
    let sum = |figure: &str| -> f64 {
        frames.iter().map(|frame| frame[figure].as_f64().expect(figure)).sum()
    };
    for figure in ["build_s", "trace_s"] {
        assert!((report[figure].as_f64().expect(figure) - sum(figure)).abs() < 1e-9, "{figure}");
    }
    let speed = 3.0 / (sum("build_s") + sum("trace_s"));
    assert!((report["frames_per_s"].as_f64().expect("a speed") / speed - 1.0).abs() < 1e-6);
    let file = std::io::BufReader::new(fs::File::open(bench.path("cube.gif")).expect("written"));
    let frames = GifDecoder::new(file).expect("a GIF").into_frames();
    let frames = frames.collect_frames().expect("whole frames");
    assert_eq!(frames.len(), 3);
    assert!(frames.windows(2).all(|pair| pair[0].buffer() != pair[1].buffer()), "it moves");
    assert_eq!(frames[0].buffer().dimensions(), (48, 32));
}

#[test]
fn a_folder_has_a_picture_a_frame_and_the_camera_stands_still() {
    let bench = bench();
    let how = "--size 60x20 --spp 1 --shading normals --eye 1,0,9 --target 1,0,0 --fov 60";
    bench.kdray(&format!("animate cube.off cube.f32 -o film {how}")).assert().success();
    let middle = |picture: &image::RgbImage| {
        let background = *picture.get_pixel(0, 0);
        let covered = |x: &u32| *picture.get_pixel(*x, 10) != background;
        let columns: Vec<u32> = (0..60).filter(covered).collect();
        columns.iter().sum::<u32>() as f64 / columns.len() as f64
    };
    let middles: Vec<f64> = pictures(&bench, "film").iter().map(middle).collect();
    assert!((middles[1] - 29.5).abs() < 1.0, "{middles:?}");
    assert!(middles[0] < middles[1] - 1.5 && middles[2] > middles[1] + 1.5, "{middles:?}");
}

#[test]
fn a_gpu_gives_the_same_pictures_and_keeps_its_memory() {
    let bench = bench();
    let device = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    let how = "--size 48x32 --spp 1 --json";
    bench.json(&format!("animate cube.off cube.f32 -o cpu {how}"));
    let arguments = format!("animate cube.off cube.f32 -o gpu --device {device} {how}");
    let mut command = bench.kdray(&arguments);
    let output = command.envs(vulkan::environment()).assert().success().get_output().stdout.clone();
    let report: Value = serde_json::from_slice(&output).expect("one JSON value");
    assert_eq!(report["device"], "gpu");
    assert!(report["adapter"].as_str().is_some_and(|name| !name.is_empty()));
    for index in 0..3 {
        let [cpu, gpu] = ["cpu", "gpu"].map(|place| format!("{place}/frame_{index:04}.png"));
        assert_alike(&bench.path(&gpu), &bench.path(&cpu));
    }
    // Trees stay on the device: what goes up in a frame is the mesh, its looks and parameters.
    for figure in ["uploaded_bytes", "downloaded_bytes"] {
        let of = |frame: usize| report["frames"][frame][figure].as_u64().expect(figure);
        assert!(of(1) > of(0) && of(2) - of(1) == of(1) - of(0), "{figure}: {report}");
    }
    for figure in ["device_bytes", "allocations", "compiled_kernels"] {
        let of = |frame: usize| report["frames"][frame][figure].as_u64().expect(figure);
        assert!(of(0) > 0 && of(0) == of(1) && of(1) == of(2), "{figure}: {report}");
    }
}

#[test]
fn frames_that_do_not_fit_are_refused_and_leave_no_film() {
    let bench = bench();
    let error = bench.error("animate cube.off knot.off -o film.gif");
    assert!(
        error.contains("knot.off: frame 1: 1440 triangles, but the first frame has 12"),
        "{error}"
    );
    fs::write(bench.path("short.f32"), [0; 100]).expect("written");
    let error = bench.error("animate cube.off short.f32 -o film.gif");
    assert!(
        error.starts_with("short.f32: ") && error.contains("whole number of frames"),
        "{error}"
    );
    fs::write(bench.path("nan.f32"), [0xff; 96]).expect("written");
    let error = bench.error("animate cube.off nan.f32 -o film.gif");
    assert!(error.starts_with("frame 0: ") && error.contains("vertex 0"), "{error}");
    bench.kdray("animate").assert().code(2);
    bench.kdray("animate cube.off --rate 0").assert().code(2);
    let files = bench.files();
    assert!(!files.iter().any(|file| file.contains("film")), "{files:?}");
}
