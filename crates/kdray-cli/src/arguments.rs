//! Options that several commands share.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// How the output is written.
#[derive(Args)]
pub(crate) struct Json {
    /// Print one JSON object on standard output, and nothing else
    #[arg(long)]
    pub(crate) json: bool,
}

/// How a mesh is read.
#[derive(Args)]
pub(crate) struct Repair {
    /// Leave out triangles that have a corner which is NaN or infinite, instead of refusing the mesh
    #[arg(long)]
    pub(crate) drop_non_finite: bool,
}

/// How a tree is built.
#[derive(Args)]
pub(crate) struct Build {
    /// How the cheapest planes are found; the tree is the same
    #[arg(long, value_enum, default_value_t)]
    pub(crate) builder: Builder,
    /// Threads to use; 0 for one a core
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) threads: usize,
}

/// The builders by name.
#[derive(Clone, Copy, Default, ValueEnum)]
pub(crate) enum Builder {
    /// Sort once, keep the order while splitting: O(N log N)
    #[default]
    Exact,
    /// Sort the events of every node anew: O(N log² N)
    Resort,
    /// Count every plane against every triangle: O(N²), for small meshes
    Naive,
}

impl Builder {
    /// The name on the command line and in JSON.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Resort => "resort",
            Self::Naive => "naive",
        }
    }

    pub(crate) fn builder(self) -> kdray::Builder {
        match self {
            Self::Exact => kdray::Builder::Exact,
            Self::Resort => kdray::Builder::Resort,
            Self::Naive => kdray::Builder::Naive,
        }
    }
}

/// A mesh that must be named.
#[derive(Args)]
pub(crate) struct Mesh {
    /// The mesh: a PLY, OBJ, STL, OFF, glTF or GLB file
    #[arg(value_name = "MESH")]
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) repair: Repair,
}

/// How many threads `threads` means.
pub(crate) fn resolved_threads(threads: usize) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    if threads == 0 { cores() } else { threads }
}

/// Parses a number of times.
pub(crate) fn at_least_one(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|passes| *passes > 0).ok_or_else(|| "not a number above 0".into())
}
