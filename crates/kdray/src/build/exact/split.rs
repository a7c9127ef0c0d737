//! Send every reference of a node to the children its bounds reach, and their events with them.
//!
//! Events keep their order, because every list is split from front to back. Only straddlers
//! get new bounds, so only their events are made anew; they are sorted among themselves and merged
//! into the lists once these are split (\[WH06], section 4.3).

use super::Context;
use super::event::{Event, Kind, events_of};
use super::partition::{TO_NONE, TO_RIGHT, merge, partition};
use super::set::Set;
use super::sweep::Candidate;
use crate::build::NodeCost;
use crate::build::plane::{Plane, Side};
use crate::geometry::Aabb;
use crate::geometry::ordered::ordered;

/// The children that a reference reaches, as the bits of a byte.
const LEFT: u8 = 1;
const RIGHT: u8 = 2;
const BOTH: u8 = LEFT | RIGHT;
/// The bit of straddlers, whose parts reach the children.
const IN_PARTS: u8 = 4;

/// Memory that is used again from node to node.
#[derive(Default)]
pub(super) struct Workspace {
    sides: Vec<u8>,
    names: Vec<u32>,
    straddlers: Vec<Straddler>,
    /// By child and axis: the events of its new parts.
    fresh: [[Vec<Event>; 3]; 2],
}

/// A reference on both sides of the plane.
#[derive(Clone, Copy)]
struct Straddler {
    reference: u32,
    /// Bounds of its parts on the two sides.
    parts: [Option<Aabb>; 2],
}

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
            + self.straddlers.capacity() * size_of::<Straddler>()
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
        let count = set.triangles.len();
        let by_place = ByPlace::new(set.events[candidate.axis], candidate.position);
        let plane = with_flat_side(&by_place, count, bounds, candidate, cost);
        self.mark_sides(&by_place, count, plane.flat);
        self.find_straddlers(count);
        self.clip_straddlers(set, bounds, &plane, context);
        let sides = &self.sides[..count];
        let reached = |side: u8| sides.iter().map(|reach| usize::from(reach & side != 0)).sum();
        Sizes { left: reached(LEFT), right: reached(RIGHT), straddlers: self.straddlers.len() }
    }

    fn mark_sides(&mut self, by_place: &ByPlace, count: usize, flat: Side) {
        // The last place takes the marks that say nothing.
        self.sides.clear();
        self.sides.resize(count + 1, BOTH);
        for event in by_place.below {
            let place = if event.enters() { count } else { event.reference() };
            self.sides[place] = LEFT;
        }
        for event in by_place.above {
            let place = if event.enters() { event.reference() } else { count };
            self.sides[place] = RIGHT;
        }
        let of_flat = if flat == Side::Left { LEFT } else { RIGHT };
        for event in by_place.at {
            let beyond = if event.enters() { RIGHT } else { LEFT };
            self.sides[event.reference()] = if event.is_flat() { of_flat } else { beyond };
        }
    }

    fn find_straddlers(&mut self, count: usize) {
        self.straddlers.clear();
        for (reference, side) in self.sides[..count].iter().enumerate() {
            if *side == BOTH {
                self.straddlers.push(Straddler { reference: reference as u32, parts: [None; 2] });
            }
        }
    }

    fn clip_straddlers(&mut self, set: &Set, bounds: &Aabb, plane: &Plane, context: &Context) {
        let children = bounds.cut(plane.axis, plane.position);
        for Straddler { reference, parts } in &mut self.straddlers {
            let triangle = set.triangles[*reference as usize];
            let corners = context.mesh.triangle(triangle as usize);
            *parts = children.map(|child| context.limits.part(&corners, &child));
            let [left, right] = parts.map(|part| u8::from(part.is_some()));
            self.sides[*reference as usize] = IN_PARTS | (left * LEFT) | (right * RIGHT);
        }
    }

    /// Names the references in their children and writes their triangles there.
    pub(super) fn name(&mut self, set: &Set, [left, right]: [&mut [u32]; 2]) {
        self.names.clear();
        self.names.resize(set.triangles.len(), TO_NONE);
        self.fresh.iter_mut().flatten().for_each(Vec::clear);
        let (mut lefts, mut rights) = (0, 0);
        let mut straddlers = self.straddlers.iter();
        let references = set.triangles.iter().zip(&self.sides).zip(&mut self.names);
        for ((triangle, side), name) in references {
            // Both places are free; the one that is not meant is written again.
            left[lefts] = *triangle;
            right[rights] = *triangle;
            if *side & IN_PARTS == 0 {
                *name = if *side == LEFT { lefts as u32 } else { rights as u32 | TO_RIGHT };
            } else {
                let [below, above] = straddlers.next().expect("every straddler is known").parts;
                push_events(&mut self.fresh[0], below.as_ref(), lefts as u32);
                push_events(&mut self.fresh[1], above.as_ref(), rights as u32);
            }
            lefts += usize::from(side & LEFT != 0);
            rights += usize::from(side & RIGHT != 0);
        }
        self.fresh.iter_mut().flatten().for_each(|events| events.sort_unstable());
    }

    /// Splits the events of one axis into the lists of the children.
    pub(super) fn split_axis(
        &self,
        axis: usize,
        events: &[Event],
        [left, right]: [&mut [Event]; 2],
    ) {
        let [lefts, rights] = partition(events, &self.names, [left, right]);
        merge(left, lefts, &self.fresh[0][axis]);
        merge(right, rights, &self.fresh[1][axis]);
    }
}

/// Adds the events of a part under its name in the child.
fn push_events(fresh: &mut [Vec<Event>; 3], part: Option<&Aabb>, name: u32) {
    let Some(part) = part else { return };
    for axis in 0..3 {
        fresh[axis].extend(events_of(part, axis, name));
    }
}

/// The events along a plane's axis, by where they are.
struct ByPlace<'a> {
    below: &'a [Event],
    at: &'a [Event],
    above: &'a [Event],
}

impl<'a> ByPlace<'a> {
    fn new(events: &'a [Event], position: f32) -> Self {
        let position = ordered(position);
        let (below, rest) =
            events.split_at(events.partition_point(|event| event.ordered_position() < position));
        // They are few, mostly one.
        let at = rest.iter().take_while(|event| event.ordered_position() == position).count();
        let (at, above) = rest.split_at(at);
        Self { below, at, above }
    }
}

/// The plane of `candidate`, with its flat references on the cheaper side (left on a tie).
fn with_flat_side(
    by_place: &ByPlace,
    count: usize,
    bounds: &Aabb,
    candidate: &Candidate,
    cost: &NodeCost,
) -> Plane {
    let Candidate { axis, position, .. } = *candidate;
    let of_kind = |kind| by_place.at.iter().filter(|event| event.is(kind)).count() as i32;
    let flat = of_kind(Kind::FlatEnter);
    if flat == 0 {
        return Plane { axis, position, flat: Side::Left };
    }
    let left = by_place.below.iter().map(|event| i32::from(event.enters())).sum::<i32>();
    let gone = by_place.below.len() as i32 - left + of_kind(Kind::End);
    let right = count as i32 - gone - flat;
    let distances = [position - bounds.lower[axis], bounds.upper[axis] - position];
    let price_left = cost.split(axis, distances, [left + flat, right]);
    let price_right = cost.split(axis, distances, [left, right + flat]);
    let flat = if price_left <= price_right { Side::Left } else { Side::Right };
    Plane { axis, position, flat }
}
