//! What the stages of a build share: each in WGSL, with a twin on the CPU beside it.

pub mod arg_min;
pub mod compact;
pub mod radix;
pub mod scan;
pub mod segmented;

use crate::record::Kernel;

/// The kernels of all primitives.
pub(crate) fn kernels() -> Vec<&'static Kernel> {
    vec![
        &scan::REDUCE,
        &scan::APPLY,
        &compact::COMPACT,
        &segmented::BASES,
        &segmented::APPLY,
        &radix::COUNT,
        &radix::SCATTER,
        &arg_min::REDUCE,
        &arg_min::QUERY,
    ]
}
