//! Pairs of a ray and what it meets.

use std::arch::x86_64::*;

use crate::trace::step::places;
use crate::trace::wide::Child;

/// A ray, by its place, and a node or a block that it meets.
#[derive(Clone, Copy)]
pub(super) struct Pair {
    pub(super) ray: u32,
    pub(super) child: Child,
}

/// Pairs in two columns. Eight are written at a time, however many of them count.
pub(super) struct Pairs {
    rays: Vec<u32>,
    children: Vec<Child>,
    pub(super) len: usize,
}

impl Pairs {
    pub(super) fn new() -> Self {
        Self { rays: Vec::new(), children: Vec::new(), len: 0 }
    }

    /// Makes room for so many pairs more, and for eight.
    pub(super) fn reserve(&mut self, more: usize) {
        let len = self.len + more + 8;
        if self.rays.len() < len {
            self.rays.resize(2 * len, 0);
            self.children.resize(2 * len, Child::NONE);
        }
    }

    /// Adds those of eight children whose bit is set.
    #[inline]
    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn push(&mut self, ray: u32, children: __m256i, mask: u32) {
        debug_assert!(self.len + 8 <= self.rays.len(), "there is room");
        let children = _mm256_permutevar8x32_epi32(children, places(mask));
        // SAFETY: there is room for eight.
        unsafe {
            let rays = self.rays.as_mut_ptr().add(self.len);
            _mm256_storeu_si256(rays.cast(), _mm256_set1_epi32(ray as i32));
            _mm256_storeu_si256(self.children.as_mut_ptr().add(self.len).cast(), children);
        }
        self.len += mask.count_ones() as usize;
    }

    /// Adds one. There is room.
    pub(super) fn add(&mut self, pair: Pair) {
        (self.rays[self.len], self.children[self.len]) = (pair.ray, pair.child);
        self.len += 1;
    }

    pub(super) fn get(&self, index: usize) -> Pair {
        Pair { ray: self.rays[index], child: self.children[index] }
    }

    /// Takes the last pairs, at most so many.
    pub(super) fn take(&mut self, into: &mut [Pair]) -> usize {
        let count = self.len.min(into.len());
        self.len -= count;
        for (index, pair) in into[..count].iter_mut().enumerate() {
            *pair = self.get(self.len + index);
        }
        count
    }
}
