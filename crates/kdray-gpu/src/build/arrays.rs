//! The arrays of a build, by name.

use std::ops::{Index, IndexMut};

use super::data::{HEADER, Reference};

/// An array of words that kernels read and write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Array {
    /// Coordinates of the mesh's vertices.
    Positions,
    /// Vertices of its triangles.
    Triangles,
    /// `HEADER` words and the references of the level, by node and triangle.
    References,
    NextReferences,
    /// By axis: the events of the level, by node, position and kind.
    Events,
    /// Before that is made, room for the pieces of the level.
    NextEvents,
    /// The nodes of the level.
    Nodes,
    NextNodes,
    /// By reference of a narrow level that is not the root: its bounds.
    Bounds,
    NextBounds,
    /// By node: its cheapest plane.
    Best,
    /// By node: what becomes of it.
    Plans,
    /// By node: 1 if it is an inner node; then by node the words of the piece that a team made of it.
    /// After the scan, the sums before.
    Inner,
    /// Words that the teams of the level read, and that they wrote.
    Moved,
    /// By chunk: counts; after the scan, those of all chunks before.
    Sums,
    /// By chunk of events: the lowest price of its planes, inverted.
    Lows,
    /// By reference: the sides it reaches; then its name in the child.
    Marks,
    /// References on both sides of their node's plane.
    Straddlers,
    /// By straddler and side.
    Parts,
    /// By side and straddler: 1 if there is a part; after the scan, the parts before.
    Exists,
    /// By straddler and side: the place of the part among the references of the next level.
    Places,
    /// By inner node.
    Pairs,
    /// Positions of the events of an axis, what they stand for, and room to sort both.
    Keys,
    Values,
    NextKeys,
    NextValues,
    /// By axis: the events of new parts, by child.
    Fresh,
    NextFresh,
    /// All nodes so far.
    Records,
    /// What is finished so far: references of leaves, and pieces. A piece is how many nodes and
    /// references a subtree has, its nodes and its references, depth first, as if it were all.
    Finished,
    /// By record: the extent of its subtree, then of what comes before it.
    Extents,
    TreeNodes,
    TreeReferences,
}

impl Array {
    pub(crate) const COUNT: usize = Self::ALL.len();

    /// All of them, in order.
    pub(crate) const ALL: [Self; 33] = [
        Self::Positions,
        Self::Triangles,
        Self::References,
        Self::NextReferences,
        Self::Events,
        Self::NextEvents,
        Self::Nodes,
        Self::NextNodes,
        Self::Bounds,
        Self::NextBounds,
        Self::Best,
        Self::Plans,
        Self::Inner,
        Self::Moved,
        Self::Sums,
        Self::Lows,
        Self::Marks,
        Self::Straddlers,
        Self::Parts,
        Self::Exists,
        Self::Places,
        Self::Pairs,
        Self::Keys,
        Self::Values,
        Self::NextKeys,
        Self::NextValues,
        Self::Fresh,
        Self::NextFresh,
        Self::Records,
        Self::Finished,
        Self::Extents,
        Self::TreeNodes,
        Self::TreeReferences,
    ];
}

/// The arrays in the CPU's memory.
#[derive(Clone)]
pub(crate) struct Arrays {
    words: [Vec<u32>; Array::COUNT],
}

impl Default for Arrays {
    fn default() -> Self {
        Self { words: [const { Vec::new() }; Array::COUNT] }
    }
}

impl Arrays {
    /// The elements of an array.
    pub(crate) fn of<T: bytemuck::Pod>(&self, array: Array) -> &[T] {
        let words = &self[array];
        bytemuck::cast_slice(&words[..whole::<T>(words.len())])
    }

    /// The references of a level, behind their header.
    pub(crate) fn references(&self, array: Array) -> &[Reference] {
        bytemuck::cast_slice(&self[array][HEADER..])
    }

    /// Lets `work` write the elements of one array while it reads the others.
    pub(crate) fn write<T: bytemuck::Pod>(
        &mut self,
        array: Array,
        work: impl FnOnce(&mut Self, &mut [T]),
    ) {
        let mut words = std::mem::take(&mut self[array]);
        let len = whole::<T>(words.len());
        work(self, bytemuck::cast_slice_mut(&mut words[..len]));
        self[array] = words;
    }

    pub(crate) fn swap(&mut self, one: Array, other: Array) {
        self.words.swap(one as usize, other as usize);
    }
}

/// Words that are whole elements.
fn whole<T>(words: usize) -> usize {
    let size = size_of::<T>() / size_of::<u32>();
    words / size * size
}

impl Index<Array> for Arrays {
    type Output = Vec<u32>;

    fn index(&self, array: Array) -> &Vec<u32> {
        &self.words[array as usize]
    }
}

impl IndexMut<Array> for Arrays {
    fn index_mut(&mut self, array: Array) -> &mut Vec<u32> {
        &mut self.words[array as usize]
    }
}
