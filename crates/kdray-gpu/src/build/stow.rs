//! Moves the pieces to where they stay until the tree is packed.

use super::arrays::{Array, Arrays};
use super::data::{FINISHED, Node, Plan};
use super::kernel::{Kernel, Params, Worker, w};
use super::piece::{PIECE, PIECE_HEADER, references_at};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const STOW: Kernel = Kernel {
    shader: Shader {
        name: "stow",
        source: include_str!("stow.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write, Write],
    },
    arrays: &[Array::Nodes, Array::Inner, Array::NextEvents, Array::Plans, Array::Finished],
    moved: |p| Moved {
        read: w(p.nodes) * 20 + w(p.piece_words) * 4,
        written: w(p.nodes) * 4 + w(p.piece_words) * 4,
    },
    by: Worker::Team,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::Plans, |arrays, plans: &mut [Plan]| {
        arrays.write(Array::Finished, |arrays, finished: &mut [u32]| {
            let before = &arrays[Array::Inner][params.nodes as usize..];
            let plans = plans[..params.nodes as usize].iter_mut().enumerate();
            for (slot, plan) in plans.filter(|(_, plan)| plan.what == FINISHED) {
                let node = &arrays.of::<Node>(Array::Nodes)[slot];
                plan.place = params.finished + params.leaf + before[slot] - before[0];
                let piece = &arrays[Array::NextEvents][(PIECE * node.first) as usize..];
                let words = (PIECE_HEADER + 2 * piece[0]) as usize;
                let references = &piece[references_at(node.count) as usize..];
                let (nodes, rest) = finished[plan.place as usize..].split_at_mut(words);
                nodes.copy_from_slice(&piece[..words]);
                rest[..piece[1] as usize].copy_from_slice(&references[..piece[1] as usize]);
            }
        });
    });
}
