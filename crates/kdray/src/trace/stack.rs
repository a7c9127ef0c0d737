//! What a traversal has still to visit.

use std::mem::MaybeUninit;

use super::wide::Child;
use crate::build::MAX_DEPTH;

/// Every step takes one entry and puts back at most eight, and goes down three levels; a store of
/// eight lanes needs room for all of them.
const CAPACITY: usize = 7 * (MAX_DEPTH as usize / 3 + 2) + 8;

/// A subtree to be visited, and the part of the ray inside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visit {
    pub(super) child: Child,
    pub(super) t_min: f32,
    pub(super) t_max: f32,
}

/// A stack of visits.
pub(super) struct Stack {
    children: [MaybeUninit<Child>; CAPACITY],
    t_min: [MaybeUninit<f32>; CAPACITY],
    t_max: [MaybeUninit<f32>; CAPACITY],
    height: usize,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            children: [const { MaybeUninit::uninit() }; CAPACITY],
            t_min: [const { MaybeUninit::uninit() }; CAPACITY],
            t_max: [const { MaybeUninit::uninit() }; CAPACITY],
            height: 0,
        }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, visit: Visit) {
        self.children[self.height].write(visit.child);
        self.t_min[self.height].write(visit.t_min);
        self.t_max[self.height].write(visit.t_max);
        self.height += 1;
    }

    /// Pushes the first `count` lanes of children, `t_min` and `t_max`.
    #[cfg(target_arch = "x86_64")]
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn push_lanes(&mut self, lanes: [std::arch::x86_64::__m256; 3], count: usize) {
        use std::arch::x86_64::_mm256_storeu_ps;
        debug_assert!(self.height + 8 <= CAPACITY, "trees are at most MAX_DEPTH deep");
        // SAFETY: there is room for eight more entries, because a tree is at most MAX_DEPTH deep.
        unsafe {
            _mm256_storeu_ps(self.children.as_mut_ptr().add(self.height).cast(), lanes[0]);
            _mm256_storeu_ps(self.t_min.as_mut_ptr().add(self.height).cast(), lanes[1]);
            _mm256_storeu_ps(self.t_max.as_mut_ptr().add(self.height).cast(), lanes[2]);
        }
        self.height += count;
    }

    /// The visit on top.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Visit> {
        self.height = self.height.checked_sub(1)?;
        // SAFETY: everything below the old height was written.
        unsafe {
            Some(Visit {
                child: self.children.get_unchecked(self.height).assume_init(),
                t_min: self.t_min.get_unchecked(self.height).assume_init(),
                t_max: self.t_max.get_unchecked(self.height).assume_init(),
            })
        }
    }
}
