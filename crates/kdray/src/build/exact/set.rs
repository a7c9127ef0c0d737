//! What the builder knows of a node: its references, and their events in order.

use super::event::{Event, events_of};
use super::partition::SPARE;
use super::sort::sort;
use crate::geometry::ordered::position_of;
use crate::geometry::{Aabb, Mesh};
use crate::memory::{with_huge_pages, zeros_in_huge_pages};

/// References of a node. Reference `i` is triangle `triangles[i]`; they ascend. Its bounds are
/// nowhere but in the events.
#[derive(Clone, Copy)]
pub(super) struct Set<'a> {
    pub(super) triangles: &'a [u32],
    /// By axis, sorted by position and kind: two of every reference.
    pub(super) events: [&'a [Event]; 3],
}

impl Set<'_> {
    /// The lists of a node without references.
    pub(super) const EMPTY: Set<'static> = Set { triangles: &[], events: [&[], &[], &[]] };

    /// Bounds of each reference.
    pub(super) fn parts(&self) -> Vec<Aabb> {
        let mut parts = vec![Aabb::EMPTY; self.triangles.len()];
        for (axis, events) in self.events.iter().enumerate() {
            for event in *events {
                let Aabb { lower, upper } = &mut parts[event.reference()];
                let end = if event.enters() { lower } else { upper };
                end[axis] = position_of(event.ordered_position());
            }
        }
        parts
    }

    /// Bounds of all references.
    pub(super) fn bounds(&self) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for (axis, events) in self.events.iter().enumerate() {
            if let [first, .., last] = events {
                bounds.lower[axis] = position_of(first.ordered_position());
                bounds.upper[axis] = position_of(last.ordered_position());
            }
        }
        bounds
    }
}

/// Room for the references of a node, with places to spare in every list (see `partition`).
pub(super) struct Room<'a> {
    pub(super) triangles: &'a mut [u32],
    pub(super) events: [&'a mut [Event]; 3],
}

/// A node that owns its lists.
pub(super) struct OwnedSet {
    triangles: Vec<u32>,
    events: [Vec<Event>; 3],
}

/// Events and triangles that [`Room`] for `count` references takes.
pub(super) const fn room_sizes(count: usize) -> (usize, usize) {
    (3 * (2 * count + SPARE), count + 1)
}

impl OwnedSet {
    /// Empty lists with room for `count` references.
    pub(super) fn with_room(count: usize) -> Self {
        let events = || zeros_in_huge_pages(2 * count + SPARE);
        Self { triangles: zeros_in_huge_pages(count + 1), events: [events(), events(), events()] }
    }

    /// Bytes of a set with room for `count` references.
    pub(super) fn bytes(count: usize) -> usize {
        let (events, triangles) = room_sizes(count);
        events * size_of::<Event>() + triangles * size_of::<u32>()
    }

    pub(super) fn triangles_mut(&mut self) -> &mut [u32] {
        &mut self.triangles
    }

    pub(super) fn events_mut(&mut self) -> [&mut [Event]; 3] {
        let [x, y, z] = &mut self.events;
        [x, y, z]
    }

    /// Cuts the lists to what was filled.
    pub(super) fn truncate(&mut self, count: usize) {
        self.triangles.truncate(count);
        self.events.iter_mut().for_each(|events| events.truncate(2 * count));
    }

    pub(super) fn as_set(&self) -> Set<'_> {
        let [x, y, z] = &self.events;
        Set { triangles: &self.triangles, events: [x, y, z] }
    }

    /// All triangles of `mesh`, with their events along `axis` sorted by `sorted_events`.
    pub(super) fn root(mesh: &Mesh, events: [Vec<Event>; 3]) -> Self {
        Self { triangles: (0..mesh.triangles().len() as u32).collect(), events }
    }
}

/// The events of all triangles along `axis`, in order.
pub(super) fn sorted_events(mesh: &Mesh, axis: usize) -> Vec<Event> {
    let mut events = with_huge_pages(2 * mesh.triangles().len());
    for triangle in 0..mesh.triangles().len() {
        let bounds = Aabb::of_points(&mesh.triangle(triangle));
        events.extend(events_of(&bounds, axis, triangle as u32));
    }
    sort(events)
}

impl<'a> Room<'a> {
    /// Room for `count` references at the start of `scratch`, and the rest of it.
    pub(super) fn carve(scratch: Scratch<'a>, count: usize) -> (Self, Scratch<'a>) {
        let (triangles, free_triangles) = scratch.triangles.split_at_mut(count + 1);
        let (x, rest) = scratch.events.split_at_mut(2 * count + SPARE);
        let (y, rest) = rest.split_at_mut(2 * count + SPARE);
        let (z, free_events) = rest.split_at_mut(2 * count + SPARE);
        let free = Scratch { triangles: free_triangles, events: free_events };
        (Self { triangles, events: [x, y, z] }, free)
    }

    /// What was filled.
    pub(super) fn into_set(self, count: usize) -> Set<'a> {
        let events = self.events.map(|events| &events[..2 * count]);
        Set { triangles: &self.triangles[..count], events }
    }
}

/// Memory that the nodes of a small subtree share, used like a stack.
pub(super) struct Scratch<'a> {
    pub(super) triangles: &'a mut [u32],
    pub(super) events: &'a mut [Event],
}

impl Scratch<'_> {
    /// The same memory for a shorter time.
    pub(super) fn reborrow(&mut self) -> Scratch<'_> {
        Scratch { triangles: self.triangles, events: self.events }
    }

    /// Whether two children with `counts` references find room.
    pub(super) fn holds(&self, counts: [usize; 2]) -> bool {
        let [left, right] = counts.map(room_sizes);
        left.0 + right.0 <= self.events.len() && left.1 + right.1 <= self.triangles.len()
    }
}
