//! What becomes of errors.

use kdray_test::vulkan;

use super::*;
use crate::primitives::scan::Scan;
use crate::record::{Count, Kernel, Recording};

fn open() -> Device {
    vulkan::set_up();
    let name = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    let selection: Selection = name.parse().expect("every word is a selection");
    Device::open(&selection, &Limits::PORTABLE).expect("the tests have a device")
}

#[test]
fn what_a_driver_complains_of_is_an_error_that_stays() {
    let device = open();
    let buffer = device.buffer("words", 4).unwrap();
    let mut encoder = device.raw.create_command_encoder(&Default::default());
    // Beyond the end of the buffer.
    encoder.copy_buffer_to_buffer(buffer.raw(), 0, buffer.raw(), 1 << 20, 16);
    device.queue.submit([encoder.finish()]);
    for _ in 0..2 {
        assert!(matches!(device.check(), Err(GpuError::Driver { .. })), "{:?}", device.check());
        assert!(device.read::<u32>(&buffer).is_err());
        assert!(device.buffer("more", 4).is_err());
    }
}

#[test]
fn a_kernel_that_is_no_wgsl_is_an_error_with_its_name() {
    const BROKEN: Kernel = Kernel { name: "broken", source: "fn broken( {", bindings: &[] };
    let device = open();
    let error = device.pipeline(&BROKEN).unwrap_err().to_string();
    assert!(error.contains("the kernel broken"), "{error}");
    assert_eq!(device.check(), Ok(()));
}

#[test]
fn a_device_that_is_gone_gives_errors_and_no_panic() {
    let device = open();
    let buffer = device.upload("words", &[1_u32; 10_000]).unwrap();
    let scan = Scan::new(&device, 10_000).unwrap();
    let mut recording = Recording::new(&device);
    scan.record(&mut recording, &buffer, &Count::from(10_000), None);
    device.raw.destroy();
    let ran = recording.run().and_then(|()| device.wait());
    assert!(ran.is_err(), "{ran:?}");
    assert!(recording.profile().is_err());
    assert!(device.read::<u32>(&buffer).is_err());
    assert!(device.upload("more", &[1_u32]).is_err());
    assert!(Scan::new(&device, 1 << 20).is_err());
    assert!(open().check().is_ok(), "another device of the same adapter is not affected");
}
