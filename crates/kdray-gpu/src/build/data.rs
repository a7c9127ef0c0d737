//! What lies in the arrays, word for word as the shaders see it.
//!
//! Positions are *ordered*: integers that compare like the numbers ([`kdray::build::ordered`]).
//! So nothing but prices and clipping touches a float.

use bytemuck::{Pod, Zeroable};
use kdray::Aabb;
use kdray::build::position_of;

/// What an event says of its reference. At one position events come in this order.
///
/// Every reference has two events an axis. One that is not flat starts on the left of a plane and
/// ends on its right; a flat one enters the left before it leaves the right. So every kind either
/// adds one reference to the left or takes one from the right.
pub(crate) mod kind {
    pub(crate) const END: u32 = 0;
    pub(crate) const ENTER: u32 = 1;
    pub(crate) const LEAVE: u32 = 2;
    pub(crate) const START: u32 = 3;
}

/// Where a reference ends, lies flat or starts along an axis.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Event {
    pub(crate) position: u32,
    /// Place of the reference among those of the level, and in the two lowest bits the kind.
    pub(crate) what: u32,
}

impl Event {
    pub(crate) fn place(self) -> usize {
        (self.what >> 2) as usize
    }

    pub(crate) fn kind(self) -> u32 {
        self.what & 3
    }

    /// Whether it adds a reference to the left of a plane.
    pub(crate) fn is_left(self) -> bool {
        self.what & 1 == 1
    }

    /// What the order of a list depends on.
    pub(crate) fn order(self) -> (u32, u32) {
        (self.position, self.kind())
    }

    /// The events along an axis of the reference at `place` with these bounds.
    pub(crate) fn pair(lower: u32, upper: u32, place: u32) -> [Self; 2] {
        let kinds =
            if lower == upper { [kind::ENTER, kind::LEAVE] } else { [kind::START, kind::END] };
        let event = |position, kind| Self { position, what: place << 2 | kind };
        [event(lower, kinds[0]), event(upper, kinds[1])]
    }
}

/// A triangle in a node.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Reference {
    pub(crate) triangle: u32,
    /// The node, among those of the level.
    pub(crate) slot: u32,
}

/// Words before the references of a level: how many there are, and how many of them are new parts;
/// and how many references and new parts a node has at most.
pub(crate) const HEADER: usize = 4;

/// The words with what a node has at most.
pub(crate) const MOST: [u32; 2] = [2, 3];

/// A node of the level. Its references and, twice as many an axis, its events lie together.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Node {
    pub(crate) lower: [u32; 3],
    pub(crate) first: u32,
    pub(crate) upper: [u32; 3],
    pub(crate) count: u32,
    /// Of its references, those that are new parts, among the new parts of the level.
    pub(crate) fresh_first: u32,
    pub(crate) fresh_count: u32,
}

impl Node {
    pub(crate) fn bounds(&self) -> Aabb {
        Aabb { lower: self.lower.map(position_of), upper: self.upper.map(position_of) }
    }
}

/// The cheapest plane found so far. All bits are inverted: zeros are no plane, and the greatest
/// is the best.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Best {
    pub(crate) price: u32,
    /// Axis and place of the first event with that price.
    pub(crate) index: u32,
    /// The same among the events whose price holds with flat references on the left.
    pub(crate) left_index: u32,
}

/// Bits of an index that are the event; the axis is above.
pub(crate) const AXIS_SHIFT: u32 = 30;

/// What becomes of a node.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Plan {
    /// Of the plane.
    pub(crate) position: u32,
    /// The plane's axis, plus [`FLAT_RIGHT`] if flat references go right; or [`LEAF`], or
    /// [`FINISHED`] with all that is below it.
    pub(crate) what: u32,
    /// Of an inner node the place of its children among all pairs of the level. Of others the place
    /// of their references or piece among all that is finished.
    pub(crate) place: u32,
}

pub(crate) const FLAT_RIGHT: u32 = 4;
pub(crate) const LEAF: u32 = 3;
pub(crate) const FINISHED: u32 = 7;

impl Plan {
    /// Whether its children are nodes of the next level.
    pub(crate) fn is_inner(&self) -> bool {
        self.what & 3 != LEAF
    }

    pub(crate) fn axis(&self) -> usize {
        (self.what & 3) as usize
    }
}

/// How many of the level's references there are before a place, by where they go.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Ranks {
    pub(crate) straddlers: u32,
    pub(crate) left: u32,
    pub(crate) right: u32,
}

/// Two children to come: their parent, and the ranks where its references start and end.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Pair {
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) start: Ranks,
    pub(crate) end: Ranks,
}

/// Bounds of a straddler's part on one side of the plane; [`NONE`] in front if there is no part.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Part {
    pub(crate) lower: [u32; 3],
    pub(crate) upper: [u32; 3],
}

/// No place.
pub(crate) const NONE: u32 = u32::MAX;

/// The bit of a name that says that the reference went right.
pub(crate) const TO_RIGHT: u32 = 1 << 31;

/// A node of the tree that is not yet in its place: as [`kdray::Node`], but an inner node names the
/// first of its two children, and a leaf's references lie where the level put them. Or a finished
/// subtree: where its piece lies, and [`NONE`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Record {
    pub(crate) first: u32,
    pub(crate) second: u32,
}

impl Record {
    /// The first of the two children, unless it is a leaf.
    pub(crate) fn children(self) -> Option<usize> {
        (self.second & 3 != LEAF).then_some((self.second >> 2) as usize)
    }
}

/// Nodes and references of a subtree, or those that come before it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Extent {
    pub(crate) nodes: u32,
    pub(crate) references: u32,
}
