//! Send every reference of a node to the children its bounds reach, and their events with them.
//!
//! Events keep their order, because every list is split from front to back. Only straddlers
//! get new bounds, so only their events are made anew; they are sorted among themselves and merged
//! into the lists while these are split (\[WH06], section 4.3).

use super::Context;
use super::event::{Event, Kind, events_of};
use super::set::Set;
use super::sweep::Candidate;
use crate::build::NodeCost;
use crate::build::plane::{Plane, Side};
use crate::geometry::Aabb;

/// The child that a reference goes to, as a byte.
const LEFT: u8 = 0;
const RIGHT: u8 = 1;
const BOTH: u8 = 2;

/// A reference's name in its child, with the child in the two highest bits.
const TO_RIGHT: u32 = 1 << 30;
const TO_NONE: u32 = 1 << 31;

/// Memory that is used again from node to node.
#[derive(Default)]
pub(super) struct Workspace {
    sides: Vec<u8>,
    names: Vec<u32>,
    /// Of the straddlers, in order.
    parts: Vec<Parts>,
    /// By child and axis: the events of its new parts.
    fresh: [[Vec<Event>; 3]; 2],
}

/// Bounds of a straddler's parts on the two sides of the plane.
type Parts = [Option<Aabb>; 2];

/// How many references the children get.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sizes {
    pub(super) left: usize,
    pub(super) right: usize,
    straddlers: usize,
}

impl Sizes {
    /// Whether the plane only cuts off empty space: the other child is the node again.
    pub(super) fn is_cut_off(&self) -> bool {
        self.straddlers == 0 && (self.left == 0 || self.right == 0)
    }
}

impl Workspace {
    /// Bytes that its lists hold.
    pub(super) fn bytes(&self) -> usize {
        let fresh: usize = self.fresh.as_flattened().iter().map(Vec::capacity).sum();
        self.sides.capacity()
            + self.names.capacity() * size_of::<u32>()
            + self.parts.capacity() * size_of::<Parts>()
            + fresh * size_of::<Event>()
    }

    /// Bytes that its lists will hold, at least, for a node of `count` references.
    pub(super) fn bytes_for(count: usize) -> usize {
        count * (size_of::<u8>() + size_of::<u32>())
    }

    /// Decides which children every reference of `set` reaches and clips the straddlers.
    pub(super) fn assign(
        &mut self,
        set: &Set,
        bounds: &Aabb,
        candidate: &Candidate,
        cost: &NodeCost,
        context: &Context,
    ) -> Sizes {
        let events = set.events[candidate.axis];
        let plane = with_flat_side(events, set.triangles.len(), bounds, candidate, cost);
        self.mark_sides(events, set.triangles.len(), &plane);
        self.clip_straddlers(set, bounds, &plane, context);
        let sides = &self.sides[..set.triangles.len()];
        let left = sides.iter().filter(|side| **side == LEFT).count();
        let straddlers = self.parts.len();
        let part_count =
            |side: usize| self.parts.iter().filter(|parts| parts[side].is_some()).count();
        let right = sides.len() - left - straddlers;
        Sizes { left: left + part_count(0), right: right + part_count(1), straddlers }
    }

    fn mark_sides(&mut self, events: &[Event], count: usize, plane: &Plane) {
        // The last place takes the marks that say nothing.
        self.sides.clear();
        self.sides.resize(count + 1, BOTH);
        let ordered = super::event::ordered(plane.position);
        let until = events.partition_point(|event| event.ordered_position() <= ordered);
        for event in &events[..until] {
            let place = if event.is(Kind::End) { event.reference() } else { count };
            self.sides[place] = LEFT;
        }
        let from = events.partition_point(|event| event.ordered_position() < ordered);
        for event in &events[from..] {
            let place = if event.is(Kind::Start) { event.reference() } else { count };
            self.sides[place] = RIGHT;
        }
        if events.len() != 2 * count {
            let flat = if plane.flat == Side::Left { LEFT } else { RIGHT };
            for (index, event) in events.iter().enumerate().filter(|e| e.1.is(Kind::Planar)) {
                let beyond = if index < until { flat } else { RIGHT };
                self.sides[event.reference()] = if index < from { LEFT } else { beyond };
            }
        }
    }

    fn clip_straddlers(&mut self, set: &Set, bounds: &Aabb, plane: &Plane, context: &Context) {
        let children = bounds.cut(plane.axis, plane.position);
        self.parts.clear();
        for (reference, triangle) in set.triangles.iter().enumerate() {
            if self.sides[reference] == BOTH {
                let corners = context.mesh.triangle(*triangle as usize);
                self.parts.push(children.map(|child| context.limits.part(&corners, &child)));
            }
        }
    }

