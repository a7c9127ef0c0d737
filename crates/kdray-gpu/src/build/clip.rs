//! The bounds of straddlers' parts on both sides: the clip recipe of the tree's definition.

use kdray::build::{ordered, position_of};
use kdray::geometry::{clip, overlap};

use super::arrays::{Array, Arrays};
use super::data::{NONE, Node, Part, Plan};
use super::ends::corners;
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const CLIP: Kernel = Kernel {
    shader: Shader {
        name: "clip",
        source: include_str!("clip.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Write, Write],
    },
    arrays: &[
        Array::Positions,
        Array::Triangles,
        Array::References,
        Array::Nodes,
        Array::Plans,
        Array::Straddlers,
        Array::Parts,
        Array::Exists,
    ],
    moved: |p| Moved { read: w(p.straddlers) * 112, written: w(p.straddlers) * 56 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    let straddlers = params.straddlers as usize;
    arrays.write(Array::Parts, |arrays, parts: &mut [Part]| {
        arrays.write(Array::Exists, |arrays, exists: &mut [u32]| {
            for straddler in 0..straddlers {
                for (side, part) in parts_of(arrays, params, straddler).into_iter().enumerate() {
                    parts[2 * straddler + side] = part;
                    exists[side * straddlers + straddler] = u32::from(part != NO_PART);
                }
            }
            exists[2 * straddlers] = 0;
        });
    });
}

const NO_PART: Part = Part { lower: [NONE; 3], upper: [NONE; 3] };

/// A straddler's part in the left and in the right child.
fn parts_of(arrays: &Arrays, params: &Params, straddler: usize) -> [Part; 2] {
    let place = arrays[Array::Straddlers][straddler] as usize;
    let reference = arrays.references(Array::References)[place];
    let triangle = corners(arrays, reference.triangle);
    let node: &Node = &arrays.of(Array::Nodes)[reference.slot as usize];
    let plan: &Plan = &arrays.of(Array::Plans)[reference.slot as usize];
    node.bounds().cut(plan.axis(), position_of(plan.position)).map(|child| {
        let part =
            if params.clip == 1 { clip(&triangle, &child) } else { overlap(&triangle, &child) };
        part.map_or(NO_PART, |part| Part {
            lower: part.lower.map(ordered),
            upper: part.upper.map(ordered),
        })
    })
}
