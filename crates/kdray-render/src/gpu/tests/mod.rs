//! Kernels are valid, and do what their twins do.

mod twins;
mod wgsl;

use std::sync::OnceLock;

use kdray_gpu::{Device, Limits, Selection};
use kdray_test::vulkan;

/// The device that pictures are tested on, within the portable limits.
fn lavapipe() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| {
        vulkan::set_up();
        let name = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
        let selection: Selection = name.parse().expect("every word is a selection");
        Device::open(&selection, &Limits::PORTABLE).unwrap_or_else(|error| panic!("{error}"))
    })
}