    /// Names the references in their children and writes their triangles there.
    pub(super) fn name(&mut self, set: &Set, [left, right]: [&mut [u32]; 2]) {
        self.names.clear();
        self.names.resize(set.triangles.len(), TO_NONE);
        self.fresh.iter_mut().flatten().for_each(Vec::clear);
        let (mut lefts, mut rights) = (0, 0);
        let mut parts = self.parts.iter();
        for (reference, triangle) in set.triangles.iter().enumerate() {
            let side = self.sides[reference];
            // Both places are free; the one that is not meant is written again.
            left[lefts] = *triangle;
            right[rights] = *triangle;
            if side == BOTH {
                let [below, above] = parts.next().expect("every straddler was clipped");
                lefts += push_events(&mut self.fresh[0], below.as_ref(), lefts as u32);
                rights += push_events(&mut self.fresh[1], above.as_ref(), rights as u32);
            } else {
                let name = if side == LEFT { lefts as u32 } else { rights as u32 | TO_RIGHT };
                self.names[reference] = name;
                lefts += usize::from(side == LEFT);
                rights += usize::from(side == RIGHT);
            }
        }
        self.fresh.iter_mut().flatten().for_each(|events| events.sort_unstable());
    }

    /// Splits the events of one axis into the lists of the children; gives the lists' lengths.
    pub(super) fn split_axis(
        &self,
        axis: usize,
        old: &[Event],
        [left, right]: [&mut [Event]; 2],
    ) -> [usize; 2] {
        let mut lists = Lists { left, right, lengths: [0, 0] };
        let mut old = old;
        let (mut new_left, mut new_right) = (&self.fresh[0][axis][..], &self.fresh[1][axis][..]);
        loop {
            // The next new event of either child, and the old ones that come before it.
            let next = match (new_left.first(), new_right.first()) {
                (Some(left), Some(right)) => left.order().min(right.order()),
                (Some(only), None) | (None, Some(only)) => only.order(),
                (None, None) => break,
            };
            let before = old.iter().take_while(|event| event.order() < next).count();
            lists.distribute(&old[..before], &self.names);
            old = &old[before..];
            lists.append(0, &mut new_left, next);
            lists.append(1, &mut new_right, next);
        }
        lists.distribute(old, &self.names);
        lists.lengths
    }
}

/// The lists of one axis in the two children, as they fill.
struct Lists<'a> {
    left: &'a mut [Event],
    right: &'a mut [Event],
    lengths: [usize; 2],
}

impl Lists<'_> {
    /// Sends every event where its reference went. Branch-free: both lists are written at their
    /// end, and the one that gets the event grows. That is why lists have a place to spare.
    #[inline(always)]
    fn distribute(&mut self, events: &[Event], names: &[u32]) {
        let [mut lefts, mut rights] = self.lengths;
        for event in events {
            let name = names[event.reference()];
            let renamed = event.renamed(name);
            self.left[lefts] = renamed;
            self.right[rights] = renamed;
            lefts += usize::from(name < TO_RIGHT);
            rights += usize::from(name & (TO_RIGHT | TO_NONE) == TO_RIGHT);
        }
        self.lengths = [lefts, rights];
    }

    /// Appends the first of `fresh` to the list of `child` if it is at `order`.
    fn append(&mut self, child: usize, fresh: &mut &[Event], order: u64) {
        while let Some((first, rest)) = fresh.split_first() {
            if first.order() != order {
                break;
            }
            let list = if child == 0 { &mut *self.left } else { &mut *self.right };
            list[self.lengths[child]] = *first;
            self.lengths[child] += 1;
            *fresh = rest;
        }
    }
}

/// Adds the events of a part under its name in the child; gives 1, or 0 if there is no part.
fn push_events(fresh: &mut [Vec<Event>; 3], part: Option<&Aabb>, name: u32) -> usize {
    let Some(part) = part else { return 0 };
    for axis in 0..3 {
        let (first, second) = events_of(part, axis, name);
        fresh[axis].push(first);
        fresh[axis].extend(second);
    }
    1
}

/// The plane of `candidate`, with its flat references on the cheaper side (left on a tie).
fn with_flat_side(
    events: &[Event],
    count: usize,
    bounds: &Aabb,
    candidate: &Candidate,
    cost: &NodeCost,
) -> Plane {
    let Candidate { axis, position, .. } = *candidate;
    if events.len() == 2 * count {
        return Plane { axis, position, flat: Side::Left };
    }
    let (mut left, mut flat, mut right) = (0, 0, count as i32);
    for event in events.iter().take_while(|event| event.position() <= position) {
        let at_plane = event.position() == position;
        match (event.is(Kind::Planar), event.is(Kind::End)) {
            (true, _) if at_plane => flat += 1,
            (true, _) => (left, right) = (left + 1, right - 1),
            (_, true) => right -= 1,
            _ if at_plane => {}
            _ => left += 1,
        }
    }
    right -= flat;
    let distances = [position - bounds.lower[axis], bounds.upper[axis] - position];
    let price_left = cost.split(axis, distances, [left + flat, right]);
    let price_right = cost.split(axis, distances, [left, right + flat]);
    let flat = if price_left <= price_right { Side::Left } else { Side::Right };
    Plane { axis, position, flat }
}
