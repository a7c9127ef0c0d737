//! The tree as traversal reads it: nodes of eight boxes.
//!
//! Eight boxes are tested together. The cells of a tree do not overlap, so neither do the boxes,
//! and a ray comes to them one after the other. In which order depends on the signs of its
//! direction only, so a node has the order for every octant.

use super::block::Block;
use super::collapse::collapse;
use crate::geometry::{Aabb, Mesh};
use crate::tree::Tree;

/// Eight boxes, and what is in them. Free places have empty boxes.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Wide {
    /// By end (lower, upper), axis and child.
    pub(super) bounds: [[[f32; 8]; 3]; 2],
    pub(super) children: [Child; 8],
    /// By octant of directions ([`Slabs::octant`](super::prepare::Slabs::octant)): the places of
    /// the children from the farthest to the nearest, four bits each, the lowest first.
    pub(super) order: [u32; 8],
}

/// What is in a box: another wide node, a block of a leaf, or all of them from the first.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Child(pub(super) u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const ONE: u32 = 1 << 30;

    /// Nothing: a leaf that no layout has.
    pub(super) const NONE: Self = Self(u32::MAX);

    /// The leaf whose blocks start there.
    pub(super) fn leaf(first: usize) -> Self {
        Self(first as u32 | Self::LEAF)
    }

    /// One block of a leaf.
    pub(super) fn one(block: usize) -> Self {
        Self(block as u32 | Self::LEAF | Self::ONE)
    }

    /// The first block of a leaf, or `None` for a wide node.
    #[inline(always)]
    pub(super) fn block(self) -> Option<usize> {
        (self.0 & Self::LEAF != 0).then_some(self.place())
    }

    /// The place of a wide node, or of the first block of a leaf.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        (self.0 & !(Self::LEAF | Self::ONE)) as usize
    }

    /// Whether it is one block, and not all of a leaf from there on.
    #[inline(always)]
    pub(super) fn is_one(self) -> bool {
        self.0 & Self::ONE != 0
    }
}

impl Wide {
    pub(super) const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; 8]; 3], [[f32::NEG_INFINITY; 8]; 3]],
        children: [Child(0); 8],
        order: [0x7654_3210; 8],
    };

    pub(super) fn set(&mut self, place: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[0][axis][place] = bounds.lower[axis];
            self.bounds[1][axis][place] = bounds.upper[axis];
        }
        self.children[place] = child;
    }

    /// Says in which order rays of every octant meet the first `count` children; free places come
    /// behind them.
    pub(super) fn set_order(&mut self, order: [u32; 8], count: usize) {
        let free = (count..8).fold(0, |free, place| free | (place as u32) << (4 * place));
        self.order = order.map(|order| order | free);
    }

    /// The places of the children as rays of the octant meet them, the last one first.
    #[inline(always)]
    pub(super) fn far_to_near(&self, octant: usize) -> impl Iterator<Item = usize> + use<> {
        let order = self.order[octant];
        (0..8).map(move |index| (order >> (4 * index)) as usize & 7)
    }
}

/// Wide nodes and the blocks of the leaves, each in depth-first order.
pub(super) struct Layout {
    pub(super) wides: Vec<Wide>,
    pub(super) blocks: Vec<Block>,
}

impl Layout {
    pub(super) fn new(mesh: &Mesh, tree: &Tree) -> Self {
        collapse(mesh, tree)
    }

    /// The blocks of a leaf.
    pub(super) fn blocks_of(&self, child: Child, first: usize) -> &[Block] {
        let is_last = |block: &Block| child.is_one() || block.is_last();
        let last = self.blocks[first..].iter().position(is_last).unwrap_or(0);
        &self.blocks[first..=first + last]
    }

    pub(super) fn size_bytes(&self) -> usize {
        size_of_val(&self.wides[..]) + size_of_val(&self.blocks[..])
    }

    /// Asks for the memory of a wide node, or of the first block of a leaf, without a jump.
    #[inline(always)]
    pub(super) fn prefetch(&self, child: Child) {
        let (wides, blocks) = (self.wides.as_ptr().cast::<u8>(), self.blocks.as_ptr().cast::<u8>());
        let is_leaf = child.block().is_some();
        let (start, size) =
            if is_leaf { (blocks, size_of::<Block>()) } else { (wides, size_of::<Wide>()) };
        // As many lines as the larger has.
        prefetch(start.wrapping_add(child.place() * size).cast::<Block>());
    }

    /// Asks for the memory of the first block of a leaf.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn prefetch_block(&self, leaf: Child) {
        prefetch(self.blocks.as_ptr().wrapping_add(leaf.place()));
    }

    /// Asks for the memory of a child that is a wide node.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn prefetch_wide(&self, child: Child) {
        prefetch(self.wides.as_ptr().wrapping_add(child.0 as usize));
    }
}

/// Asks for the memory of what may be there.
#[inline(always)]
fn prefetch<T>(it: *const T) {
    #[cfg(target_arch = "x86_64")]
    for line in (0..size_of::<T>()).step_by(64) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing, wherever it points.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(it.cast::<i8>().wrapping_add(line)) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = it;
}
