//! Work for the device: kernels, what they are run on, and what that cost.

mod clock;
mod count;
mod kernel;
mod profile;
mod recording;
mod run;

pub(crate) use count::MEASURE;
#[cfg(test)]
pub(crate) use count::ROW;
pub use count::{Count, CountParams, TILE, Work, grid};
pub use kernel::{Binding, Kernel, TEAM, WORKGROUP};
pub use profile::{Profile, StageProfile};
pub use recording::{Moved, Recording};
