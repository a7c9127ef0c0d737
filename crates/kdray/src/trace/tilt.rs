//! Second boxes for the children of wide nodes, along the surface.
//!
//! A box along the axes around a slanted piece of surface is mostly empty, and its nearest corner
//! much nearer than the surface. So a wide node with little below it has a frame of its own, with
//! one axis across the triangles there, and each child a second box in that frame. A child is as far
//! away as the farther of its boxes.

use super::block::Block;
use super::eights::{Array, Eights, by_axis};
use super::wide::{Child, Layout};
use crate::geometry::vector::{Vector, cross, dot};
use crate::memory::with_huge_pages;

/// The frame of a wide node, and its children's boxes in it.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Tilt {
    /// By end, axis and child. Of children without a box they are as large as can be.
    bounds: [[[f32; 8]; 3]; 2],
    /// Unit vectors, perpendicular to each other but for roundings.
    axes: [[f32; 3]; 3],
    center: [f32; 3],
}

/// Children with more blocks of triangles than that have no second box: their surface is not flat.
const LARGEST: usize = 16;

const HALF_ULP: f32 = 0.5 * f32::EPSILON;

/// A coordinate in the frame is off by at most four half ulps of the distance from the center, and
/// by twice that if the distance is itself known by coordinates only.
const ROUNDING: f32 = 16.0 * HALF_ULP;

impl Tilt {
    const NONE: Self = Self {
        bounds: [[[f32::NEG_INFINITY; 8]; 3], [[f32::INFINITY; 8]; 3]],
        axes: [[0.0; 3]; 3],
        center: [0.0; 3],
    };

    /// Squared distances of the second boxes from a point, at least, but for fourteen half ulps:
    /// six for the axes, which are rounded, and eight for the sums and squares here.
    #[inline(always)]
    pub(super) fn squared<E: Eights>(&self, point: &[E; 3]) -> E {
        let all = |number: f32| point[0].all(number);
        let way = by_axis!(|axis| point[axis] - all(self.center[axis]));
        let size = way[0].magnitude() + way[1].magnitude() + way[2].magnitude();
        let rounding = size * all(ROUNDING);
        let [lower, upper] = &self.bounds;
        let mut squared = all(0.0);
        for axis in 0..3 {
            let [x, y, z] = self.axes[axis].map(all);
            let place = x.fused(way[0], y.fused(way[1], z * way[2]));
            let below = squared.load(&lower[axis]) - place;
            let above = place - squared.load(&upper[axis]);
            let outside = (below.max(above) - rounding).max(all(0.0));
            squared = outside.fused(outside, squared);
        }
        squared
    }
}

/// The second boxes of all wide nodes.
pub(super) fn tilts(layout: &Layout) -> Vec<Tilt> {
    let mut tilts = with_huge_pages(layout.wides.len());
    tilts.resize(layout.wides.len(), Tilt::NONE);
    tilt(layout, Child(0), 0, &mut tilts);
    tilts
}

/// Fills in the second boxes of the subtree whose blocks start at `start`; gives where they end.
fn tilt(layout: &Layout, child: Child, start: usize, tilts: &mut [Tilt]) -> usize {
    let Some(first) = child.block() else {
        let wide = &layout.wides[child.0 as usize];
        let mut ends = [start; 9];
        for place in 0..8 {
            let is_free = wide.bounds[0][0][place] > wide.bounds[1][0][place];
            let end = ends[place];
            ends[place + 1] =
                if is_free { end } else { tilt(layout, wide.children[place], end, tilts) };
        }
        let middle = |axis: usize| {
            let of = |end: usize| wide.bounds[end][axis].iter().copied();
            let lower = of(0).fold(f32::INFINITY, f32::min);
            let upper = of(1).fold(f32::NEG_INFINITY, f32::max);
            0.5 * lower + 0.5 * upper
        };
        let center = [middle(0), middle(1), middle(2)];
        tilts[child.0 as usize] = Tilt::new(center, &ends, &layout.blocks);
        return ends[8];
    };
    // Blocks between are of leaves with nothing in their cells: this box holds them too.
    debug_assert!(start <= first, "blocks are in depth-first order");
    if child.is_one() {
        return first + 1;
    }
    let last = layout.blocks[first..].iter().position(Block::is_last);
    first + last.expect("leaves end") + 1
}

