//! The command from end to end, on a generated scene and without Embree.

use std::path::Path;
use std::process::{Command, Output};

fn bench(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kdray-bench"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    command.args(arguments).current_dir(root).env_remove("KDRAY_EMBREE");
    command.output().expect("the binary runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_run_makes_the_record_that_the_table_is_made_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = folder.path().join("new/record.json");
    let record = record.to_str().expect("unicode");
    let definition = "bench/definitions/smoke.toml";
    let run = bench(&["run", "--definition", definition, "--threads", "2,1", "-o", record]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let table = bench(&["table", record]);
    assert!(table.status.success(), "{}", text(&table.stderr));
    assert_eq!(text(&run.stdout), text(&table.stdout));
    for row in ["| kdray |", "| obvhs-bvh2 |", "| kdtree-ray |", "1 thread\n", "2 threads\n"] {
        assert!(text(&table.stdout).contains(row), "{row} in {}", text(&table.stdout));
    }
}

#[test]
fn a_missing_engine_fails_the_run_and_says_how_to_get_it() {
    let definition = "bench/definitions/peers.toml";
    let run = bench(&["run", "--definition", definition, "--engines", "embree-high"]);
    assert!(!run.status.success());
    let message = text(&run.stderr);
    for part in ["engine embree-high is missing", "bench/get-embree", "scene bunny is missing"] {
        assert!(message.contains(part), "{part} in {message}");
    }
}

#[test]
fn what_is_missing_can_be_allowed_and_is_listed() {
    let definition = "bench/definitions/peers.toml";
    let arguments =
        ["run", "--definition", definition, "--engines", "embree-high", "--allow-missing"];
    let run = bench(&arguments);
    assert!(run.status.success(), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("Left out: engine embree-high is missing"));
}

#[test]
fn scaling_prints_a_row_for_every_doubling() {
    let run = bench(&["scaling", "--from", "500", "--to", "2000"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    assert_eq!(text(&run.stdout).lines().count(), 2 + 3, "{}", text(&run.stdout));
}
