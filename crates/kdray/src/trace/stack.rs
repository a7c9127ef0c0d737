//! What a traversal has still to visit.

use std::mem::MaybeUninit;

use super::wide::Child;
use crate::build::MAX_DEPTH;

/// Every step takes one visit and puts back at most eight, and goes down a level at least; the blocks
/// of a leaf may be a level of their own. The last eight places are never on the stack: some write eight whatever they push.
const CAPACITY: usize = 7 * (MAX_DEPTH as usize + 2) + 16;

/// Room for a traversal that takes two visits a step, of nodes in the order of their levels: then a
/// level has at most sixteen, and two of them are gone before there is another below it.
pub(super) const CAPACITY_OF_TWO: usize = 14 * (MAX_DEPTH as usize + 2) + 32;

pub(super) type Stack = StackOf<CAPACITY>;

/// A stack of subtrees to be visited, and of the `t` where the ray enters each, or how far they are.
pub(super) struct StackOf<const CAPACITY: usize> {
    children: [MaybeUninit<Child>; CAPACITY],
    t_min: [MaybeUninit<f32>; CAPACITY],
    height: usize,
}

impl<const CAPACITY: usize> StackOf<CAPACITY> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            children: [const { MaybeUninit::uninit() }; CAPACITY],
            t_min: [const { MaybeUninit::uninit() }; CAPACITY],
            height: 0,
        }
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.height = 0;
    }

    #[inline(always)]
    pub(super) fn push(&mut self, child: Child, t_min: f32) {
        debug_assert!(self.height < CAPACITY, "a level pushes seven");
        // SAFETY: by the number of levels there is room above the height.
        unsafe {
            self.children.get_unchecked_mut(self.height).write(child);
            self.t_min.get_unchecked_mut(self.height).write(t_min);
        }
        self.height += 1;
    }

    /// Pushes the first `count` of eight subtrees.
    #[cfg(target_arch = "x86_64")]
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn push_avx2(
        &mut self,
        children: std::arch::x86_64::__m256i,
        t_min: std::arch::x86_64::__m256,
        count: usize,
    ) {
        use std::arch::x86_64::*;
        debug_assert!(self.height + 8 <= CAPACITY, "a level pushes seven");
        // SAFETY: by the number of levels there is room for eight above the height.
        unsafe {
            let children_end = self.children.as_mut_ptr().add(self.height);
            let t_min_end = self.t_min.as_mut_ptr().add(self.height);
            _mm256_storeu_si256(children_end.cast(), children);
            _mm256_storeu_ps(t_min_end.cast(), t_min);
        }
        self.height += count;
    }

    /// Pushes the first `count` of eight subtrees.
    #[inline(always)]
    pub(super) fn push_eight(&mut self, children: [Child; 8], near: [f32; 8], count: usize) {
        debug_assert!(self.height + 8 <= CAPACITY, "a level pushes seven");
        // SAFETY: by the number of levels there is room for eight above the height.
        unsafe {
            self.children.as_mut_ptr().add(self.height).cast::<[Child; 8]>().write(children);
            self.t_min.as_mut_ptr().add(self.height).cast::<[f32; 8]>().write(near);
        }
        self.height += count;
    }

    #[inline(always)]
    pub(super) fn height(&self) -> usize {
        self.height
    }

    /// The subtree on top, if it is above that height.
    #[inline(always)]
    pub(super) fn top_above(&self, height: usize) -> Option<Child> {
        // SAFETY: everything below the height was written.
        (self.height > height)
            .then(|| unsafe { self.children.get_unchecked(self.height - 1).assume_init() })
    }

    /// The subtree on top of a stack that is not empty.
    #[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
    #[inline(always)]
    pub(super) fn take(&mut self) -> Child {
        debug_assert!(self.height > 0, "there is one");
        self.height -= 1;
        // SAFETY: everything below the old height was written.
        unsafe { self.children.get_unchecked(self.height).assume_init() }
    }

    /// The subtree on top, without those that the ray enters after `until`.
    #[inline(always)]
    pub(super) fn pop(&mut self, until: f32) -> Option<Child> {
        loop {
            self.height = self.height.checked_sub(1)?;
            // SAFETY: everything below the old height was written.
            unsafe {
                if self.t_min.get_unchecked(self.height).assume_init() <= until {
                    return Some(self.children.get_unchecked(self.height).assume_init());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_entered_too_late_is_passed_over() {
        let mut stack = Stack::new();
        for (child, t_min) in [(1, 0.5), (2, 3.0), (3, 1.0), (4, 2.0)] {
            stack.push(Child(child), t_min);
        }
        assert_eq!(stack.pop(1.0), Some(Child(3)));
        assert_eq!(stack.pop(1.0), Some(Child(1)));
        assert_eq!(stack.pop(1.0), None);
    }
}
