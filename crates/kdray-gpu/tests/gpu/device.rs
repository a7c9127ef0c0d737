//! Devices: what is listed, what is opened, and what fails how.

use kdray_gpu::record::{Count, Recording, TILE, WORKGROUP, grid};
use kdray_gpu::{Device, GpuError, Kind, Limits, Selection, devices};
use kdray_test::vulkan;

use crate::support;

#[test]
fn adapters_are_listed_with_their_drivers() {
    vulkan::set_up();
    let adapters = devices();
    for (index, adapter) in adapters.iter().enumerate() {
        assert_eq!(adapter.index, index);
        assert!(!adapter.driver.is_empty(), "{adapter:?}");
        assert!(adapter.limits.storage_buffers >= Limits::PORTABLE.storage_buffers, "{adapter:?}");
        println!("{adapter:?}");
    }
    if vulkan::override_name().is_none() {
        assert!(adapters.iter().all(|adapter| adapter.kind == Kind::Software), "{adapters:?}");
        assert_eq!(adapters.len(), 2, "{adapters:?}");
    }
}

#[test]
fn a_device_has_the_limits_that_were_asked_for() {
    let device = support::open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    assert_eq!(*device.limits(), Limits::PORTABLE);
    assert_eq!(device.check(), Ok(()));
}

#[test]
fn unknown_names_are_answered_with_the_known_ones() {
    vulkan::set_up();
    for selection in [Selection::Name("no such gpu".to_owned()), Selection::Index(99)] {
        let error = Device::open(&selection, &Limits::PORTABLE).unwrap_err();
        assert!(matches!(error, GpuError::UnknownAdapter { .. }), "{error}");
        assert!(error.to_string().contains("there are: 0 "), "{error}");
    }
    // Every name has an empty part, so it is nobody's.
    let error = Device::open(&Selection::Name(String::new()), &Limits::PORTABLE);
    assert!(devices().len() == 1 || error.is_err());
}

#[test]
fn limits_beyond_the_adapter_are_refused_by_name() {
    vulkan::set_up();
    let greedy = Limits { workgroup_bytes: u32::MAX, ..Limits::PORTABLE };
    let error = Device::open(&Selection::Best, &greedy).unwrap_err();
    assert!(matches!(error, GpuError::Limit { limit: "workgroup_bytes", .. }), "{error}");
}

#[test]
fn buffers_keep_what_they_are_given_and_are_counted() {
    let device = support::open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let before = device.memory().bytes();
    let data: Vec<u32> = (0..5_000_000).collect();
    let buffer = device.upload("numbers", &data).unwrap();
    assert_eq!(device.memory().bytes() - before, 20_000_000);
    assert_eq!(device.read::<u32>(&buffer).unwrap(), data);
    assert_eq!(device.read::<u32>(&buffer.words(64, 3)).unwrap(), [64, 65, 66]);
    drop(buffer);
    assert_eq!(device.memory().bytes(), before);
    assert_eq!(device.memory().peak_bytes() - before, 20_000_000);
    let odd = device.upload("bytes", &[1_u8, 2, 3, 4, 5]).unwrap();
    assert_eq!(device.read::<u8>(&odd).unwrap(), [1, 2, 3, 4, 5, 0, 0, 0]);
}

#[test]
fn buffers_that_are_too_large_are_errors() {
    let device = support::open(vulkan::LAVAPIPE, &Limits::PORTABLE);
    let error = device.buffer("huge", 1 << 40).unwrap_err();
    assert!(matches!(error, GpuError::Limit { limit: "buffer_bytes", .. }), "{error}");
    assert_eq!(device.check(), Ok(()));
    assert!(device.buffer("small", 1).is_ok());
}

#[test]
fn grids_made_on_the_device_are_those_of_the_host() {
    let device = support::lavapipe();
    for count in [0, 1, 256, 257, 4096, 4097, 65_535 * 256, 65_535 * 256 + 1, u32::MAX] {
        let counter = device.upload("counter", &[7, count]).unwrap();
        let live = Count::live(device, &counter, 1, u32::MAX).unwrap();
        let mut recording = Recording::new(device);
        recording.measure(&live);
        recording.run().unwrap();
        let words: Vec<u32> = device.read(live.grids().expect("it is live")).unwrap();
        assert_eq!(words[..3], grid(count.div_ceil(WORKGROUP)), "{count}");
        assert_eq!(words[4..7], grid(count.div_ceil(TILE)), "{count}");
    }
}
