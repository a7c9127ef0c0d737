//! The nodes near the root: lists of their own, parallel over axes and children.

use super::set::{OwnedSet, Set, sorted_events};
use super::split::{Sizes, Workspace};
use super::sweep::{Candidate, cheapest, sweep};
use super::{BuildError, Context, Growth, Node, NodeCost, small, sort};

/// What is made of nodes.
pub(super) trait Maker: Sync {
    type Subtree: Send;

    /// The most references of a node that is not cut here.
    fn most(&self) -> usize;
    /// What such a node becomes.
    fn below(&self, context: &Context, set: Set, node: Node) -> Result<Self::Subtree, BuildError>;
    fn leaf(&self, context: &Context, set: &Set, node: &Node) -> Result<Self::Subtree, BuildError>;
    /// An inner node over two subtrees.
    fn joined(
        &self,
        context: &Context,
        candidate: &Candidate,
        children: [Self::Subtree; 2],
    ) -> Result<Self::Subtree, BuildError>;
}

/// Makes the whole tree.
pub(super) struct Whole;

/// Subtrees of at most this many references are small: one task, in scratch memory. More makes
/// fewer, longer tasks; less leaves more nodes to lists of their own.
const SMALL: usize = 16 * 1024;

/// A set and the bytes that were booked for it.
struct Booked {
    set: OwnedSet,
    bytes: usize,
}

/// Builds from the root on.
pub(super) fn build<M: Maker>(context: &Context, maker: &M) -> Result<M::Subtree, BuildError> {
    let mesh = context.mesh;
    let bytes = OwnedSet::bytes(mesh.triangles().len());
    context.meter.charge("events", bytes)?;
    let sorts = if context.limits.threads > 1 { 3 } else { 1 };
    let sort_bytes = sorts * sort::bytes(2 * mesh.triangles().len());
    context.meter.charge("events", sort_bytes)?;
    let [x, y, z] = on_axes(context, |axis| sorted_events(mesh, axis));
    context.meter.release(sort_bytes);
    let set = OwnedSet::root(mesh, [x, y, z]);
    let root = Node { bounds: mesh.bounds(), depth: 0, share: 1.0 };
    subtree(context, maker, Booked { set, bytes }, root)
}

/// Runs `work` for the three axes, at the same time if the build has threads.
fn on_axes<T: Send>(context: &Context, work: impl Fn(usize) -> T + Sync) -> [T; 3] {
    let (x, (y, z)) = context.join(|| work(0), || context.join(|| work(1), || work(2)));
    [x, y, z]
}

fn subtree<M: Maker>(
    context: &Context,
    maker: &M,
    owned: Booked,
    node: Node,
) -> Result<M::Subtree, BuildError> {
    let set = owned.set.as_set();
    if set.triangles.len() <= maker.most() {
        let made = maker.below(context, set, node);
        context.meter.release(owned.bytes);
        return made;
    }
    context.meter.check_cancelled()?;
    let cost = context.prices(&node, set.triangles.len());
    let plane = cost.and_then(|cost| Some((cheapest_plane(context, &set, &node, &cost)?, cost)));
    let Some((candidate, cost)) = plane else {
        let leaf = maker.leaf(context, &set, &node);
        context.meter.release(owned.bytes);
        return leaf;
    };
    let work_bytes = Workspace::bytes_for(set.triangles.len());
    context.meter.charge("split", work_bytes)?;
    let mut workspace = Workspace::default();
    let sizes = workspace.assign(&set, &node.bounds, &candidate, &cost, context);
    let children = node.cut(candidate.axis, candidate.position, [sizes.left, sizes.right]);
    let (left, right) = if sizes.is_cut_off() {
        context.meter.release(work_bytes);
        drop(workspace);
        cut_off(context, maker, owned, children, sizes)
    } else {
        let [left, right] = split(context, &set, workspace, sizes)?;
        context.meter.release(work_bytes);
        context.meter.release(owned.bytes);
        drop(owned);
        let below = |owned, child| move || subtree(context, maker, owned, child);
        context.join(below(left, children[0]), below(right, children[1]))
    };
    maker.joined(context, &candidate, [left?, right?])
}

