//! Queries on a device, with the answers of kdray's tracer on the CPU, bit for bit.
//!
//! `walk` takes a ray through the nodes, `sides` says whether it crosses a triangle and `times`
//! between which times, `point` works out where exactly. The kernels `closest`, `any`, `locate`,
//! `meet` and `locate_met` are made of these parts; `lists` says how the last two find all hits.

mod batch;
mod kernels;
mod lists;
pub(crate) mod recipe;
mod scene;
mod tracer;

pub use batch::{Batch, TraceOptions, TraceReport};
pub use kernels::Rays;
pub use lists::HitLists;
pub use tracer::Tracer;

use kernels::{ANY, LOCATE_MET, MEET, ORDER};
pub(crate) use kernels::{CLOSEST, LOCATE};
#[cfg(test)]
pub(crate) use kernels::{PRIVATE_BYTES, Params};
pub(crate) use scene::{Packed, Scene};

use crate::record::Kernel;

/// The parts that the kernels of queries share.
pub(crate) const PARTS: &[(&str, &str)] = &[
    ("ray", include_str!("ray.wgsl")),
    ("walk", include_str!("walk.wgsl")),
    ("cells", include_str!("cells.wgsl")),
    ("shear", include_str!("shear.wgsl")),
    ("sides", include_str!("sides.wgsl")),
    ("times", include_str!("times.wgsl")),
    ("point", include_str!("point.wgsl")),
];

/// The kernels of queries.
pub(crate) const KERNELS: &[&Kernel] = &[&CLOSEST, &LOCATE, &ANY, &MEET, &LOCATE_MET, &ORDER];
