//! Whole subtrees of nodes with few references, each by one team, depth first.
//!
//! Most nodes of a tree are in small subtrees, and there the kernels of the levels have least to do
//! for what they cost. A team reads a node's events once, keeps the bounds of its parts in the memory
//! that it shares, and writes the finished subtree.

use super::arrays::{Array, Arrays};
use super::data::{Event, NONE, Node};
use super::kernel::{Kernel, Params, Worker, w};
use super::piece::{PIECE, PIECE_HEADER, Piece};
use super::pricing::{is_open, node_cost};
use super::subtree::{self, Member, SMALL};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const FINISH: Kernel = Kernel {
    shader: Shader {
        name: "finish",
        source: include_str!("finish.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Write, Write, Write],
    },
    arrays: &[
        Array::Positions,
        Array::Triangles,
        Array::References,
        Array::Events,
        Array::Nodes,
        Array::Inner,
        Array::NextEvents,
        Array::Moved,
    ],
    // And what teams count themselves.
    moved: |p| Moved { read: w(p.nodes) * 40, written: w(p.nodes) * 4 },
    by: Worker::Team,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Inner, |arrays, inner: &mut [u32]| {
        arrays.write(Array::NextEvents, |arrays, pieces: &mut [u32]| {
            for slot in 0..params.nodes as usize {
                let node = &arrays.of::<Node>(Array::Nodes)[slot];
                let place = (PIECE * node.first) as usize;
                let words = &mut pieces[place..place + (PIECE * node.count) as usize];
                let mut piece = Piece { words, room: node.count, nodes: 0, references: 0 };
                let mut moved = [0; 2];
                let words = words_of(arrays, params, node, (&mut piece, &mut moved));
                inner[params.nodes as usize + slot] = words;
                arrays[Array::Moved][0] += moved[0];
                arrays[Array::Moved][1] += moved[1];
            }
        });
    });
}

/// Words of a part: its triangle, its node, and six events.
const PART_WORDS: u32 = 14;

/// Finishes the subtree of a node. Gives the words of the piece, 0 if that was not to be, or [`NONE`]
/// if the node is a leaf.
fn words_of(
    arrays: &Arrays,
    params: &Params,
    node: &Node,
    (piece, [read, written]): (&mut Piece, &mut [u32; 2]),
) -> u32 {
    if node.count > SMALL || !is_open(node, params, &node_cost(node, params)) {
        return 0;
    }
    *read = PART_WORDS * node.count;
    let members = members(arrays, params, node);
    let finished = subtree::finish(arrays, params, node, members, (piece, read));
    *written = 2 * piece.nodes + piece.references;
    match finished {
        None => 0,
        Some(()) if piece.nodes == 1 => NONE,
        Some(()) => {
            let header = [piece.nodes, piece.references];
            piece.words[..2].copy_from_slice(&header);
            *written += PIECE_HEADER;
            *written
        }
    }
}

/// The parts of a node, from its events.
fn members(arrays: &Arrays, params: &Params, node: &Node) -> Vec<Member> {
    let references = &arrays.references(Array::References)[node.first as usize..];
    let member = |place: u32| Member {
        lower: [0; 3],
        upper: [0; 3],
        triangle: references[place as usize].triangle,
    };
    let mut members: Vec<Member> = (0..node.count).map(member).collect();
    for axis in 0..3 {
        let first = axis as u32 * params.events + 2 * node.first;
        let events: &[Event] = &arrays.of(Array::Events)[first as usize..];
        for event in &events[..2 * node.count as usize] {
            let member = &mut members[event.place() - node.first as usize];
            let bound = if event.is_left() { &mut member.lower } else { &mut member.upper };
            bound[axis] = event.position;
        }
    }
    members
}
