//! `kdray devices`, on the software drivers that `.ci/vulkan` brings.

use assert_cmd::Command;
use kdray_test::vulkan;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;

fn kdray(arguments: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("kdray"));
    command.args(arguments);
    command
}

#[test]
fn all_adapters_are_listed() {
    let mut command = kdray(&["devices", "--json"]);
    let output = command.envs(vulkan::environment()).assert().success().get_output().stdout.clone();
    let report: serde_json::Value = serde_json::from_slice(&output).expect("one JSON object");
    assert!(report["cpu"]["threads"].as_u64() > Some(0), "{report}");
    let gpus = report["gpus"].as_array().expect("a list");
    assert!(!gpus.is_empty(), "{report}");
    for (index, gpu) in gpus.iter().enumerate() {
        assert_eq!(gpu["index"], index, "{report}");
        assert!(gpu["binding_bytes"].as_u64() >= Some(128 << 20), "{report}");
        assert!(gpu["driver"].as_str().is_some_and(|driver| !driver.is_empty()), "{report}");
    }
    if vulkan::override_name().is_none() {
        kdray(&["devices"])
            .envs(vulkan::environment())
            .assert()
            .success()
            .stdout(contains("llvmpipe").and(contains("SwiftShader")).and(contains("software")));
    }
}

#[test]
fn a_machine_without_drivers_has_no_gpu() {
    let none = std::env::temp_dir().join("no such driver.json");
    let mut command = kdray(&["devices"]);
    let command = command.env("VK_DRIVER_FILES", &none).env("VK_ICD_FILENAMES", &none);
    let output = command.assert().success();
    if cfg!(target_os = "linux") {
        output.stdout(contains("cpu: ").and(contains("no gpu")));
    }
}
