//! Build the tree.
//!
//! What tree that is, is a definition and not an algorithm (see ARCHITECTURE.md, "The tree"): the
//! builders differ in how they find the cheapest plane of each node, and in nothing else. The
//! clipped bounds are those of `geometry::clip`, the prices those of `cost`, and
//! both are fixed to the last bit.

mod cost;
mod error;
mod exact;
mod grow;
mod meter;
mod naive;
mod options;
mod plane;
mod resort;

pub use cost::Cost;
pub use error::BuildError;
pub use options::{BuildOptions, BuildReport, Builder, MAX_DEPTH};

// What a builder on another device shares with these, to the last bit; not a stable interface.
#[doc(hidden)]
pub use {
    crate::geometry::ordered::{ordered, position_of},
    cost::NodeCost,
    exact::{Below, Crown},
    options::Limits,
};

use crate::geometry::Mesh;
use crate::tree::Tree;
use meter::Meter;

/// Nodes and references of a finished tree or subtree, as [`Tree`] stores them.
pub(crate) use grow::Growth;

/// Builds the tree of `mesh` and reports what the build took.
pub(crate) fn build(
    mesh: &Mesh,
    options: &BuildOptions,
) -> Result<(Tree, BuildReport), BuildError> {
    let limits = Limits::new(mesh, options)?;
    let meter = Meter::new(options);
    let growth = match options.builder {
        Builder::Naive => naive::build(mesh, &limits, &meter),
        Builder::Resort => resort::build(mesh, &limits, &meter),
        Builder::Exact => exact::build(mesh, &limits, &meter),
    }?;
    meter.finish();
    let report = BuildReport { peak_bytes: meter.peak_bytes() };
    Ok((Tree::from_growth(mesh, growth, options.cost), report))
}
