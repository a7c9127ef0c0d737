//! What was measured, as a JSON file in `bench/records`.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use crate::definition::{Mode, RaySet};
use crate::memory::Memory;

/// A dated record of one command on one machine.
#[derive(Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Record {
    /// Year, month and day.
    pub(crate) date: String,
    /// The arguments as given.
    pub(crate) command: Vec<String>,
    /// The revision of the repository it ran in, if it ran in one.
    pub(crate) commit: Option<String>,
    pub(crate) machine: Machine,
    /// Compiler and libraries by name.
    pub(crate) versions: BTreeMap<String, String>,
    pub(crate) measured: Measured,
}

/// What the figures depend on besides the code.
#[derive(Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Machine {
    pub(crate) cpu: String,
    pub(crate) cores: usize,
    /// Vector instructions the CPU has, of those that change an engine's code path.
    pub(crate) simd: Vec<String>,
    pub(crate) memory_bytes: u64,
    pub(crate) os: String,
    /// Average number of running processes in the minute before the start.
    pub(crate) load_before: f64,
}

/// The figures of one subcommand.
#[derive(Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Measured {
    Engines(Comparison),
    Scaling(Vec<Size>),
}

/// Engines side by side.
#[derive(Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Comparison {
    /// The engine that ratios refer to and hits are checked against.
    pub(crate) baseline: String,
    pub(crate) resolution: u32,
    /// Whose closest hits the secondary rays start from.
    pub(crate) hits_from: String,
    pub(crate) scenes: Vec<SceneRecord>,
    /// Engines and scenes that were left out, with the reason.
    pub(crate) missing: Vec<String>,
}

#[derive(Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct SceneRecord {
    pub(crate) name: String,
    pub(crate) triangles: usize,
    pub(crate) sets: Vec<SetRecord>,
    pub(crate) builds: Vec<BuildRecord>,
    pub(crate) traces: Vec<TraceRecord>,
}

/// A ray set as it came out on a scene.
#[derive(Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct SetRecord {
    pub(crate) set: RaySet,
    pub(crate) rays: usize,
    /// Rays that the baseline says hit something, if it ran.
    pub(crate) hits: Option<usize>,
}

#[derive(Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct BuildRecord {
    pub(crate) engine: String,
    pub(crate) threads: usize,
    /// Wall seconds from positions and indices to an index that answers.
    pub(crate) seconds: Spread,
    /// CPU seconds of the whole process in the pass with the least.
    pub(crate) cpu_seconds: f64,
    /// Held by the finished index, everything included that it needs to answer.
    pub(crate) final_bytes: u64,
    /// The most held at one time during the build.
    pub(crate) peak_bytes: u64,
}

#[derive(Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct TraceRecord {
    pub(crate) engine: String,
    pub(crate) mode: Mode,
    pub(crate) threads: usize,
    pub(crate) set: RaySet,
    /// Millions of rays per wall second.
    pub(crate) mrays: Spread,
    /// The same by CPU seconds of the process, shared out among the tracing threads: on a busy
    /// machine the nearer to what an idle one would give.
    pub(crate) cpu_mrays: Spread,
    /// Share of the rays whose hit is not the baseline's, if the baseline ran.
    pub(crate) differ: Option<f64>,
}

/// The best and the median of some passes.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Spread {
    pub(crate) best: f64,
    pub(crate) median: f64,
    pub(crate) passes: usize,
}

/// A build of the generated scene at one size.
#[derive(Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Size {
    pub(crate) triangles: usize,
    pub(crate) threads: usize,
    pub(crate) seconds: Spread,
    pub(crate) memory: Memory,
}

impl Spread {
    /// Of times: the least is best. None without samples.
    pub(crate) fn of_seconds(samples: &[f64]) -> Option<Spread> {
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (best, median) = (*sorted.first()?, *sorted.get(sorted.len() / 2)?);
        Some(Spread { best, median, passes: sorted.len() })
    }

    /// Of rates, out of the times that `count` million rays took.
    pub(crate) fn of_rates(count: f64, seconds: &[f64]) -> Option<Spread> {
        let times = Spread::of_seconds(seconds)?;
        Some(Spread { best: count / times.best, median: count / times.median, ..times })
    }
}

impl Record {
    /// Reads a record; errors name the file.
    pub(crate) fn load(path: &Path) -> Result<Record> {
        let text =
            fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))?;
        serde_json::from_str(&text).with_context(|| format!("in {}", path.display()))
    }

    /// Writes the record as indented JSON, in a folder that need not exist yet.
    pub(crate) fn save(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self)? + "\n";
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))?;
        }
        fs::write(path, text).with_context(|| format!("writing {}", path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_has_the_best_and_the_middle_pass() {
        let times = Spread::of_seconds(&[4.0, 1.0, 2.0]).expect("samples");
        assert_eq!(times, Spread { best: 1.0, median: 2.0, passes: 3 });
        let rates = Spread::of_rates(8.0, &[4.0, 1.0, 2.0]).expect("samples");
        assert_eq!(rates, Spread { best: 8.0, median: 4.0, passes: 3 });
        assert_eq!(Spread::of_seconds(&[]), None);
    }
}
