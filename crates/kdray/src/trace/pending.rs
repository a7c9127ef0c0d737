//! What is still to be visited, in order.

use std::cell::RefCell;

use super::wide::Child;

thread_local! {
    /// The memory of the last visit of this thread.
    static MEMORY: RefCell<Vec<Visit>> = const { RefCell::new(Vec::new()) };
}

/// A subtree to be visited, and where it begins and ends: along a ray, or away from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visit {
    pub(super) child: Child,
    pub(super) near: f32,
    pub(super) far: f32,
}

/// A stack of visits. Nothing is allocated where a thread has room from its last time.
pub(super) struct Pending {
    visits: Vec<Visit>,
}

impl Pending {
    /// A visit of the whole tree.
    pub(super) fn root() -> Self {
        let mut visits = MEMORY.take();
        visits.clear();
        visits.push(Visit { child: Child(0), near: f32::NEG_INFINITY, far: f32::INFINITY });
        Self { visits }
    }

    /// Adds a visit below those of the last `among` that are nearer.
    #[inline(always)]
    pub(super) fn push(&mut self, visit: Visit, among: usize) {
        self.visits.push(visit);
        let mut place = self.visits.len() - 1;
        for _ in 0..among.min(place) {
            if self.visits[place - 1].near >= visit.near {
                break;
            }
            self.visits.swap(place - 1, place);
            place -= 1;
        }
    }

    /// Adds a visit below all that are nearer. Few are nearer than one that is to come soon.
    pub(super) fn push_in_order(&mut self, visit: Visit) {
        self.push(visit, usize::MAX);
    }

    /// The one on top.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Visit> {
        self.visits.pop()
    }
}

impl Drop for Pending {
    fn drop(&mut self) {
        MEMORY.set(std::mem::take(&mut self.visits));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn visits_come_from_near_to_far() {
        for _ in 0..2 {
            let mut pending = Pending::root();
            assert_eq!(pending.pop().map(|visit| visit.child), Some(Child(0)));
            for near in [3.0, 1.0, 4.0, 1.0, 5.0, 0.5] {
                pending.push_in_order(Visit { child: Child(0), near, far: 6.0 });
            }
            let popped = std::iter::from_fn(|| pending.pop()).map(|visit| visit.near);
            assert_eq!(popped.take(5).collect::<Vec<_>>(), [0.5, 1.0, 1.0, 3.0, 4.0]);
        }
    }
}
