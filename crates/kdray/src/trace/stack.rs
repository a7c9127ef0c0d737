//! What a traversal has still to visit.

use std::mem::MaybeUninit;

use super::wide::Child;
use crate::build::MAX_DEPTH;

/// Every step takes one visit and puts back at most eight, and goes down a level at least.
const CAPACITY: usize = 7 * (MAX_DEPTH as usize + 1) + 8;

/// A subtree to be visited, and where the ray enters it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visit {
    pub(super) child: Child,
    pub(super) t_min: f32,
}

/// A stack of visits.
pub(super) struct Stack {
    visits: [MaybeUninit<Visit>; CAPACITY],
    height: usize,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { visits: [const { MaybeUninit::uninit() }; CAPACITY], height: 0 }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, visit: Visit) {
        self.visits[self.height].write(visit);
        self.height += 1;
    }

    /// Pushes a visit below those of the last `count` that are nearer.
    #[inline(always)]
    pub(super) fn insert(&mut self, visit: Visit, count: usize) {
        self.push(visit);
        let mut place = self.height - 1;
        for _ in 0..count {
            // SAFETY: everything below the height was written.
            let before = unsafe { self.visits[place - 1].assume_init() };
            if before.t_min >= visit.t_min {
                break;
            }
            self.visits[place].write(before);
            place -= 1;
        }
        self.visits[place].write(visit);
    }

    /// The visit on top.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Visit> {
        self.height = self.height.checked_sub(1)?;
        // SAFETY: everything below the old height was written.
        Some(unsafe { self.visits.get_unchecked(self.height).assume_init() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inserted_visits_are_popped_from_near_to_far() {
        let mut stack = Stack::new();
        let visit = |t_min| Visit { child: Child(0), t_min };
        stack.push(visit(0.5));
        for (count, t_min) in [3.0, 1.0, 4.0, 1.0, 2.0].into_iter().enumerate() {
            stack.insert(visit(t_min), count);
        }
        let order: Vec<f32> = std::iter::from_fn(|| stack.pop()).map(|v| v.t_min).collect();
        assert_eq!(order, [1.0, 1.0, 2.0, 3.0, 4.0, 0.5]);
    }
}
