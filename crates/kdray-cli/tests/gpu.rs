//! `--device` of `kdray build`, `query` and `render`.

mod alike;
mod common;

use std::fs;

use alike::assert_alike;
use common::Bench;
use kdray_test::vulkan;
use ndarray::Array2;
use ndarray_npy::WriteNpyExt;
use serde_json::Value;

/// The command with the software devices of the tests.
fn on_gpu(bench: &Bench, arguments: &str) -> Value {
    let mut command = bench.kdray(arguments);
    if vulkan::override_name().is_none() {
        command.envs(vulkan::environment());
    }
    let output = command.assert().success().get_output().stdout.clone();
    serde_json::from_slice(&output).expect("one JSON value and no more")
}

#[test]
fn the_gpu_writes_the_file_of_the_cpu() {
    let bench = Bench::new();
    let device = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    bench.json("build knot.off -o cpu.tree --json");
    let report = on_gpu(&bench, &format!("build knot.off -o gpu.tree --device {device} --json"));
    assert_eq!(
        fs::read(bench.path("cpu.tree")).unwrap(),
        fs::read(bench.path("gpu.tree")).unwrap()
    );
    assert_eq!(bench.files(), ["cpu.tree", "cube.off", "gpu.tree", "knot.off"]);
    assert_eq!(report["device"], "gpu");
    for name in ["adapter", "driver"] {
        assert!(report[name].as_str().is_some_and(|text| !text.is_empty()), "{report}");
    }
    assert!(report["peak_bytes"].as_u64() > report["tree_bytes"].as_u64(), "{report}");
    assert_eq!(report["crown"], 0, "the device can bind what it takes");
    assert!(report.get("profile").is_none(), "nobody asked");
}

#[test]
fn a_profile_has_stages_and_levels() {
    let bench = Bench::new();
    let device = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    let arguments = "--profile --bandwidth 100 --json";
    let report = on_gpu(&bench, &format!("build knot.off --device {device} {arguments}"));
    let profile = &report["profile"];
    let moved = profile["bytes_moved"].as_f64().expect("bytes");
    let floor = profile["floor_s"].as_f64().expect("seconds");
    assert!((floor - moved / 1e11).abs() < 1e-9 * moved, "{profile}");
    let stages = profile["stages"].as_array().expect("stages");
    let sum = |figure: &str| stages.iter().filter_map(|stage| stage[figure].as_u64()).sum::<u64>();
    assert_eq!(Some(sum("dispatches")), profile["dispatches"].as_u64());
    assert_eq!(Some(sum("read_bytes") + sum("written_bytes")), profile["bytes_moved"].as_u64());
    for name in ["events", "finish", "sweep", "split", "clip", "sort", "pack"] {
        assert!(stages.iter().any(|stage| stage["stage"] == name), "{name}");
    }
    let levels = profile["levels"].as_array().expect("levels");
    assert_eq!(levels[0]["references"], report["triangles"]);
    // One for each level, and one for the size of the tree.
    assert_eq!(profile["readbacks"].as_u64(), Some(levels.len() as u64 + 1));
}

#[test]
fn what_cannot_be_is_said() {
    let bench = Bench::new();
    let error = bench.error("build knot.off --profile");
    assert_eq!(error, "--profile needs a GPU: give --device gpu");
    let error = bench.error("build knot.off --device no-such-gpu");
    assert!(error.starts_with("cannot work on the GPU; --device cpu always can: "), "{error}");
}

#[test]
fn the_gpu_answers_what_the_cpu_answers() {
    let bench = Bench::new();
    let device = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    let ray = |index: usize| {
        let (sin, cos) = (0.37 * index as f32).sin_cos();
        [9.0 * cos, 0.01 * index as f32, 9.0 * sin, -cos, 0.0, -sin]
    };
    let rays: Vec<[f32; 6]> = (0..200).map(ray).collect();
    let file = fs::File::create(bench.path("rays.npy")).expect("the folder can be written");
    Array2::from(rays).write_npy(file).expect("written");
    for kind in ["closest", "any", "all", "count"] {
        let query = format!("query knot.off --rays rays.npy --kind {kind} --json");
        bench.json(&format!("{query} -o cpu.npz"));
        let report = on_gpu(&bench, &format!("{query} -o gpu.npz --device {device}"));
        let read = |name| fs::read(bench.path(name)).expect("it was written");
        assert!(read("cpu.npz") == read("gpu.npz"), "{kind}");
        assert!(report["adapter"].as_str().is_some_and(|text| !text.is_empty()), "{report}");
    }
    let profiled = "query knot.off --rays rays.npy --profile --json";
    let report = on_gpu(&bench, &format!("{profiled} --device {device}"));
    let profile = &report["profile"];
    for figure in ["million_rays_per_s", "cpu_million_rays_per_s", "nodes_per_ray"] {
        assert!(profile[figure].as_f64().is_some_and(|figure| figure > 0.0), "{report}");
    }
    assert!(profile["triangle_tests_per_ray"].as_f64() >= Some(1.0), "every ray hits: {report}");
    assert_eq!(profile["private_bytes"].as_array().map(Vec::len), Some(2), "{report}");
    let error = bench.error("query knot.off --rays rays.npy --profile");
    assert!(error.contains("--device gpu"), "{error}");
    let points = "query knot.off --points rays.npy --device gpu";
    let assert = bench.kdray(points).assert().failure();
    let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(message.contains("--device cpu"), "{message}");
}

#[test]
fn the_gpu_makes_the_picture_of_the_cpu() {
    let bench = Bench::new();
    let device = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    for shading in ["normals", "ao", "path"] {
        let render = format!("render knot.off --size 60x44 --spp 3 --shading {shading} --json");
        let on_cpu = bench.json(&format!("{render} -o cpu.png"));
        let report = on_gpu(&bench, &format!("{render} -o gpu.png --device {device}"));
        assert_alike(&bench.path("gpu.png"), &bench.path("cpu.png"));
        for figure in ["rays", "hits"] {
            let [cpu, gpu] = [&on_cpu, &report].map(|json| json[figure].as_f64().expect(figure));
            assert!((gpu - cpu).abs() <= 1e-3 * cpu, "{shading}: {gpu} {figure}, not {cpu}");
        }
        assert_eq!(report["device"], "gpu");
    }
}

#[test]
fn what_rays_cost_is_asked_of_the_cpu() {
    let bench = Bench::new();
    let device = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    let render = format!("render knot.off --size 20x20 --shading cost --device {device}");
    let mut command = bench.kdray(&render);
    let assert = command.envs(vulkan::environment()).assert().failure();
    let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert_eq!(message, "kdray: error: only rays on the CPU have their cost shown\n");
    assert_eq!(bench.files(), ["cube.off", "knot.off"]);
}
