//! The events of a node along an axis, by kind.
//!
//! By kind, because the radix sort that follows knows positions only, and keeps the order of equals.

use kdray::Aabb;
use kdray::build::ordered;

use super::arrays::{Array, Arrays};
use super::data::{NONE, Part, kind};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const ENDS: Kernel = Kernel {
    shader: Shader {
        name: "ends",
        source: include_str!("ends.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Read, Read, Write, Write],
    },
    arrays: &[
        Array::Positions,
        Array::Triangles,
        Array::Bounds,
        Array::References,
        Array::Sums,
        Array::Keys,
        Array::Values,
    ],
    moved: |p| Moved { read: w(p.count) * (SPAN_BYTES + 4), written: w(p.count) * 16 },
    by: Worker::Invocation,
    twin,
};

/// Bytes that a span takes to read along one axis, at most: three vertices and their coordinates.
pub(crate) const SPAN_BYTES: u64 = 24;

fn twin(arrays: &mut Arrays, params: &Params) {
    let all = arrays[Array::References][0];
    arrays.write(Array::Keys, |arrays, keys: &mut [u32]| {
        arrays.write(Array::Values, |arrays, values: &mut [u32]| {
            let flats = &arrays[Array::Sums];
            let flat_count = flats[params.events as usize / 2];
            for reference in 0..all {
                let [lower, upper] = span(arrays, params, reference, params.axis);
                let flats = flats[reference as usize];
                let events = if lower == upper {
                    let enter = (all - flat_count + flats, lower, kind::ENTER);
                    [enter, (all + flats, lower, kind::LEAVE)]
                } else {
                    let end = (reference - flats, upper, kind::END);
                    [end, (all + flat_count + reference - flats, lower, kind::START)]
                };
                for (place, position, kind) in events {
                    keys[place as usize] = position;
                    values[place as usize] = reference << 2 | kind;
                }
            }
            let beyond = 2 * all as usize..2 * params.count as usize;
            keys[beyond.clone()].fill(NONE);
            values[beyond].fill(0);
        });
    });
}

/// Where a reference starts and ends along an axis: by its bounds, or, in the root, whose references
/// are all triangles, by its triangle.
pub(crate) fn span(arrays: &Arrays, params: &Params, reference: u32, axis: u32) -> [u32; 2] {
    let axis = axis as usize;
    if params.has_bounds == 1 {
        let part = &arrays.of::<Part>(Array::Bounds)[reference as usize];
        return [part.lower[axis], part.upper[axis]];
    }
    let bounds = Aabb::of_points(&corners(arrays, reference));
    [bounds.lower[axis], bounds.upper[axis]].map(ordered)
}

/// The corners of a triangle.
pub(crate) fn corners(arrays: &Arrays, triangle: u32) -> [[f32; 3]; 3] {
    let vertices: &[[u32; 3]] = arrays.of(Array::Triangles);
    let positions: &[[f32; 3]] = arrays.of(Array::Positions);
    vertices[triangle as usize].map(|vertex| positions[vertex as usize])
}
