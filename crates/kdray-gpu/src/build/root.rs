//! The references of the root, which are all triangles, and their events along an axis, by kind.
//!
//! By kind, because the radix sort that follows knows positions only, and keeps the order of equals.

use kdray::Aabb;
use kdray::build::ordered;

use super::arrays::{Array, Arrays};
use super::data::{HEADER, kind};
use super::kernel::{Kernel, Params, Worker, w};
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Kernel as Shader, Moved};

pub(crate) const ROOT: Kernel = Kernel {
    shader: Shader {
        name: "root",
        source: include_str!("root.wgsl"),
        bindings: &[Uniform, Read, Read, Read, Write, Write, Write],
    },
    arrays: &[
        Array::Positions,
        Array::Triangles,
        Array::Sums,
        Array::NextReferences,
        Array::Keys,
        Array::Values,
    ],
    moved: |p| Moved { read: w(p.triangles) * 28, written: w(p.triangles) * 24 },
    by: Worker::Invocation,
    twin,
};

fn twin(arrays: &mut Arrays, params: &Params) {
    let all = params.triangles;
    arrays.write(Array::NextReferences, |_, words: &mut [u32]| {
        words[..HEADER].fill(all);
        for triangle in 0..all {
            words[HEADER + 2 * triangle as usize..][..2].copy_from_slice(&[triangle, 0]);
        }
    });
    arrays.write(Array::Keys, |arrays, keys: &mut [u32]| {
        arrays.write(Array::Values, |arrays, values: &mut [u32]| {
            let flats = &arrays[Array::Sums];
            let flat_count = flats[all as usize];
            for triangle in 0..all {
                let [lower, upper] = span(arrays, triangle, params.axis);
                let flats = flats[triangle as usize];
                let events = if lower == upper {
                    let enter = (all - flat_count + flats, lower, kind::ENTER);
                    [enter, (all + flats, lower, kind::LEAVE)]
                } else {
                    let end = (triangle - flats, upper, kind::END);
                    [end, (all + flat_count + triangle - flats, lower, kind::START)]
                };
                for (place, position, kind) in events {
                    keys[place as usize] = position;
                    values[place as usize] = triangle << 2 | kind;
                }
            }
        });
    });
}

/// Where a triangle starts and ends along an axis.
pub(crate) fn span(arrays: &Arrays, triangle: u32, axis: u32) -> [u32; 2] {
    let bounds = Aabb::of_points(&corners(arrays, triangle));
    [bounds.lower[axis as usize], bounds.upper[axis as usize]].map(ordered)
}

/// The corners of a triangle.
pub(crate) fn corners(arrays: &Arrays, triangle: u32) -> [[f32; 3]; 3] {
    let vertices: &[[u32; 3]] = arrays.of(Array::Triangles);
    let positions: &[[f32; 3]] = arrays.of(Array::Positions);
    vertices[triangle as usize].map(|vertex| positions[vertex as usize])
}
