//! What a build on a device took.

use crate::record::Profile;

/// What a build on a device took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// The most bytes of the device that the build had at one time, mesh and tree included.
    pub peak_bytes: u64,
    /// Bytes of the finished tree.
    pub tree_bytes: u64,
    /// How often the host waited for words of the device, the tree itself apart.
    pub readbacks: u64,
    /// Nodes near the root that the CPU made, because the device cannot bind what they take.
    pub crown: usize,
    /// The levels, in the order in which they were built.
    pub levels: Vec<LevelReport>,
    /// What the kernels took, if that was asked for.
    pub profile: Option<Profile>,
}

/// Nodes of one depth that were built together: all of them, or a batch that memory had room for.
/// Those below small nodes, which are finished at once, are on no level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelReport {
    /// Their depth.
    pub depth: u32,
    /// How many there are.
    pub nodes: u32,
    /// How many references they have.
    pub references: u32,
    /// How many of these are in nodes that were finished with all that is below them.
    pub finished: u32,
    /// How many of these were clipped.
    pub clipped: u32,
    /// The most new events along an axis that one of the nodes had to sort.
    pub largest_bucket: u32,
}
