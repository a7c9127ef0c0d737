//! Pairs of a ray and what it meets.

use std::arch::x86_64::*;

use crate::trace::step::places;
use crate::trace::wide::Child;

/// How many pairs ahead memory is asked for.
const AHEAD: usize = 12;

/// Pairs of a ray, by its place, and a node or a leaf that it meets, in two columns.
#[derive(Default)]
pub(super) struct Pairs {
    rays: Vec<u32>,
    children: Vec<Child>,
    len: usize,
}

impl Pairs {
    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for so many pairs more; and for eight, as many as are read or written at a time.
    fn make_room(&mut self, more: usize) {
        let len = self.len + more + 8;
        if self.rays.len() < len {
            self.rays.resize(2 * len, 0);
            self.children.resize(2 * len, Child::NONE);
        }
    }

    /// Where up to so many pairs are added. They are there when that is dropped.
    pub(super) fn end(&mut self, room: usize) -> End<'_> {
        self.make_room(room);
        let (rays, children) = (self.rays.as_mut_ptr(), self.children.as_mut_ptr());
        End { rays, children, len: self.len, full: self.len + room, of: &mut self.len }
    }

    /// Takes the last pairs, at most so many, and adds them to those of their kind.
    #[inline]
    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn take(&mut self, most: usize, to_nodes: &mut Self, to_leaves: &mut Self) {
        self.make_room(0);
        let first = self.len - self.len.min(most);
        let (mut nodes, mut leaves) = (to_nodes.end(most), to_leaves.end(most));
        for at in (first..self.len).step_by(8) {
            // SAFETY: there is room for eight behind the last.
            let [rays, children] = unsafe {
                let children = self.children.as_ptr().add(at);
                [self.rays.as_ptr().add(at).cast(), children.cast()]
                    .map(|eight| _mm256_loadu_si256(eight))
            };
            let present = (1 << (self.len - at).min(8)) - 1;
            // They have the sign bit.
            let are_leaves = _mm256_movemask_ps(_mm256_castsi256_ps(children)) as u32;
            nodes.push(rays, children, present & !are_leaves);
            leaves.push(rays, children, present & are_leaves);
        }
        self.len = first;
    }

    /// The children for whose memory is to be asked before all, and rays and children with the child for
    /// whose memory is to be asked there: `behind` the last ones.
    #[inline(always)]
    pub(super) fn iter(
        &mut self,
        behind: Child,
    ) -> (&[Child], impl Iterator<Item = (u32, Child, Child)>) {
        self.make_room(AHEAD);
        self.children[self.len..][..AHEAD].fill(behind);
        let (first, ahead) = self.children.split_at(AHEAD);
        let children = self.children.iter().zip(ahead);
        let pairs = self.rays[..self.len].iter().zip(children);
        (first, pairs.map(|(ray, (child, ahead))| (*ray, *child, *ahead)))
    }
}

/// Where pairs are added to [`Pairs`]. There is always room for them. Their number is kept apart until
/// the end: a loop has it in a register.
pub(super) struct End<'a> {
    rays: *mut u32,
    children: *mut Child,
    len: usize,
    full: usize,
    of: &'a mut usize,
}

impl Drop for End<'_> {
    #[inline(always)]
    fn drop(&mut self) {
        *self.of = self.len;
    }
}

impl End<'_> {
    /// Adds one.
    #[inline(always)]
    pub(super) fn add(&mut self, ray: u32, child: Child) {
        debug_assert!(self.len < self.full, "there is room");
        // SAFETY: there is room for eight.
        unsafe { (*self.rays.add(self.len), *self.children.add(self.len)) = (ray, child) };
        self.len += 1;
    }

    /// Adds those of eight whose bit is set.
    #[inline]
    #[target_feature(enable = "avx2,popcnt")]
    fn push(&mut self, rays: __m256i, children: __m256i, mask: u32) {
        self.push_for(_mm256_permutevar8x32_epi32(rays, places(mask)), children, mask);
    }

    /// The same for a ray that is in every lane.
    #[inline]
    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn push_for(&mut self, ray: __m256i, children: __m256i, mask: u32) {
        debug_assert!(self.len + mask.count_ones() as usize <= self.full, "there is room");
        let children = _mm256_permutevar8x32_epi32(children, places(mask));
        // SAFETY: there is room for eight.
        unsafe {
            _mm256_storeu_si256(self.rays.add(self.len).cast(), ray);
            _mm256_storeu_si256(self.children.add(self.len).cast(), children);
        }
        self.len += mask.count_ones() as usize;
    }
}
