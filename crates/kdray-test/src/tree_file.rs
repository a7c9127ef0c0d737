//! Take a tree file apart, damage it, and sum it again.
//!
//! Written from the layout that the documentation of the file gives, and not with its code.

use kdray::Tree;
use xxhash_rust::xxh3::Xxh3;

/// Bytes before the nodes.
pub const HEADER: usize = 128;
/// Where the sum stands.
pub const CHECKSUM: usize = 120;
const NODES: usize = 16;
const REFERENCES: usize = 24;

/// A tree file with its words at hand.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeFile {
    /// The first [`HEADER`] bytes; counts and sum are renewed when the file is put together.
    pub header: Vec<u8>,
    /// Two words a node.
    pub nodes: Vec<[u32; 2]>,
    /// The references of the leaves.
    pub references: Vec<u32>,
}

impl TreeFile {
    /// The parts of a tree's file.
    #[must_use]
    pub fn of(tree: &Tree) -> Self {
        let bytes = tree.to_bytes();
        let body: Vec<u32> =
            bytes[HEADER..].as_chunks().0.iter().map(|w| u32::from_le_bytes(*w)).collect();
        let (nodes, references) = body.split_at(2 * tree.nodes().len());
        Self {
            header: bytes[..HEADER].to_vec(),
            nodes: nodes.as_chunks().0.to_vec(),
            references: references.to_vec(),
        }
    }

    /// The file, with the right counts and sum.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.header.clone();
        bytes[NODES..NODES + 8].copy_from_slice(&(self.nodes.len() as u64).to_le_bytes());
        bytes[REFERENCES..REFERENCES + 8]
            .copy_from_slice(&(self.references.len() as u64).to_le_bytes());
        let words = self.nodes.as_flattened().iter().chain(&self.references);
        bytes.extend(words.flat_map(|word| word.to_le_bytes()));
        sum_again(&mut bytes);
        bytes
    }

    /// The indices of the inner nodes.
    #[must_use]
    pub fn inner_nodes(&self) -> Vec<usize> {
        (0..self.nodes.len()).filter(|node| self.nodes[*node][1] & 3 != 3).collect()
    }

    /// The indices of the leaves with at least `count` references.
    #[must_use]
    pub fn leaves_of(&self, count: u32) -> Vec<usize> {
        let is_such =
            |node: &usize| self.nodes[*node][1] & 3 == 3 && self.nodes[*node][1] >> 2 >= count;
        (0..self.nodes.len()).filter(is_such).collect()
    }

    /// Takes `reference`, which belongs to `leaf`, out of the tree.
    pub fn drop_reference(&mut self, leaf: usize, reference: usize) {
        self.references.remove(reference);
        self.nodes[leaf][1] -= 1 << 2;
        for node in &mut self.nodes {
            if node[1] & 3 == 3 && node[0] as usize > reference {
                node[0] -= 1;
            }
        }
    }
}

/// Puts the right sum into the bytes of a file, whatever else they are.
///
/// # Panics
///
/// If there are fewer than [`HEADER`] bytes.
pub fn sum_again(bytes: &mut [u8]) {
    let mut hash = Xxh3::new();
    hash.update(&bytes[..CHECKSUM]);
    hash.update(&bytes[HEADER..]);
    bytes[CHECKSUM..HEADER].copy_from_slice(&hash.digest().to_le_bytes());
}
