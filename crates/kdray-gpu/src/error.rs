//! What can go wrong on a device.

/// Why the GPU could not do what was asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// The machine has no adapter.
    #[error("there is no GPU that {backends} can use")]
    NoAdapter {
        /// The interfaces that were asked for adapters.
        backends: String,
    },
    /// No adapter, or more than one, has the name or index.
    #[error("no single GPU is called {name:?}; there are: {known}")]
    UnknownAdapter {
        /// What was asked for.
        name: String,
        /// Index and name of every adapter.
        known: String,
    },
    /// The adapter offers less than was asked for.
    #[error("{adapter} offers {limit} of {offered}, and {asked} are needed")]
    Limit {
        /// Name of the adapter.
        adapter: String,
        /// Name of the limit.
        limit: &'static str,
        /// What it would have to be.
        asked: u64,
        /// What it is.
        offered: u64,
    },
    /// The driver did not open the adapter.
    #[error("{adapter} cannot be opened: {reason}")]
    Refused {
        /// Name of the adapter.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The options have no meaning, or the build was ended.
    #[error(transparent)]
    Build(#[from] kdray::BuildError),
    /// The batch of queries was ended.
    #[error(transparent)]
    Batch(#[from] kdray::BatchError),
    /// The device has no room for a buffer.
    #[error("the device has no memory for {buffer}, {bytes} bytes")]
    OutOfMemory {
        /// Label of the buffer.
        buffer: &'static str,
        /// How large it would have been.
        bytes: u64,
    },
    /// The device is gone: pulled out, reset, or hung.
    #[error("the device was lost: {reason}")]
    Lost {
        /// What the driver said.
        reason: String,
    },
    /// The driver refused a command. Either it or kdray is at fault.
    #[error("the driver refused {what}: {reason}")]
    Driver {
        /// What was being done.
        what: String,
        /// What the driver said.
        reason: String,
    },
}

impl GpuError {
    /// Whether less memory at a time may help.
    pub(crate) fn is_memory(&self) -> bool {
        let is_budget = matches!(self, Self::Build(kdray::BuildError::MemoryBudget { .. }));
        is_budget || matches!(self, Self::OutOfMemory { .. })
    }
}
