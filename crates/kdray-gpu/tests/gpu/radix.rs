//! Radix sort, against its twin and the standard library's stable sort.

use kdray_gpu::device::Device;
use kdray_gpu::primitives::radix::{Pairs, Sort, sort};
use kdray_gpu::record::{Count, Recording, TILE};
use kdray_test::random::Random;

use crate::support;

/// Sorts on the device.
fn sorted(device: &Device, keys: &[u32], values: &[u32], bits: u32) -> [Vec<u32>; 2] {
    let size = keys.len() as u32;
    let [keys, values] = [keys, values].map(|words| device.upload("pairs", words).unwrap());
    let room = [(); 2].map(|()| device.buffer("room", size.into()).unwrap());
    let mut recording = Recording::new(device);
    let pairs = Pairs { keys: &keys, values: &values };
    let room = Pairs { keys: &room[0], values: &room[1] };
    let sort = Sort::new(device, size).unwrap();
    sort.record(&mut recording, pairs, room, &Count::from(size), bits);
    recording.run().unwrap();
    [&keys, &values].map(|buffer| support::prefix(device, buffer, size as usize))
}

fn check(device: &Device, keys: &[u32], bits: u32) {
    let values: Vec<u32> = (0..keys.len() as u32).collect();
    let [mut twin_keys, mut twin_values] = [keys.to_vec(), values.clone()];
    sort(&mut twin_keys, &mut twin_values, bits);
    let [sorted_keys, sorted_values] = sorted(device, keys, &values, bits);
    assert!(sorted_keys == twin_keys && sorted_values == twin_values, "{} keys", keys.len());
}

#[test]
fn the_twin_is_a_stable_sort() {
    let mut random = Random::new(8);
    for size in support::sizes().into_iter().filter(|&size| size < 100_000) {
        let keys: Vec<u32> =
            random.words(size as usize).iter().map(|key| key & 0xf00f_00ff).collect();
        let mut pairs: Vec<(u32, u32)> = keys.iter().copied().zip(0..).collect();
        pairs.sort_by_key(|pair| pair.0);
        let (mut keys, mut values) = (keys, (0..size).collect());
        sort(&mut keys, &mut values, 32);
        assert!(keys.into_iter().zip(values).eq(pairs), "{size}");
    }
}

#[test]
fn sorts_are_those_of_the_twin() {
    let device = support::lavapipe();
    let mut random = Random::new(9);
    for size in support::sizes() {
        check(device, &random.words(size as usize), 32);
    }
}

#[test]
fn keys_may_be_equal_or_sorted_or_short() {
    let device = support::lavapipe();
    let size = 3 * TILE + 77;
    check(device, &vec![0xdead_beef; size as usize], 32);
    check(device, &(0..size).collect::<Vec<_>>(), 32);
    check(device, &(0..size).rev().collect::<Vec<_>>(), 14);
    let few: Vec<u32> = Random::new(10).words(size as usize).iter().map(|key| key % 3).collect();
    check(device, &few, 2);
    check(device, &few, 0);
}

/// By the second key, and then by the first.
#[test]
fn several_keys_are_sorted_from_the_last_one_on() {
    let device = support::lavapipe();
    let mut random = Random::new(11);
    let pairs: Vec<[u32; 2]> = (0..10_000).map(|_| [random.word() % 9, random.word()]).collect();
    let key = |place: usize, order: &[u32]| -> Vec<u32> {
        order.iter().map(|&i| pairs[i as usize][place]).collect()
    };
    let order: Vec<u32> = (0..10_000).collect();
    let [_, order] = sorted(device, &key(1, &order), &order, 32);
    let [_, order] = sorted(device, &key(0, &order), &order, 4);
    let mut expected: Vec<u32> = (0..10_000).collect();
    expected.sort_by_key(|&i| pairs[i as usize]);
    assert_eq!(order, expected);
}

#[test]
fn a_live_count_sorts_what_it_counts() {
    let device = support::lavapipe();
    let bound = 2 * TILE + 9;
    let keys = Random::new(12).words(bound as usize);
    let sort_room = Sort::new(device, bound).unwrap();
    for count in [0, 1, 100, TILE, TILE + 1, bound] {
        let counter = device.upload("counter", &[count]).unwrap();
        let live = Count::live(device, &counter, 0, bound).unwrap();
        let [pairs, values] = [(); 2].map(|()| device.upload("keys", &keys).unwrap());
        let room = [(); 2].map(|()| device.buffer("room", bound.into()).unwrap());
        let mut recording = Recording::new(device);
        recording.measure(&live);
        let room = Pairs { keys: &room[0], values: &room[1] };
        let both = Pairs { keys: &pairs, values: &values };
        sort_room.record(&mut recording, both, room, &live, 32);
        recording.run().unwrap();
        let mut expected = keys.clone();
        expected[..count as usize].sort_unstable();
        assert!(device.read::<u32>(&pairs).unwrap() == expected, "{count}");
        assert!(device.read::<u32>(&values).unwrap() == expected, "{count}");
    }
}

/// As many as a binding of every device holds. Takes a minute on two idle cores.
#[test]
#[ignore = "long"]
fn tens_of_millions_are_sorted() {
    check(support::lavapipe(), &Random::new(16).words(30_000_000), 32);
}
