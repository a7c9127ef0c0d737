//! `kdray render`.

mod common;

use common::Bench;
use predicates::prelude::*;

fn picture(bench: &Bench, name: &str) -> image::RgbImage {
    image::open(bench.path(name)).expect("a picture").into_rgb8()
}

#[test]
fn without_a_mesh_the_built_in_scene_is_shown() {
    let bench = Bench::new();
    let report = bench.json("render --triangles 2000 --size 64x48 --spp 1 --json");
    assert_eq!((&report["mesh"], &report["image"]), (&"showcase".into(), &"kdray.png".into()));
    assert_eq!((&report["triangles"], &report["device"]), (&2000.into(), &"cpu".into()));
    assert_eq!(report["builder"], "exact");
    for figure in ["build_s", "trace_s"] {
        assert!(report[figure].as_f64().is_some_and(|x| x > 0.0), "{figure}");
    }
    let count = |name: &str| report[name].as_u64().expect(name);
    assert!(count("threads") > 0 && count("rays") >= 64 * 48);
    assert!(count("hits") > 0 && count("hits") < count("rays"));
    assert_eq!(picture(&bench, "kdray.png").dimensions(), (64, 48));
}

#[test]
fn shadings_builders_and_threads() {
    let bench = Bench::new();
    let render = |name: &str, how: &str| {
        bench
            .kdray(&format!("render knot.off --size 48x36 --spp 2 -o {name} {how}"))
            .assert()
            .success();
        picture(&bench, name)
    };
    let pictures = ["normals", "ao", "path", "cost"]
        .map(|shading| render(&format!("{shading}.png"), &format!("--shading {shading}")));
    for (index, picture) in pictures.iter().enumerate() {
        assert!(!pictures[..index].contains(picture), "shadings differ");
    }
    assert_eq!(pictures[2], render("a.png", "--threads 1"));
    assert_eq!(pictures[2], render("b.png", "--threads 3 --builder naive"));
}

#[test]
fn the_camera_goes_where_it_is_told() {
    let bench = Bench::new();
    let hits = |view: &str| {
        let render = "render cube.off --size 32x32 --spp 1 --shading normals --json";
        bench.json(&format!("{render} {view}"))["hits"].as_u64().expect("a count")
    };
    assert_eq!(hits("--eye 0,0,4 --fov 10"), 1024, "close to a face");
    assert_eq!(hits("--eye 0,0,4 --target -0.5,9,4"), 0, "the other way");
    assert!((1..1024).contains(&hits("--up z")));
}

#[test]
fn far_coordinates_are_those_of_the_file() {
    let bench = Bench::new();
    bench.write("far.obj", "v 4000000 0 0\nv 4000002 0 0\nv 4000000 2 0\nf 1 2 3\n");
    let view = "--eye 4000000.5,0.5,3 --target 4000000.5,0.5,0 --fov 5";
    let render = "render far.obj --size 16x16 --spp 1 --shading normals --json";
    assert_eq!(bench.json(&format!("{render} {view}"))["hits"], 256);
}

#[test]
fn what_cannot_be_is_refused() {
    let bench = Bench::new();
    for arguments in [
        "render --size 0x9",
        "render --size big",
        "render --spp 0",
        "render --eye 1,2",
        "render --fov 200",
        "render --sun 1",
        "render cube.off --triangles 9",
        "render --shading pretty",
    ] {
        bench.kdray(arguments).assert().code(2).stderr(predicate::str::starts_with("error: "));
    }
    let error = bench.error("render cube.off -o nowhere/a.png");
    assert!(error.starts_with("cannot write nowhere/a.png: "), "{error}");
    assert_eq!(bench.files(), ["cube.off", "knot.off"]);
}

/// Ctrl-C in the middle of a long picture.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_a_picture_and_leaves_nothing() {
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let bench = Bench::new();
    let child = Command::new(assert_cmd::cargo::cargo_bin!("kdray"))
        .args(["render", "--triangles", "2000", "--spp", "4096", "--threads", "1"])
        .current_dir(bench.path(""))
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    std::thread::sleep(Duration::from_millis(1500));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill is there").success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "kdray: cancelled\n");
    assert_eq!(bench.files(), ["cube.off", "knot.off"]);
}
