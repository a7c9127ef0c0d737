//! What can end a build.

/// Why there is no tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The build would need more memory than it may take.
    #[error("the memory budget of {budget} bytes cannot hold the build: {stage} needs {needed}")]
    MemoryBudget {
        /// What was about to be allocated.
        stage: &'static str,
        /// Bytes in use with that allocation.
        needed: u64,
        /// Bytes allowed.
        budget: u64,
    },
    /// The caller asked the build to stop.
    #[error("the build was cancelled")]
    Cancelled,
    /// An option is out of its range.
    #[error("option {option} is {value}, which is not {expected}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// What it was.
        value: String,
        /// What it may be.
        expected: &'static str,
    },
    /// The threads could not be started.
    #[error("could not start {threads} threads: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
    /// The tree would need more nodes or references than its 30-bit indices can name.
    #[error("the tree has more than {limit} {what}")]
    TreeTooLarge {
        /// Nodes or references.
        what: &'static str,
        /// How many there may be.
        limit: usize,
    },
}
