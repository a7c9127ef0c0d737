//! Nodes and leaf references in depth-first order: the finished tree.

use super::arrays::{Array, Arrays};
use super::data::{Extent, NONE, Record};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const PACK: Kernel = Kernel {
    shader: Shader {
        name: "pack",
        source: include_str!("pack.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write, Write],
    },
    arrays: &[
        Array::Records,
        Array::Extents,
        Array::Finished,
        Array::TreeNodes,
        Array::TreeReferences,
    ],
    moved: |p| Moved {
        read: w(p.count) * 24 + w(p.finished) * 4,
        written: w(p.count) * 8 + w(p.finished) * 4,
    },
    by: Worker::Team,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    arrays.write(Array::TreeNodes, |arrays, nodes: &mut [Record]| {
        arrays.write(Array::TreeReferences, |arrays, references: &mut [u32]| {
            let extents: &[Extent] = arrays.of(Array::Extents);
            let finished = &arrays[Array::Finished];
            for index in 0..params.count as usize {
                let record = arrays.of::<Record>(Array::Records)[index];
                let before = extents[index];
                let nodes = &mut nodes[before.nodes as usize..];
                let references = &mut references[before.references as usize..];
                if let Some(children) = record.children() {
                    let right = extents[children + 1].nodes;
                    nodes[0] = Record { second: right << 2 | record.second & 3, ..record };
                } else if record.second == NONE {
                    pack_piece(&finished[record.first as usize..], before, nodes, references);
                } else {
                    nodes[0] = Record { first: before.references, ..record };
                    let (from, count) = (record.first as usize, record.second as usize >> 2);
                    references[..count].copy_from_slice(&finished[from..from + count]);
                }
            }
        });
    });
}

/// A subtree's nodes name each other and their references as if it were the whole tree.
fn pack_piece(piece: &[u32], before: Extent, nodes: &mut [Record], references: &mut [u32]) {
    let (header, piece) = piece.split_at(2);
    let (words, piece) = piece.split_at(2 * header[0] as usize);
    for (node, words) in nodes.iter_mut().zip(words.chunks_exact(2)) {
        *node = Record { first: words[0], second: words[1] };
        if node.children().is_some() {
            node.second += before.nodes << 2;
        } else {
            node.first += before.references;
        }
    }
    let count = header[1] as usize;
    references[..count].copy_from_slice(&piece[..count]);
}
