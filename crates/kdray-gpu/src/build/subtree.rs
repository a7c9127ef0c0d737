//! A subtree on the CPU as a team builds it: depth first, by the definition of the tree.

use kdray::Aabb;
use kdray::build::{ordered, position_of};
use kdray::geometry::{clip, overlap};

use super::arrays::Arrays;
use super::data::{FLAT_RIGHT, Node, Record};
use super::ends::corners;
use super::kernel::Params;
use super::offer::choice;
use super::piece::Piece;

/// References of a node whose subtree is finished at once, at most.
///
/// More leaves fewer levels to the kernels of the levels; a team's work for a reference grows with
/// it, and so does the memory that a team shares.
pub(crate) const SMALL: u32 = 64;

/// Parts that a team has room for: those of the node that it is at, and of all that wait above it.
pub(crate) const ROOM: usize = 256;

/// Right children that can wait.
pub(crate) const WAITING: usize = 32;

/// A triangle's part in a node: ordered bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Member {
    pub(crate) lower: [u32; 3],
    pub(crate) upper: [u32; 3],
    pub(crate) triangle: u32,
}

/// A node that is to be finished.
pub(crate) struct Task {
    /// Its bounds; how many parts it has.
    pub(crate) node: Node,
    /// Its parts are those from here on.
    first: usize,
    /// The node whose right child it is.
    parent: Option<u32>,
    /// Levels below it.
    pub(crate) depth: u32,
}

/// Words of a triangle's corners: its vertices and their coordinates.
const CORNER_WORDS: u32 = 12;

/// Finishes the subtree of `node`, or gives up. Counts the words that are read on the way.
pub(crate) fn finish(
    arrays: &Arrays,
    params: &Params,
    node: &Node,
    mut members: Vec<Member>,
    (piece, words_read): (&mut Piece, &mut u32),
) -> Option<()> {
    let mut waiting = Vec::new();
    let mut next = Some(Task { node: *node, first: 0, parent: None, depth: params.depth_left });
    while let Some(task) = next {
        members.truncate(task.first + task.node.count as usize);
        let own = &members[task.first..];
        let Some((axis, flat_right, position)) = choice(params, &task, own) else {
            let triangles: Vec<u32> = own.iter().map(|member| member.triangle).collect();
            piece.put_leaf(task.parent, &triangles)?;
            next = waiting.pop();
            continue;
        };
        let plane = (axis, position);
        let [left, right] = [0, 1].map(|side| {
            let share =
                |member: &Member| part(arrays, params, &task, plane, flat_right, member)[side];
            own.iter().filter_map(share).collect::<Vec<_>>()
        });
        let straddles =
            |member: &&Member| member.lower[axis] < position && member.upper[axis] > position;
        let straddlers = own.iter().filter(straddles).count();
        *words_read += 2 * CORNER_WORDS * straddlers as u32;
        // Where nothing is on one side, all parts stay where they are.
        let stay = straddlers == 0 && (left.is_empty() || right.is_empty());
        let room = if stay { 0 } else { left.len() + right.len() };
        if members.len() + room > ROOM || waiting.len() == WAITING {
            return None;
        }
        let first = position_of(position).to_bits();
        let place = piece.put_node(task.parent, Record { first, second: axis as u32 })?;
        let mut child = |side, list: &[Member], parent| {
            let first = if stay && !list.is_empty() { task.first } else { members.len() };
            if !stay {
                members.extend_from_slice(list);
            }
            let node = Node { count: list.len() as u32, ..half(&task.node, plane, side) };
            Task { node, first, parent, depth: task.depth - 1 }
        };
        waiting.push(child(1, &right, Some(place)));
        next = Some(child(0, &left, None));
    }
    Some(())
}

/// One side of a node.
fn half(node: &Node, (axis, position): (usize, u32), side: usize) -> Node {
    let mut half = *node;
    match side {
        0 => half.upper[axis] = position,
        _ => half.lower[axis] = position,
    }
    half
}

/// What a member is in both children.
fn part(
    arrays: &Arrays,
    params: &Params,
    task: &Task,
    plane: (usize, u32),
    flat_right: u32,
    member: &Member,
) -> [Option<Member>; 2] {
    let (axis, position) = plane;
    match (member.lower[axis] < position, member.upper[axis] > position) {
        (true, false) => [Some(*member), None],
        (false, true) => [None, Some(*member)],
        (false, false) if flat_right == FLAT_RIGHT => [None, Some(*member)],
        (false, false) => [Some(*member), None],
        (true, true) => [0, 1].map(|side| {
            let triangle = corners(arrays, member.triangle);
            let child = half(&task.node, plane, side).bounds();
            let cut = if params.clip == 1 { clip } else { overlap };
            cut(&triangle, &child).map(|Aabb { lower, upper }| Member {
                lower: lower.map(ordered),
                upper: upper.map(ordered),
                ..*member
            })
        }),
    }
}
