//! Stable radix sort of 32-bit keys with 32-bit values.
//!
//! From the lowest digit to the highest, of 4 bits each: count the digits of every tile, scan the
//! counts, and move every key to its place. Three to five dispatches a digit.

use bytemuck::{Pod, Zeroable};

use super::scan::{self, Scan};
use crate::device::{Buffer, Device};
use crate::error::GpuError;
use crate::record::{Binding, Count, CountParams, Kernel, Moved, Recording, TILE, Work};

/// Bits of a digit. More would need more shared memory for the counts of every invocation.
const BITS: u32 = 4;
pub(crate) const DIGITS: usize = 1 << BITS;

pub(crate) static COUNT: Kernel = Kernel {
    name: "radix_count",
    source: include_str!("radix_count.wgsl"),
    bindings: &[Binding::Uniform, Binding::Read, Binding::Read, Binding::Write],
};

pub(crate) static SCATTER: Kernel = Kernel {
    name: "radix_scatter",
    source: include_str!("radix_scatter.wgsl"),
    bindings: &[
        Binding::Uniform,
        Binding::Read,
        Binding::Read,
        Binding::Read,
        Binding::Read,
        Binding::Write,
        Binding::Write,
    ],
};

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct Params {
    pub(crate) count: CountParams,
    pub(crate) tiles: u32,
    pub(crate) shift: u32,
    pub(crate) unused: [u32; 2],
}

/// Room for sorts of up to a number of keys: a 256th of theirs.
#[derive(Debug)]
pub struct Sort {
    /// Tiles of as many keys as there can be.
    tiles: u32,
    counts: Buffer,
    scan: Scan,
}

/// Keys, and a value of each.
#[derive(Clone, Copy, Debug)]
pub struct Pairs<'a> {
    /// What is sorted by.
    pub keys: &'a Buffer,
    /// What goes with it.
    pub values: &'a Buffer,
}

impl Sort {
    /// Makes room for sorts of up to `bound` keys.
    ///
    /// # Errors
    ///
    /// If the device has no memory for it.
    pub fn new(device: &Device, bound: u32) -> Result<Self, GpuError> {
        let tiles = bound.div_ceil(TILE);
        let counts = tiles * DIGITS as u32;
        let scan = Scan::new(device, counts)?;
        Ok(Self { tiles, counts: device.buffer("counts of digits", counts.into())?, scan })
    }

    /// The most keys that there is room for.
    #[must_use]
    pub fn bound(&self) -> u32 {
        self.tiles.saturating_mul(TILE)
    }

    /// Bytes of the device that it takes.
    #[must_use]
    pub fn size_bytes(&self) -> u64 {
        self.counts.size_bytes() + self.scan.size_bytes()
    }

    /// Sorts the first `count` of `pairs` by the lowest `bits` bits of their keys, equal keys in
    /// their order; the bits above do not matter, or are sorted by as well. `room` is for as many
    /// pairs, and holds rubbish afterwards.
    ///
    /// To sort by several keys, sort by the last one first: what follows keeps the order of equals.
    ///
    /// # Panics
    ///
    /// If there may be more keys than room was made for, or keys of more than 32 bits.
    pub fn record(
        &self,
        recording: &mut Recording,
        pairs: Pairs,
        room: Pairs,
        count: &Count,
        bits: u32,
    ) {
        assert!(count.bound().div_ceil(TILE) <= self.tiles, "{} keys", count.bound());
        assert!(bits <= u32::BITS, "{bits} bits");
        // There and back: after an even number of digits the pairs are where they were.
        for shift in (0..bits).step_by(2 * BITS as usize) {
            self.digit(recording, pairs, room, count, shift);
            self.digit(recording, room, pairs, count, shift + BITS);
        }
    }

    fn digit(&self, recording: &mut Recording, from: Pairs, to: Pairs, count: &Count, shift: u32) {
        let tiles = self.tiles;
        let params = Params { count: count.params(), tiles, shift, unused: [0; 2] };
        let counter = count.counter(recording.device());
        // Tiles without keys have counts too: zeros.
        let all_tiles = Work::tiles(&Count::from(tiles.saturating_mul(TILE)));
        let written = 4 * DIGITS as u64 * u64::from(tiles);
        let counted = move |n| Moved { read: 4 * n, written };
        let buffers = [counter, from.keys, &self.counts];
        recording.dispatch(&COUNT, &params, &buffers, &all_tiles, counted);
        let counts = Count::from(tiles * DIGITS as u32);
        self.scan.record(recording, &self.counts, &counts, None);
        let buffers = [counter, from.keys, &self.counts, from.values, to.keys, to.values];
        let moved = move |n| Moved { read: 8 * n + written, written: 8 * n };
        recording.dispatch(&SCATTER, &params, &buffers, &Work::tiles(count), moved);
    }
}

/// Twin: sorts pairs of keys and values by the lowest `bits` bits of the keys, up to a whole number
/// of pairs of digits.
pub fn sort(keys: &mut Vec<u32>, values: &mut Vec<u32>, bits: u32) {
    for shift in (0..bits.next_multiple_of(2 * BITS)).step_by(BITS as usize) {
        let tiles = || keys.chunks(TILE as usize).zip(values.chunks(TILE as usize));
        let counted: Vec<_> = tiles().map(|(keys, _)| count(keys, shift)).collect();
        let by_digit = (0..DIGITS).flat_map(|digit| counted.iter().map(move |tile| tile[digit]));
        let mut places: Vec<u32> = by_digit.collect();
        scan::exclusive(&mut places);
        let mut sorted = [vec![0; keys.len()], vec![0; keys.len()]];
        for (tile, pairs) in tiles().enumerate() {
            let places = (0..DIGITS).map(|digit| places[digit * counted.len() + tile]);
            scatter(pairs, shift, places.collect(), &mut sorted);
        }
        [*keys, *values] = sorted;
    }
}

fn digit_of(key: u32, shift: u32) -> usize {
    (key >> shift) as usize % DIGITS
}

/// Twin of `radix_count.wgsl`: how many keys of a tile have each digit.
fn count(keys: &[u32], shift: u32) -> [u32; DIGITS] {
    let mut counts = [0; DIGITS];
    for &key in keys {
        counts[digit_of(key, shift)] += 1;
    }
    counts
}

/// Twin of `radix_scatter.wgsl`: moves the pairs of a tile to where its digits start.
fn scatter(
    (keys, values): (&[u32], &[u32]),
    shift: u32,
    mut places: Vec<u32>,
    [sorted_keys, sorted_values]: &mut [Vec<u32>; 2],
) {
    for (&key, &value) in keys.iter().zip(values) {
        let place = &mut places[digit_of(key, shift)];
        sorted_keys[*place as usize] = key;
        sorted_values[*place as usize] = value;
        *place += 1;
    }
}
