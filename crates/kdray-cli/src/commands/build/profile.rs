//! What the stages of a build on the GPU took.

use std::fmt::Write as _;

use clap::Args;
use kdray_gpu::{BuildReport, LevelReport};
use serde::Serialize;

use crate::sizes::bytes;

#[derive(Args)]
pub(crate) struct ProfileArguments {
    /// Say what every stage of a build on the GPU took; takes longer itself
    #[arg(long)]
    pub(crate) profile: bool,
    /// Memory bandwidth in GB/s for which the profile gives the least time; the default is that of
    /// the GPU in the paper
    #[arg(long, value_name = "GB/S", default_value_t = 141.7)]
    pub(crate) bandwidth: f64,
}

impl ProfileArguments {
    /// Refuses what has no meaning.
    pub(crate) fn check(&self, on_gpu: bool) -> anyhow::Result<()> {
        anyhow::ensure!(on_gpu || !self.profile, "--profile needs a GPU: give --device gpu");
        let positive = self.bandwidth.is_finite() && self.bandwidth > 0.0;
        anyhow::ensure!(positive, "--bandwidth is {}, which is not above zero", self.bandwidth);
        Ok(())
    }
}

/// What the build took, in all and by stage and level.
#[derive(Serialize)]
pub(crate) struct Profile {
    pub(crate) dispatches: u64,
    pub(crate) readbacks: u64,
    /// Bytes that the kernels read and wrote, as each counts its own.
    pub(crate) bytes_moved: u64,
    /// In GB/s.
    pub(crate) bandwidth: f64,
    /// The least time in which that bandwidth moves these bytes.
    pub(crate) floor_s: f64,
    pub(crate) kernels_ms: f64,
    pub(crate) peak_bytes: u64,
    pub(crate) final_bytes: u64,
    pub(crate) stages: Vec<Stage>,
    pub(crate) levels: Vec<Level>,
}

/// A stage on a level of the tree; where levels are built in batches, one entry a batch.
#[derive(Serialize)]
pub(crate) struct Stage {
    pub(crate) stage: &'static str,
    pub(crate) level: u32,
    pub(crate) ms: f64,
    pub(crate) dispatches: u64,
    pub(crate) read_bytes: u64,
    pub(crate) written_bytes: u64,
}

/// Nodes of one depth that were built together.
#[derive(Serialize)]
pub(crate) struct Level {
    pub(crate) level: u32,
    pub(crate) nodes: u32,
    pub(crate) references: u32,
    pub(crate) finished: u32,
    pub(crate) clipped: u32,
    pub(crate) largest_bucket: u32,
}

impl Profile {
    pub(crate) fn new(
        report: &BuildReport,
        kernels: &kdray_gpu::record::Profile,
        bandwidth: f64,
    ) -> Self {
        let total = kernels.total();
        let bytes_moved = total.moved.read + total.moved.written;
        let stage = |stage: &kdray_gpu::record::StageProfile| Stage {
            stage: stage.name,
            level: stage.level,
            ms: stage.seconds * 1e3,
            dispatches: stage.dispatches,
            read_bytes: stage.moved.read,
            written_bytes: stage.moved.written,
        };
        let level = |level: &LevelReport| Level {
            level: level.depth,
            nodes: level.nodes,
            references: level.references,
            finished: level.finished,
            clipped: level.clipped,
            largest_bucket: level.largest_bucket,
        };
        Self {
            dispatches: total.dispatches,
            readbacks: report.readbacks,
            bytes_moved,
            bandwidth,
            floor_s: bytes_moved as f64 / (bandwidth * 1e9),
            kernels_ms: total.seconds * 1e3,
            peak_bytes: report.peak_bytes,
            final_bytes: report.tree_bytes,
            stages: kernels.stages.iter().map(stage).collect(),
            levels: report.levels.iter().map(level).collect(),
        }
    }

    /// The stages, all levels together, and the totals.
    pub(crate) fn text(&self) -> String {
        let mut text = "\nstage          ms  dispatches        read     written\n".to_owned();
        let mut names: Vec<&str> = Vec::new();
        for stage in &self.stages {
            if !names.contains(&stage.stage) {
                names.push(stage.stage);
            }
        }
        for name in names {
            let of_stage = || self.stages.iter().filter(|stage| stage.stage == name);
            let sum = |what: fn(&Stage) -> u64| of_stage().map(what).sum::<u64>();
            let ms: f64 = of_stage().map(|stage| stage.ms).sum();
            let (read, written) = (sum(|s| s.read_bytes), sum(|s| s.written_bytes));
            let dispatches = sum(|stage| stage.dispatches);
            let (read, written) = (bytes(read), bytes(written));
            writeln!(text, "{name:8}{ms:9.1}{dispatches:12}{read:>12}{written:>12}")
                .expect("strings take all text");
        }
        let Self { dispatches, readbacks, bandwidth, floor_s, .. } = self;
        let moved = bytes(self.bytes_moved);
        text + &format!(
            "{dispatches} dispatches, {readbacks} readbacks; {moved} take {floor_s:.3} s at \
             {bandwidth} GB/s\n"
        )
    }
}
