//! Small subtrees: depth-first, in scratch memory that stays in the cache.

use super::event::Event;
use super::set::{Room, Scratch, Set, room_sizes};
use super::split::Workspace;
use super::sweep::{cheapest, sweep};
use super::tiny::{TINY, Tiny};
use super::{BuildError, Context, Growth, Node};
use crate::memory::zeros_in_huge_pages;

/// What the task of a small subtree works with.
#[derive(Default)]
pub(super) struct Small {
    workspace: Workspace,
    tiny: Tiny,
    events: Vec<Event>,
    triangles: Vec<u32>,
    /// Bytes that were booked for the workspace.
    booked: usize,
}

/// Scratch holds this many times the lists of the subtree's root. Children and their children need
/// about twice as much as their parent; straddlers need more, and a node that finds no room
/// gets new scratch.
const SCRATCH: usize = 4;

/// Builds the subtree of a node.
pub(super) fn build(context: &Context, set: Set, node: Node) -> Result<Growth, BuildError> {
    context.meter.check_cancelled()?;
    let idle = || context.idle.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let mut small = idle().pop().unwrap_or_default();
    small.reserve(context, set.triangles.len())?;
    let mut growth = Growth::default();
    let scratch = Scratch { triangles: &mut small.triangles, events: &mut small.events };
    let (workspace, tiny) = (&mut small.workspace, &mut small.tiny);
    let mut subtree = Subtree { context, workspace, tiny, growth: &mut growth };
    subtree.node(set, node, scratch)?;
    // The workspace grows with the straddlers, which nobody knew before.
    let bytes = small.workspace.bytes() + small.tiny.bytes();
    context.meter.charge("clip", bytes - small.booked)?;
    small.booked = bytes;
    idle().push(small);
    context.meter.charge("tree", growth.capacity_bytes())?;
    context.meter.advance(node.share);
    growth.check_size()?;
    Ok(growth)
}

impl Small {
    fn reserve(&mut self, context: &Context, count: usize) -> Result<(), BuildError> {
        let (events, triangles) = room_sizes(SCRATCH * count);
        let more = |len: usize, now: usize| len.saturating_sub(now);
        let bytes = more(events, self.events.len()) * size_of::<Event>()
            + more(triangles, self.triangles.len()) * size_of::<u32>();
        context.meter.charge("small subtree", bytes)?;
        if events > self.events.len() {
            self.events = zeros_in_huge_pages(events);
        }
        if triangles > self.triangles.len() {
            self.triangles = zeros_in_huge_pages(triangles);
        }
        Ok(())
    }

    fn bytes(&self) -> usize {
        self.events.len() * size_of::<Event>() + self.triangles.len() * size_of::<u32>()
    }
}

struct Subtree<'a> {
    context: &'a Context<'a>,
    workspace: &'a mut Workspace,
    tiny: &'a mut Tiny,
    growth: &'a mut Growth,
}

impl Subtree<'_> {
    fn node(&mut self, set: Set, node: Node, mut scratch: Scratch) -> Result<(), BuildError> {
        let count = set.triangles.len();
        if count <= TINY {
            self.tiny.build(self.context, self.growth, &set, node);
            return Ok(());
        }
        let Some(cost) = self.context.prices(&node, count) else {
            self.growth.push_leaf(set.triangles, &set.bounds());
            return Ok(());
        };
        let by_axis = [0, 1, 2].map(|axis| sweep(&set, &node.bounds, &cost, axis));
        let Some(candidate) = cheapest(by_axis, cost.leaf(count)) else {
            self.growth.push_leaf(set.triangles, &set.bounds());
            return Ok(());
        };
        let sizes = self.workspace.assign(&set, &node.bounds, &candidate, &cost, self.context);
        let counts = [sizes.left, sizes.right];
        let [left, right] = node.cut(candidate.axis, candidate.position, counts);
        let place = self.growth.push_inner(candidate.axis, candidate.position);
        if sizes.is_cut_off() {
            let (left_set, right_set) =
                if sizes.left == 0 { (Set::EMPTY, set) } else { (set, Set::EMPTY) };
            self.node(left_set, left, scratch.reborrow())?;
            self.growth.set_right(place);
            return self.node(right_set, right, scratch);
        }
        let children = [left, right];
        if scratch.holds(counts) {
            return self.children(&set, scratch, counts, children, place);
        }
        let mut more = Small::default();
        more.reserve(self.context, sizes.left + sizes.right)?;
        let scratch = Scratch { triangles: &mut more.triangles, events: &mut more.events };
        self.children(&set, scratch, counts, children, place)?;
        self.context.meter.release(more.bytes());
        Ok(())
    }

    /// Splits the node's lists and builds both children, below the inner node at `place`.
    fn children(
        &mut self,
        set: &Set,
        scratch: Scratch,
        counts: [usize; 2],
        [left, right]: [Node; 2],
        place: usize,
    ) -> Result<(), BuildError> {
        let (sets, mut scratch) = self.split(set, scratch, counts);
        self.node(sets[0], left, scratch.reborrow())?;
        self.growth.set_right(place);
        self.node(sets[1], right, scratch)
    }

    /// The lists of the two children, and the scratch that is left.
    fn split<'s>(
        &mut self,
        set: &Set,
        scratch: Scratch<'s>,
        [left, right]: [usize; 2],
    ) -> ([Set<'s>; 2], Scratch<'s>) {
        let (left_room, scratch) = Room::carve(scratch, left);
        let (right_room, scratch) = Room::carve(scratch, right);
        self.workspace.name(set, [left_room.triangles, right_room.triangles]);
        for axis in 0..3 {
            let lists = [&mut *left_room.events[axis], &mut *right_room.events[axis]];
            self.workspace.split_axis(axis, set.events[axis], lists);
        }
        ([left_room.into_set(left), right_room.into_set(right)], scratch)
    }
}
