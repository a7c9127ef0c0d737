//! `kdray build`, `info`, `validate` and `bench`.

mod common;

use std::fs;

use common::Bench;
use predicates::prelude::*;

#[test]
fn a_built_tree_is_a_tree_of_its_mesh() {
    let bench = Bench::new();
    let report = bench.json("build knot.off -o knot.tree --json --threads 2");
    assert_eq!(report["triangles"], 1440);
    assert_eq!(
        (report["builder"].as_str(), report["device"].as_str()),
        (Some("exact"), Some("cpu"))
    );
    assert_eq!((report["mesh"].as_str(), &report["threads"]), (Some("knot.off"), &2.into()));
    for figure in ["build_s", "e_inner", "e_leaf", "e_prim", "sah_cost", "bytes_per_triangle"] {
        assert!(report[figure].as_f64().is_some_and(|x| x > 0.0), "{figure}");
    }
    for count in ["peak_bytes", "nodes", "leaves", "references", "depth", "tree_bytes"] {
        assert!(report[count].as_u64().is_some_and(|x| x > 0), "{count}");
    }
    assert!(report["empty_leaves"].is_u64());
    let verdict = bench.json("validate knot.tree knot.off --json");
    assert_eq!((&verdict["valid"], &verdict["violation"]), (&true.into(), &().into()));
    bench.kdray("validate knot.tree knot.off").assert().success();
}

#[test]
fn any_builder_and_number_of_threads_gives_the_same_file() {
    let bench = Bench::new();
    let file = |name: &str, how: &str| {
        bench.kdray(&format!("build knot.off -o {name} {how}")).assert().success();
        fs::read(bench.path(name)).expect("it was built")
    };
    let first = file("a", "--threads 1");
    assert_eq!(first, file("b", "--threads 3"));
    assert_eq!(first, file("c", "--builder resort --threads 2"));
    assert_eq!(first, file("d", "--builder naive"));
    assert_ne!(first, file("e", "--cost-traversal 9"), "prices matter");
    assert_ne!(first, file("f", "--max-depth 4"), "and so does the depth");
    assert_ne!(first, file("g", "--no-clip"), "and clipping");
}

#[test]
fn the_sah_cost_is_that_of_the_prices_asked_for() {
    let bench = Bench::new();
    let prices = "--cost-traversal 15 --cost-intersect 20 --empty-bonus 0";
    let report = bench.json(&format!("build knot.off --json {prices}"));
    let figure = |name: &str| report[name].as_f64().expect(name);
    let expected = 0.75 * figure("e_inner") + figure("e_prim");
    assert!((figure("sah_cost") - expected).abs() < 1e-6 * expected);
    assert_eq!(bench.files(), ["cube.off", "knot.off"], "no -o, no file");
}

#[test]
fn a_tree_file_is_described() {
    let bench = Bench::new();
    let built = bench.json("build knot.off -o knot.tree --json");
    let info = bench.json("info knot.tree --json");
    assert_eq!(info["kind"], "tree");
    for figure in ["triangles", "nodes", "references", "sah_cost", "leaf_histogram"] {
        assert_eq!(info[figure], built[figure], "{figure}");
    }
    let histogram = info["leaf_histogram"].as_array().expect("an array");
    let leaves: u64 = histogram.iter().filter_map(|count| count.as_u64()).sum();
    assert_eq!(info["leaves"], leaves);
    let text = predicate::str::contains("a ray meets").and(predicate::str::contains("####"));
    bench.kdray("info knot.tree").assert().success().stdout(text);
}

#[test]
fn a_mesh_is_described() {
    let bench = Bench::new();
    bench.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n");
    let cube = bench.json("info cube.off --json");
    assert_eq!(
        (&cube["kind"], &cube["vertices"], &cube["triangles"]),
        (&"mesh".into(), &8.into(), &12.into())
    );
    assert_eq!((&cube["closed"], &cube["lower"]), (&true.into(), &vec![-1.0; 3].into()));
    let open = bench.json("info open.obj --json");
    assert_eq!((&open["closed"], &open["boundary_edges"]), (&false.into(), &3.into()));
    assert_eq!(open["degenerate_triangles"], 1);
    bench
        .kdray("info cube.off")
        .assert()
        .success()
        .stdout(predicate::str::contains("closed     yes"));
}

#[test]
fn a_tree_of_another_mesh_is_no_tree_of_this_one() {
    let bench = Bench::new();
    bench.kdray("build knot.off -o knot.tree").assert().success();
    let assert = bench.kdray("validate knot.tree cube.off").assert().code(1);
    assert.stdout(predicate::str::contains("violation: the tree is of another mesh"));
    let output = bench.kdray("validate knot.tree cube.off --json").assert().code(1);
    let verdict: serde_json::Value =
        serde_json::from_slice(&output.get_output().stdout).expect("one JSON value");
    assert_eq!(verdict["valid"], false);
    assert!(verdict["violation"].is_string());
}

