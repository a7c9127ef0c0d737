//! What runs on a GPU: here on software drivers, which `.ci/vulkan` brings.

mod arg_min;
mod build;
mod compact;
mod device;
mod float;
mod radix;
mod rebuild;
mod scan;
mod segmented;
mod support;
mod trace;
