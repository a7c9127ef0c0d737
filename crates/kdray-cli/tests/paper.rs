//! `kdray bench paper`.

mod common;

use std::fs;

use common::Bench;
use kdray_test::vulkan;
use predicates::prelude::*;
use serde_json::Value;

/// A folder `meshes` in which a knot stands for the bunny.
fn bench() -> Bench {
    let bench = Bench::new();
    fs::create_dir(bench.path("meshes")).expect("a folder");
    bench.write("meshes/bunny.ply", &ply(&kdray_mesh::generate::torus_knot([2, 3], 60, 12)));
    bench
}

fn ply(mesh: &kdray_mesh::Loaded) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    );
    for [x, y, z] in &mesh.positions {
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c] in &mesh.triangles {
        text += &format!("3 {a} {b} {c}\n");
    }
    text
}

/// What a page would load when it is opened, or when somebody follows a link.
fn outside(page: &str) -> Vec<&str> {
    let marks = ["src=\"", "href=\"", "url(", "@import", "srcset=", "<script", "<link", "<iframe"];
    let after =
        |mark: &'static str| page.match_indices(mark).map(move |(at, _)| &page[at + mark.len()..]);
    let loads = marks.into_iter().flat_map(after);
    loads.filter(|text| !text.starts_with("data:image/png;base64,")).collect()
}

#[test]
fn a_report_without_a_gpu() {
    let bench = bench();
    let arguments = "bench paper --meshes meshes --scenes bunny,angel --passes 1 -o page.html";
    let report = bench.json(&format!("{arguments} --json"));
    let scenes = report["scenes"].as_array().expect("scenes");
    assert_eq!((scenes.len(), &report["device"]), (2, &Value::Null));
    let bunny = &scenes[0];
    assert_eq!((&bunny["scene"], &bunny["status"]), (&"bunny".into(), &"measured".into()));
    assert_eq!((&bunny["likeness"], &bunny["gpu"]), (&"same".into(), &Value::Null));
    assert_eq!(bunny["tree"]["triangles"], 1440);
    assert_eq!(
        (&bunny["paper"]["build_s"], &bunny["paper"]["peer"]),
        (&0.059.into(), &"choi".into())
    );
    for figure in ["build_s", "trace_s", "peak_bytes", "final_bytes", "hits"] {
        assert!(bunny["cpu"][figure].as_f64().is_some_and(|x| x > 0.0), "{figure}");
    }
    assert!(bunny["tree"]["sah_cost"].as_f64().is_some_and(|x| x > 0.0));
    let page = fs::read_to_string(bench.path("page.html")).expect("it was written");
    assert!(outside(&page).is_empty(), "{:?}", outside(&page));
    assert_eq!(page.matches("data:image/png;base64,").count(), 1, "a picture a scene");
    assert_eq!(page.matches("<svg").count(), 1, "memory needs no GPU");
    assert!(page.contains("Nothing was built on a GPU"));
}

#[test]
fn what_is_missing_is_named() {
    let bench = bench();
    let report = bench.json("bench paper --meshes meshes --passes 1 -o page.html --json");
    let scenes = report["scenes"].as_array().expect("scenes");
    let missing = |scene: &&Value| scene["status"] == "missing";
    assert_eq!((scenes.len(), scenes.iter().filter(missing).count()), (8, 7));
    assert_eq!(scenes[5]["wanted"], "angel.ply or angel_substitute.ply");
    let page = fs::read_to_string(bench.path("page.html")).expect("it was written");
    assert!(page.contains("missing: no angel.ply or angel_substitute.ply in meshes"));
    let said = predicate::str::contains("missing: no dragon.ply in meshes");
    let arguments = "bench paper --meshes meshes --scenes dragon -o page.html --json dragon.json";
    bench.kdray(arguments).assert().success().stdout(said);
    let file = fs::read(bench.path("dragon.json")).expect("it was written");
    let file: Value = serde_json::from_slice(&file).expect("JSON");
    assert_eq!(file["scenes"][0]["status"], "missing");
}

#[test]
fn what_stands_for_a_scene_is_marked() {
    let bench = bench();
    fs::copy(bench.path("meshes/bunny.ply"), bench.path("meshes/angel_substitute.ply")).unwrap();
    let arguments = "bench paper --meshes meshes --scenes angel --passes 1 -o page.html --json";
    assert_eq!(bench.json(arguments)["scenes"][0]["likeness"], "substitute");
    let page = fs::read_to_string(bench.path("page.html")).expect("it was written");
    assert!(page.contains("a substitute") && page.contains("Angel *"));
}

#[test]
fn a_gpu_adds_its_work() {
    let bench = bench();
    let device = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    let arguments = "bench paper --meshes meshes --scenes bunny --passes 1 -o page.html --json";
    let mut command = bench.kdray(&format!("{arguments} --device {device}"));
    let output = command.envs(vulkan::environment()).assert().success().get_output().stdout.clone();
    let report: Value = serde_json::from_slice(&output).expect("one JSON value");
    let gpu = &report["scenes"][0]["gpu"];
    assert_eq!(gpu["same_tree"], true);
    assert_eq!(gpu["same_hits"], true);
    for figure in ["dispatches", "readbacks", "bytes_moved", "floor_s", "peak_bytes"] {
        assert!(gpu["profile"][figure].as_f64().is_some_and(|x| x > 0.0), "{figure}");
    }
    for list in ["stages", "levels"] {
        assert!(gpu["profile"][list].as_array().is_some_and(|list| list.len() > 5), "{list}");
    }
    for figure in ["nodes_per_ray", "leaves_per_ray", "triangle_tests_per_ray"] {
        assert!(gpu["rays"][figure].as_f64().is_some_and(|x| x > 0.0), "{figure}");
    }
    let page = fs::read_to_string(bench.path("page.html")).expect("it was written");
    for stage in gpu["profile"]["stages"].as_array().expect("stages") {
        let name = stage["stage"].as_str().expect("a name");
        assert!(page.contains(&format!("</span> {name}</li>")), "no legend has {name}");
    }
    assert!(outside(&page).is_empty(), "{:?}", outside(&page));
    assert_eq!(page.matches("<svg").count(), 7);
    assert_eq!(
        page.matches("<figcaption").count(),
        7 + 1,
        "every chart and picture has a sentence"
    );
    let is_software = report["device"]["is_software"] == true;
    assert_eq!(page.contains("That is a software device"), is_software);
    let speed = page.split("Build and trace").nth(1).expect("the table");
    let (speed, rest) = speed.split_once("</table>").expect("its end");
    let name = report["device"]["adapter"].as_str().expect("a name");
    assert_eq!(speed.contains(name), !is_software, "a software device is not beside the paper");
    assert_eq!(rest.contains("Times on the software device"), is_software);
}

#[test]
fn what_cannot_be_measured_leaves_no_report() {
    let bench = bench();
    let error = bench.error("bench paper --meshes meshes --device no-such-gpu");
    assert!(error.starts_with("cannot work on the GPU"), "{error}");
    let error = bench.error("bench paper --meshes meshes --scenes dragon -o nowhere/page.html");
    assert!(error.starts_with("cannot write nowhere/page.html"), "{error}");
    assert_eq!(bench.files(), ["cube.off", "knot.off", "meshes"]);
    bench.kdray("bench paper --scenes teapot").assert().code(2);
}
