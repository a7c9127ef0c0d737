//! Segmented arg-min, against its twin.

use kdray_gpu::device::Device;
use kdray_gpu::primitives::arg_min::{ArgMin, NONE, Segments, arg_min};
use kdray_gpu::record::{Count, Recording, TILE};
use kdray_test::random::Random;

use crate::support;

fn check(device: &Device, values: &[u32], width: u32, offsets: &[u32]) {
    let expected = arg_min(values, width as usize, offsets);
    let (size, segments) = (values.len() as u32 / width, expected.len() as u32);
    let values = device.upload("values", values).unwrap();
    let offsets = device.upload("offsets", offsets).unwrap();
    let minima = device.buffer("minima", segments.into()).unwrap();
    let search = ArgMin::new(device, size).unwrap();
    let what = Segments { values: &values, width, offsets: &offsets, minima: &minima };
    let mut recording = Recording::new(device);
    search.record(&mut recording, what, &Count::from(size), &Count::from(segments));
    recording.run().unwrap();
    let found = support::prefix(device, &minima, segments as usize);
    assert!(found == expected, "{size} values of {width} words in {segments} segments");
}

/// Values with many equal first words, so that the others decide, and some equal ones.
fn values(random: &mut Random, size: u32, width: u32) -> Vec<u32> {
    let most = [u32::MAX, 100, 2];
    let word = |i: u32| most[random.below(3)].min(if i.is_multiple_of(width) { 5 } else { 9 });
    let limits: Vec<u32> = (0..size * width).map(word).collect();
    limits.into_iter().map(|limit| random.word() % (limit + 1)).collect()
}

#[test]
fn the_least_of_every_segment_is_found() {
    let device = support::lavapipe();
    let mut random = Random::new(13);
    for size in support::sizes() {
        for width in [1, 2, 3] {
            let values = values(&mut random, size, width);
            check(device, &values, width, &support::segments(&mut random, size));
        }
    }
}

#[test]
fn segments_may_be_all_one_or_all_alone_or_empty() {
    let device = support::lavapipe();
    for size in [1, 31, 32, 33, 64, 65, 66, 1024, 1025, 32 * 1024 + 1, 9 * TILE + 5] {
        let values = Random::new(14).words(3 * size as usize);
        check(device, &values, 3, &[0, size]);
        check(device, &values, 3, &(0..=size).collect::<Vec<_>>());
        check(device, &values, 3, &[0, 0, 0, 1, 1, size, size, size]);
        check(device, &values, 3, &[size / 3, size / 2]);
    }
    check(device, &[], 1, &[0, 0, 0]);
    assert_eq!(arg_min(&[], 1, &[0, 0]), [NONE]);
}

/// Of equal values the first one is found, also from blocks that are looked at later.
#[test]
fn of_equal_values_the_first_is_the_least() {
    let device = support::lavapipe();
    let size = 3 * TILE;
    check(device, &vec![7; size as usize], 1, &[0, 5, 5, 2000, size]);
    check(device, &vec![u32::MAX; 3 * size as usize], 3, &[0, 5, 5, 2000, size]);
}

#[test]
fn live_counts_of_values_and_segments_are_kept_to() {
    let device = support::lavapipe();
    let bound = 2 * TILE;
    let words = Random::new(15).words(bound as usize);
    let values = device.upload("values", &words).unwrap();
    let search = ArgMin::new(device, bound).unwrap();
    for count in [1, 65, 70, TILE + 1, bound] {
        let ends = [0, count / 2, count, 0];
        let offsets = device.upload("offsets", &ends).unwrap();
        let minima = device.upload("minima", &[9, 9, 9]).unwrap();
        let counter = device.upload("counter", &[count, 2]).unwrap();
        let live = Count::live(device, &counter, 0, bound).unwrap();
        let segments = Count::live(device, &counter, 1, 3).unwrap();
        let mut recording = Recording::new(device);
        recording.measure(&live);
        recording.measure(&segments);
        let what = Segments { values: &values, width: 1, offsets: &offsets, minima: &minima };
        search.record(&mut recording, what, &live, &segments);
        recording.run().unwrap();
        let mut expected = arg_min(&words, 1, &ends[..3]);
        expected.push(9);
        assert_eq!(device.read::<u32>(&minima).unwrap(), expected, "{count}");
    }
}

/// As many as a binding of every device holds. Takes a minute on two idle cores.
#[test]
#[ignore = "long"]
fn tens_of_millions_have_a_least() {
    let mut random = Random::new(18);
    let size = 30_000_000;
    let values = values(&mut random, size, 1);
    check(support::lavapipe(), &values, 1, &support::segments(&mut random, size));
}