#[test]
fn a_damaged_tree_file_is_refused() {
    let bench = Bench::new();
    bench.kdray("build knot.off -o knot.tree").assert().success();
    let mut bytes = fs::read(bench.path("knot.tree")).expect("it was built");
    bytes[200] ^= 4;
    fs::write(bench.path("bent.tree"), &bytes).expect("written");
    fs::write(bench.path("cut.tree"), &bytes[..300]).expect("written");
    for command in ["info bent.tree", "validate bent.tree knot.off"] {
        let error = bench.error(command);
        assert!(error.starts_with("bent.tree: ") && error.contains("checksum"), "{error}");
    }
    assert!(bench.error("info cut.tree").contains("bytes"));
    assert!(bench.error("validate knot.off knot.off").contains("not a kdray tree file"));
}

#[test]
fn a_memory_budget_that_is_too_small_leaves_nothing_behind() {
    let bench = Bench::new();
    let error = bench.error("build knot.off -o knot.tree --memory-budget 10K");
    assert!(error.contains("memory budget of 10000 bytes"), "{error}");
    assert_eq!(bench.files(), ["cube.off", "knot.off"]);
    bench.kdray("build knot.off -o knot.tree --memory-budget 64MiB").assert().success();
    assert_eq!(bench.files(), ["cube.off", "knot.off", "knot.tree"]);
}

#[test]
fn errors_name_file_place_and_reason() {
    let bench = Bench::new();
    bench.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    bench.write("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n");
    let missing = bench.error("build nowhere.ply -o x");
    assert!(missing.starts_with("nowhere.ply: ") && missing.contains("No such file"), "{missing}");
    assert_eq!(missing.matches("No such file").count(), 1, "{missing}");
    let bad = bench.error("info bad.obj");
    assert!(bad.starts_with("bad.obj: line 4") && bad.contains("out of range"), "{bad}");
    let nan = bench.error("build nan.obj");
    assert!(nan.starts_with("nan.obj: vertex 3") && nan.contains("--drop-non-finite"), "{nan}");
    let repaired = bench.json("build nan.obj --drop-non-finite --json");
    assert_eq!(repaired["triangles"], 1);
    let folder = bench.error("build cube.off -o nowhere/cube.tree");
    assert!(folder.starts_with("cannot write nowhere/cube.tree: "), "{folder}");
    let option = bench.error("build cube.off --empty-bonus 2");
    assert!(option.contains("empty_bonus is 2"), "{option}");
}

#[test]
fn with_json_an_error_is_an_object_too() {
    let bench = Bench::new();
    let output = bench.kdray("info nowhere.ply --json").assert().code(1);
    let value: serde_json::Value =
        serde_json::from_slice(&output.get_output().stdout).expect("one JSON value");
    assert!(value["error"].as_str().is_some_and(|error| error.starts_with("nowhere.ply: ")));
}

#[test]
fn wrong_usage_is_status_2() {
    let bench = Bench::new();
    let wrong = [
        "",
        "paint",
        "build",
        "build a --builder best",
        "build a --memory-budget x",
        "bench --passes 0",
    ];
    for arguments in wrong {
        bench.kdray(arguments).assert().code(2).stdout("");
    }
    bench.kdray("--help").assert().success().stdout(predicate::str::contains("validate"));
    bench.kdray("--version").assert().success().stdout(predicate::str::starts_with("kdray "));
}

#[test]
fn the_benchmark_measures_every_mesh_on_every_number_of_threads() {
    let bench = Bench::new();
    let report = bench.json("bench knot.off cube.off --threads 1,2,1 --passes 1 --json");
    let results = report["results"].as_array().expect("an array");
    let cells: Vec<_> = results
        .iter()
        .map(|result| (result["mesh"].as_str().expect("a name"), result["threads"].as_u64()))
        .collect();
    let expected = [("knot.off", 1), ("knot.off", 2), ("cube.off", 1), ("cube.off", 2)];
    assert_eq!(cells, expected.map(|(mesh, threads)| (mesh, Some(threads))));
    for figure in ["build_best_s", "build_median_s", "peak_bytes", "primary", "bounce", "shadow"] {
        assert!(results[0][figure].as_f64().is_some_and(|x| x > 0.0), "{figure}");
    }
    bench
        .kdray("bench cube.off --passes 1")
        .assert()
        .success()
        .stdout(predicate::str::contains("Mray/s"));
}
