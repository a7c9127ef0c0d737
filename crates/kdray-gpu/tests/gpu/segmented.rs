//! Segmented scans, against their twin.

use kdray_gpu::device::Device;
use kdray_gpu::primitives::segmented::{SegmentedScan, exclusive};
use kdray_gpu::record::{Count, Recording, TILE};
use kdray_test::random::Random;

use crate::support;

fn check(device: &Device, values: &[u32], offsets: &[u32]) {
    let mut expected = values.to_vec();
    exclusive(&mut expected, offsets);
    let (size, segments) = (values.len() as u32, offsets.len() as u32 - 1);
    let buffer = device.upload("values", values).unwrap();
    let starts = device.upload("offsets", offsets).unwrap();
    let scan = SegmentedScan::new(device, size, segments).unwrap();
    let mut recording = Recording::new(device);
    scan.record(&mut recording, &buffer, &Count::from(size), &starts, segments);
    recording.run().unwrap();
    let scanned = support::prefix(device, &buffer, values.len());
    assert!(scanned == expected, "{size} values in {segments} segments");
}

#[test]
fn sums_start_anew_with_every_segment() {
    let device = support::lavapipe();
    let mut random = Random::new(5);
    for size in support::sizes() {
        let values = random.words(size as usize);
        check(device, &values, &support::segments(&mut random, size));
    }
}

#[test]
fn segments_may_be_all_one_or_all_alone_or_empty() {
    let device = support::lavapipe();
    let size = 2 * TILE + 9;
    let values = Random::new(6).words(size as usize);
    check(device, &values, &[0, size]);
    check(device, &values, &(0..=size).collect::<Vec<_>>());
    check(device, &values, &[0, 0, 0, 7, 7, size, size, size, size]);
    check(device, &[], &[0, 0, 0]);
}

/// As many as a binding of every device holds. Takes a minute on two idle cores.
#[test]
#[ignore = "long"]
fn tens_of_millions_are_summed() {
    let mut random = Random::new(17);
    let values = random.words(30_000_000);
    check(support::lavapipe(), &values, &support::segments(&mut random, 30_000_000));
}