impl Tilt {
    /// `ends` says between which blocks each child is.
    fn new(center: [f32; 3], ends: &[usize; 9], blocks: &[Block]) -> Self {
        let of = |place: usize| {
            let blocks = &blocks[ends[place]..ends[place + 1]];
            if blocks.len() > LARGEST { &[] } else { blocks }
        };
        let none = [Array([0.0; 8]); 3];
        let normals = (0..8).fold(none, |sums, place| add_normals(sums, of(place)));
        let axes = frame(sum_of_lanes(&normals));
        let mut tilt = Self { center, axes, ..Self::NONE };
        for place in (0..8).filter(|place| !of(*place).is_empty()) {
            let extent = tilt.extent(of(place));
            for (end, axis) in [0, 1].into_iter().flat_map(|end| [0, 1, 2].map(|axis| (end, axis)))
            {
                tilt.bounds[end][axis][place] = extent[end][axis];
            }
        }
        tilt
    }

    /// From where to where blocks reach in the frame.
    fn extent(&self, blocks: &[Block]) -> [[f32; 3]; 2] {
        let zero = Array([0.0; 8]);
        let mut lower = [zero.all(f32::INFINITY); 3];
        let mut upper = [zero.all(f32::NEG_INFINITY); 3];
        let mut size = zero;
        for corner in blocks.iter().flat_map(Block::filled_corners) {
            let way = by_axis!(|axis| Array(corner[axis]) - zero.all(self.center[axis]));
            for axis in 0..3 {
                let [x, y, z] = self.axes[axis].map(|number| zero.all(number));
                let place = x * way[0] + y * way[1] + z * way[2];
                lower[axis] = lower[axis].min(place);
                upper[axis] = upper[axis].max(place);
            }
            size = size.max(way[0].magnitude() + way[1].magnitude() + way[2].magnitude());
        }
        let rounding = ROUNDING * size.0.into_iter().fold(0.0, f32::max);
        let least = |numbers: Array| numbers.0.into_iter().fold(f32::INFINITY, f32::min);
        let most = |numbers: Array| numbers.0.into_iter().fold(f32::NEG_INFINITY, f32::max);
        let lower = lower.map(|numbers| least(numbers) - rounding);
        let upper = upper.map(|numbers| most(numbers) + rounding);
        // Of numbers out of range nothing is known.
        let is_known = size.0.into_iter().all(f32::is_finite);
        if is_known { [lower, upper] } else { [[f32::NEG_INFINITY; 3], [f32::INFINITY; 3]] }
    }
}

/// Sums of normals as long as areas, lane by lane, each turned to the side of those before.
fn add_normals(mut sums: [Array; 3], blocks: &[Block]) -> [Array; 3] {
    let zero = Array([0.0; 8]);
    for [a, b, c] in blocks.iter().map(Block::filled_corners) {
        let ab = by_axis!(|axis| Array(b[axis]) - Array(a[axis]));
        let ac = by_axis!(|axis| Array(c[axis]) - Array(a[axis]));
        let [x, y, z] = [ab[1] * ac[2], ab[2] * ac[0], ab[0] * ac[1]];
        let across = [x - ab[2] * ac[1], y - ab[0] * ac[2], z - ab[1] * ac[0]];
        let along = across[0] * sums[0] + across[1] * sums[1] + across[2] * sums[2];
        let turned = by_axis!(|axis| along.pick(zero, zero - across[axis], across[axis]));
        sums = by_axis!(|axis| sums[axis] + turned[axis]);
    }
    sums
}

