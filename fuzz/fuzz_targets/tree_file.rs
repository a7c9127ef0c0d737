//! Any bytes, with the right sum and without: an error, or a tree that can be used.

#![no_main]

use kdray::Tree;
use libfuzzer_sys::fuzz_target;
use xxhash_rust::xxh3::Xxh3;

/// Where the sum of a tree file stands, and where it ends.
const SUM: std::ops::Range<usize> = 120..128;

fuzz_target!(|bytes: &[u8]| {
    open(bytes);
    let mut summed = [&b"kdray-kd\x01\0\0\0"[..], bytes].concat();
    if summed.len() >= SUM.end {
        let mut hash = Xxh3::new();
        hash.update(&summed[..SUM.start]);
        hash.update(&summed[SUM.end..]);
        summed[SUM].copy_from_slice(&hash.digest().to_le_bytes());
        open(&summed);
    }
});

fn open(bytes: &[u8]) {
    if let Ok(tree) = Tree::from_bytes(bytes) {
        assert_eq!(tree.stats().leaves, tree.nodes().len() / 2 + 1);
        assert_eq!(Tree::from_bytes(&tree.to_bytes()).as_ref(), Ok(&tree));
    }
}
