//! The machine, the versions and the date that a record starts with.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::{env, thread};

use anyhow::Result;
use sysinfo::System;

use crate::engines::Embree;
use crate::record::{Machine, Measured, Record};

mod built {
    include!(concat!(env!("OUT_DIR"), "/built.rs"));
}

/// Dependencies whose version a record names.
const LIBRARIES: [&str; 3] = ["kdray", "obvhs", "kdtree-ray"];

/// A record of what was measured by this process, which started on `machine`.
pub(crate) fn record(
    machine: Machine,
    embree: Option<&Path>,
    measured: Measured,
) -> Result<Record> {
    Ok(Record {
        date: jiff::Zoned::now().date().to_string(),
        command: env::args().skip(1).collect(),
        commit: commit(),
        machine,
        versions: versions(embree)?,
        measured,
    })
}

/// This machine, with its load now.
pub(crate) fn machine() -> Machine {
    let mut system = System::new();
    system.refresh_cpu_all();
    system.refresh_memory();
    let cpu = system
        .cpus()
        .first()
        .map_or_else(String::new, |cpu| cpu.brand().trim().to_owned());
    Machine {
        cpu,
        cores: thread::available_parallelism().map_or(1, usize::from),
        simd: simd(),
        memory_bytes: system.total_memory(),
        os: format!("{} {}", env::consts::OS, env::consts::ARCH),
        load_before: System::load_average().one,
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn simd() -> Vec<String> {
    let found = [
        ("sse4.2", is_x86_feature_detected!("sse4.2")),
        ("avx", is_x86_feature_detected!("avx")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ];
    found
        .into_iter()
        .filter(|(_, has)| *has)
        .map(|(name, _)| name.to_owned())
        .collect()
}

#[cfg(target_arch = "aarch64")]
fn simd() -> Vec<String> {
    vec!["neon".to_owned()]
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
fn simd() -> Vec<String> {
    Vec::new()
}

fn versions(embree: Option<&Path>) -> Result<BTreeMap<String, String>> {
    let named = built::DEPENDENCIES
        .iter()
        .filter(|(name, _)| LIBRARIES.contains(name));
    let mut versions: BTreeMap<_, _> = named
        .map(|(name, version)| ((*name).to_owned(), (*version).to_owned()))
        .collect();
    versions.insert("rustc".to_owned(), built::RUSTC_VERSION.to_owned());
    if let Some(path) = embree {
        versions.insert("embree".to_owned(), Embree::version(path)?);
    }
    Ok(versions)
}

/// The repository's revision; uncommitted changes show as `-dirty`.
fn commit() -> Option<String> {
    let arguments = ["describe", "--always", "--dirty", "--abbrev=12"];
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success()).then(|| text.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_library_of_interest_has_a_version() {
        let versions = versions(None).expect("no library is opened");
        for name in LIBRARIES.into_iter().chain(["rustc"]) {
            assert!(versions.contains_key(name), "{name} in {versions:?}");
        }
    }
}