fn cheapest_plane(context: &Context, set: &Set, node: &Node, cost: &NodeCost) -> Option<Candidate> {
    let by_axis = on_axes(context, |axis| sweep(set, &node.bounds, cost, axis));
    cheapest(by_axis, cost.leaf(set.triangles.len()))
}

/// One child is empty and the other has the very lists of the node.
fn cut_off<M: Maker>(
    context: &Context,
    maker: &M,
    owned: Booked,
    [left, right]: [Node; 2],
    sizes: Sizes,
) -> (Result<M::Subtree, BuildError>, Result<M::Subtree, BuildError>) {
    if sizes.left == 0 {
        let empty = maker.leaf(context, &Set::EMPTY, &left);
        (empty, subtree(context, maker, owned, right))
    } else {
        let empty = maker.leaf(context, &Set::EMPTY, &right);
        (subtree(context, maker, owned, left), empty)
    }
}

/// The lists of the two children.
fn split(
    context: &Context,
    set: &Set,
    mut workspace: Workspace,
    sizes: Sizes,
) -> Result<[Booked; 2], BuildError> {
    let counts = [sizes.left, sizes.right];
    let bytes = counts.map(OwnedSet::bytes);
    context.meter.charge("split", bytes[0] + bytes[1])?;
    let [mut left, mut right] = counts.map(OwnedSet::with_room);
    workspace.name(set, [left.triangles_mut(), right.triangles_mut()]);
    let straddler_bytes =
        workspace.bytes().saturating_sub(Workspace::bytes_for(set.triangles.len()));
    context.meter.charge("clip", straddler_bytes)?;
    let lists = left.events_mut().into_iter().zip(right.events_mut());
    let mut axes: Vec<_> = lists.enumerate().collect();
    let workspace = &workspace;
    let split_axis = |(axis, (left, right)): &mut (usize, (&mut [_], &mut [_]))| {
        workspace.split_axis(*axis, set.events[*axis], [left, right]);
    };
    if context.limits.threads > 1 {
        use rayon::prelude::*;
        axes.par_iter_mut().for_each(split_axis);
    } else {
        axes.iter_mut().for_each(split_axis);
    }
    left.truncate(sizes.left);
    right.truncate(sizes.right);
    context.meter.release(straddler_bytes);
    let [left_bytes, right_bytes] = bytes;
    Ok([Booked { set: left, bytes: left_bytes }, Booked { set: right, bytes: right_bytes }])
}

impl Maker for Whole {
    type Subtree = Growth;

    fn most(&self) -> usize {
        SMALL
    }

    fn below(&self, context: &Context, set: Set, node: Node) -> Result<Growth, BuildError> {
        small::build(context, set, node)
    }

    fn leaf(&self, context: &Context, set: &Set, node: &Node) -> Result<Growth, BuildError> {
        let mut growth = Growth::default();
        growth.push_leaf(set.triangles, &set.bounds());
        context.meter.charge("tree", growth.capacity_bytes())?;
        context.meter.advance(node.share);
        Ok(growth)
    }

    fn joined(
        &self,
        context: &Context,
        candidate: &Candidate,
        [left, right]: [Growth; 2],
    ) -> Result<Growth, BuildError> {
        let mut growth = Growth {
            nodes: Vec::with_capacity(1 + left.nodes.len() + right.nodes.len()),
            references: Vec::with_capacity(left.references.len() + right.references.len()),
            parts: Vec::with_capacity(left.parts.len() + right.parts.len()),
        };
        context.meter.charge("tree", growth.capacity_bytes())?;
        let place = growth.push_inner(candidate.axis, candidate.position);
        growth.append(&left);
        growth.set_right(place);
        growth.append(&right);
        context.meter.release(left.capacity_bytes() + right.capacity_bytes());
        growth.check_size()?;
        Ok(growth)
    }
}
