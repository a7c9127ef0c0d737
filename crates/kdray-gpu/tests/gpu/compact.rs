//! Compaction, against its twin.

use kdray_gpu::Device;
use kdray_gpu::primitives::compact::{Compaction, kept};
use kdray_gpu::primitives::scan::Scan;
use kdray_gpu::record::{Count, Recording, TILE, WORKGROUP};
use kdray_test::random::Random;

use crate::support;

/// Flags of which about `share` of 8 are set.
fn flags(random: &mut Random, count: u32, share: usize) -> Vec<u32> {
    (0..count).map(|_| u32::from(random.below(8) < share)).collect()
}

#[test]
fn what_is_kept_is_kept_in_order() {
    let device = support::lavapipe();
    let mut random = Random::new(3);
    for size in support::sizes() {
        for share in [0, 1, 4, 8] {
            let (flags, values) = (flags(&mut random, size, share), random.words(size as usize));
            let expected = kept(&flags, &values);
            let flags = device.upload("flags", &flags).unwrap();
            let values = device.upload("values", &values).unwrap();
            let room = device.buffer("kept", size.into()).unwrap();
            let total = device.buffer("total", 1).unwrap();
            let compaction =
                Compaction { flags: &flags, values: &values, kept: &room, total: (&total, 0) };
            let mut recording = Recording::new(device);
            let scan = Scan::new(device, size).unwrap();
            compaction.record(&mut recording, &scan, &Count::from(size));
            recording.run().unwrap();
            assert_eq!(device.read::<u32>(&total).unwrap(), [expected.len() as u32], "{size}");
            assert!(support::prefix(device, &room, expected.len()) == expected, "{size}");
        }
    }
}

/// What one compaction leaves is the live count of the next.
#[test]
fn compactions_follow_each_other_without_the_host() {
    let device = support::lavapipe();
    let mut random = Random::new(4);
    let size = 5 * TILE + 3;
    let scan = Scan::new(device, size).unwrap();
    let (first, second) = (flags(&mut random, size, 4), flags(&mut random, size, 4));
    let values = random.words(size as usize);
    let expected = kept(&second, &kept(&first, &values));
    let [first, second, values] =
        [first, second, values].map(|words| device.upload("words", &words).unwrap());
    let [once, twice] = [(); 2].map(|()| device.buffer("kept", size.into()).unwrap());
    let [total, last] = [(); 2].map(|()| device.buffer("total", 1).unwrap());
    let mut recording = Recording::new(device);
    let all = Count::from(size);
    Compaction { flags: &first, values: &values, kept: &once, total: (&total, 0) }.record(
        &mut recording,
        &scan,
        &all,
    );
    let live = Count::live(device, &total, 0, size).unwrap();
    recording.measure(&live);
    Compaction { flags: &second, values: &once, kept: &twice, total: (&last, 0) }.record(
        &mut recording,
        &scan,
        &live,
    );
    recording.run().unwrap();
    assert_eq!(device.read::<u32>(&last).unwrap(), [expected.len() as u32]);
    assert!(support::prefix(device, &twice, expected.len()) == expected);
}

/// A value an invocation, and more workgroups than a row of the grid has.
#[test]
fn more_workgroups_than_a_row_has_are_rows() {
    check_many(support::lavapipe(), 65_535 * WORKGROUP + 300);
}

fn check_many(device: &Device, size: u32) {
    let flags: Vec<u32> = (0..size).map(|i| u32::from(i % 5 == 0)).collect();
    let values: Vec<u32> = (0..size).collect();
    let expected = kept(&flags, &values);
    let [flags, values] = [flags, values].map(|words| device.upload("words", &words).unwrap());
    let room = device.buffer("kept", expected.len() as u64).unwrap();
    let total = device.buffer("total", 1).unwrap();
    let mut recording = Recording::new(device);
    let scan = Scan::new(device, size).unwrap();
    Compaction { flags: &flags, values: &values, kept: &room, total: (&total, 0) }.record(
        &mut recording,
        &scan,
        &Count::from(size),
    );
    recording.run().unwrap();
    assert_eq!(device.read::<u32>(&total).unwrap(), [expected.len() as u32]);
    assert!(device.read::<u32>(&room).unwrap() == expected);
}

/// As many as a binding of every device holds. Takes a minute on two idle cores.
#[test]
#[ignore = "long"]
fn tens_of_millions_are_compacted() {
    check_many(support::lavapipe(), 30_000_000);
}
