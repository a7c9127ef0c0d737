//! The room of a subtree that a team finishes, and what it has of it so far.
//!
//! How much room there is depends on how many references the root has: [`PIECE`] words each, the
//! size of its events. A team that needs more gives up, and the root is an ordinary node.

use super::data::{LEAF, Record};

/// Words of room for each reference of the root.
pub(crate) const PIECE: u32 = 12;

/// Words before nodes and references: how many there are.
pub(crate) const PIECE_HEADER: u32 = 2;

/// Where the references are.
pub(crate) fn references_at(room: u32) -> u32 {
    8 * room
}

pub(crate) fn most_nodes(room: u32) -> u32 {
    4 * room - 1
}

pub(crate) fn most_references(room: u32) -> u32 {
    4 * room
}

/// A subtree in its room, as far as it is finished.
pub(crate) struct Piece<'a> {
    pub(crate) words: &'a mut [u32],
    /// References of the root.
    pub(crate) room: u32,
    pub(crate) nodes: u32,
    pub(crate) references: u32,
}

impl Piece<'_> {
    /// Adds a node, which is the right child of `parent`, and gives its place; if there is room.
    pub(crate) fn put_node(&mut self, parent: Option<u32>, node: Record) -> Option<u32> {
        let place = self.nodes;
        if place == most_nodes(self.room) {
            return None;
        }
        let word = |place: u32| (PIECE_HEADER + 2 * place) as usize;
        self.words[word(place)] = node.first;
        self.words[word(place) + 1] = node.second;
        if let Some(parent) = parent {
            self.words[word(parent) + 1] |= place << 2;
        }
        self.nodes += 1;
        Some(place)
    }

    /// Adds a leaf, if there is room.
    pub(crate) fn put_leaf(&mut self, parent: Option<u32>, references: &[u32]) -> Option<()> {
        let count = references.len() as u32;
        let has_room = self.references + count <= most_references(self.room);
        if has_room {
            let start = (references_at(self.room) + self.references) as usize;
            self.words[start..start + references.len()].copy_from_slice(references);
        }
        self.put_node(parent, Record { first: self.references, second: count << 2 | LEAF })?;
        if has_room {
            self.references += count;
        }
        has_room.then_some(())
    }
}