/// The sum of the lanes, each turned to the side of those before.
fn sum_of_lanes(sums: &[Array; 3]) -> Vector {
    (0..8).fold([0.0; 3], |sum, lane| {
        let other = by_axis!(|axis| f64::from(sums[axis].0[lane]));
        let side = if dot(other, sum) < 0.0 { -1.0 } else { 1.0 };
        by_axis!(|axis| sum[axis] + side * other[axis])
    })
}

/// Unit vectors, the first along `normal` and the others across it.
fn frame(normal: Vector) -> [[f32; 3]; 3] {
    let unit = |vector: Vector| {
        let length = dot(vector, vector).sqrt();
        vector.map(|component| component / length)
    };
    let normal = unit(normal);
    // Perpendicular to the axis that the normal is farthest from.
    let least = |a: usize, b: usize| if normal[b].abs() < normal[a].abs() { b } else { a };
    let mut axis = [0.0; 3];
    axis[least(least(0, 1), 2)] = 1.0;
    let side = unit(cross(normal, axis));
    let axes = [normal, side, cross(normal, side)];
    let is_sound = axes.iter().flatten().all(|component| component.is_finite());
    if !is_sound {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    axes.map(|axis| axis.map(|component| component as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::geometry::nearest::nearest_on_triangle;
    use crate::trace::noise::noise;
    use crate::{BuildOptions, Tree};

    /// Bumps on a slope, and points around it, some of them on it.
    fn slope() -> (Mesh, Vec<[f32; 3]>) {
        let mut state = 11;
        let place = |x: u32, z: u32| {
            let [x, z] = [x as f32, z as f32];
            [x, 0.7 * x - 0.4 * z + 0.3 * (1.7 * x).sin() * (1.3 * z).cos(), z]
        };
        let all = (0..40).flat_map(|x| (0..40).map(move |z| (x, z)));
        let positions: Vec<_> = all.clone().map(|(x, z)| place(x, z)).collect();
        let quads = all.filter(|(x, z)| *x < 39 && *z < 39).map(|(x, z)| 40 * x + z);
        let triangles: Vec<_> =
            quads.flat_map(|at| [[at, at + 1, at + 40], [at + 41, at + 40, at + 1]]).collect();
        let mut any = || 60.0 * noise(&mut state) - 10.0;
        let points = (0..300).map(|_| [any(), any(), any()]).chain(positions[..300].to_vec());
        (Mesh::new(&positions, &triangles).expect("sound"), points.collect())
    }

    /// No triangle is nearer than its box, and many boxes are farther than those along the axes.
    #[test]
    fn boxes_are_no_farther_than_what_is_in_them() {
        let (mesh, points) = slope();
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let layout = Layout::new(&mesh, &tree);
        let mut farther = 0;
        for (wide, tilt) in layout.wides.iter().zip(tilts(&layout)) {
            for point in &points {
                let squared = tilt.squared(&point.map(|number| Array([number; 8]))).0;
                for place in 0..8 {
                    let Some(first) = wide.children[place].block() else { continue };
                    let blocks = layout.blocks_of(wide.children[place], first);
                    let of =
                        |block: &Block| block.places().map(|lane| block.triangle(lane).1).collect();
                    let corners = blocks.iter().flat_map::<Vec<_>, _>(of);
                    let distances =
                        corners.map(|it| nearest_on_triangle(*point, &it).squared_distance);
                    let nearest = distances.fold(f64::INFINITY, f64::min);
                    assert!(f64::from(squared[place]) <= nearest * (1.0 + 1e-6), "{point:?}");
                    farther += usize::from(f64::from(squared[place]) > 0.8 * nearest);
                }
            }
        }
        assert!(farther > 10_000, "only {farther} boxes say much");
    }

    #[test]
    fn without_a_normal_the_frame_is_that_of_the_axes() {
        for normal in [[0.0; 3], [f64::NAN; 3], [f64::INFINITY, 0.0, 0.0]] {
            assert_eq!(frame(normal), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        }
    }
}
