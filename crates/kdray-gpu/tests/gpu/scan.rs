//! Scans, against their twin and a plain sum.

use kdray_gpu::Device;
use kdray_gpu::primitives::scan::{Scan, exclusive};
use kdray_gpu::record::{Count, Recording, TILE};
use kdray_test::random::Random;
use kdray_test::vulkan;

use crate::support;

#[test]
fn scans_are_those_of_the_twin() {
    let device = support::lavapipe();
    let mut random = Random::new(1);
    for size in support::sizes() {
        // Sums wrap.
        let values = random.words(size as usize);
        let mut expected = values.clone();
        let sum = exclusive(&mut expected);
        let (buffer, total) =
            (device.upload("values", &values).unwrap(), device.buffer("total", 3).unwrap());
        let mut recording = Recording::new(device);
        let scan = Scan::new(device, size).unwrap();
        scan.record(&mut recording, &buffer, &Count::from(size), Some((&total, 1)));
        recording.run().unwrap();
        assert!(support::prefix(device, &buffer, size as usize) == expected, "{size}");
        assert_eq!(device.read::<u32>(&total).unwrap(), [0, sum, 0], "{size}");
    }
}

#[test]
fn the_twin_is_a_running_sum() {
    let mut random = Random::new(2);
    for size in support::sizes() {
        let values = random.words(size as usize);
        let mut scanned = values.clone();
        let total = exclusive(&mut scanned);
        let mut sum = 0_u32;
        for (value, before) in values.iter().zip(scanned) {
            assert_eq!(before, sum);
            sum = sum.wrapping_add(*value);
        }
        assert_eq!(total, sum);
    }
}

#[test]
fn scans_of_live_counts_touch_only_what_is_counted() {
    let device = support::lavapipe();
    let bound = 3 * TILE + 5;
    let values: Vec<u32> = (0..bound).map(|i| i % 7).collect();
    let scan = Scan::new(device, bound).unwrap();
    for count in [0, 1, 17, TILE - 1, TILE, TILE + 1, bound, bound + 1, u32::MAX] {
        let buffer = device.upload("values", &values).unwrap();
        let total = device.buffer("total", 1).unwrap();
        let counter = device.upload("counter", &[0, 0, count]).unwrap();
        let live = Count::live(device, &counter, 2, bound).unwrap();
        let mut recording = Recording::new(device);
        recording.measure(&live);
        scan.record(&mut recording, &buffer, &live, Some((&total, 0)));
        let profile = recording.profile().unwrap();
        let mut expected = values.clone();
        let counted = count.min(bound) as usize;
        let sum = exclusive(&mut expected[..counted]);
        assert!(device.read::<u32>(&buffer).unwrap() == expected, "{count}");
        assert_eq!(device.read::<u32>(&total).unwrap(), [sum], "{count}");
        let n = counted as u64;
        let tiles = n.div_ceil(TILE.into());
        let total = profile.total();
        assert_eq!(total.dispatches, 4, "{count}");
        assert_eq!(total.moved.read, 4 + 8 * n + 4 * tiles, "{count}");
        assert_eq!(total.moved.written, 32 + 4 * n + 8 * tiles, "{count}");
    }
}

/// 17 million values are three levels of sums.
#[test]
fn scans_of_many_values_have_more_levels() {
    check_many(support::lavapipe(), TILE * TILE + 2 * TILE + 1);
}

/// More than the 128 MiB that every device can bind, on one that binds as much. Takes a minute.
#[test]
#[ignore = "long"]
fn values_may_be_as_large_as_a_device_binds() {
    let name = vulkan::SWIFTSHADER.parse().expect("every word is a selection");
    vulkan::set_up();
    let device = Device::open_with_large_buffers(&name).expect("`.ci/vulkan` brings the device");
    check_many(&device, 40_000_000);
}

fn check_many(device: &Device, size: u32) {
    let values: Vec<u32> = (0..size).map(|i| i & 3).collect();
    let buffer = device.upload("values", &values).unwrap();
    let mut recording = Recording::new(device);
    let scan = Scan::new(device, size).unwrap();
    scan.record(&mut recording, &buffer, &Count::from(size), None);
    recording.run().unwrap();
    let mut expected = values;
    exclusive(&mut expected);
    assert!(device.read::<u32>(&buffer).unwrap() == expected);
}
