//! kdray on the GPU: any adapter that Vulkan, Metal or Direct3D 12 can use.

mod build;
pub mod device;
mod error;
pub mod float;
pub mod primitives;
pub mod record;
mod trace;
pub mod wgsl;

pub use build::{
    BuildReport, LevelReport, Rebuilder, build, build_reported, build_with_twins, prepare,
};
pub use device::{Adapter, Device, Kind, Limits, Selection, devices};
pub use error::GpuError;
pub use trace::{Batch, HitLists, Rays, TraceOptions, TraceReport, Tracer};
