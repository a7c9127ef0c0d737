//! Inside and outside, cell by cell.
//!
//! Where no surface is, inside and outside do not change. So the box of the mesh is cut into cells,
//! and those that no triangle reaches into are inside or outside as a whole: a point in one of them
//! need not ask a ray. The answer is the very one that its ray would give:
//!
//! * The ray is the [way out](crate::Tracer::way_out), and its answer the parity of what it
//!   crosses. While its origin moves through a cell without a surface, this changes only where the
//!   ray passes an edge of an odd number of triangles, for at every other edge as many crossings
//!   come as go, or an even number at once. So a cell whose ways out pass such an edge is not taken
//!   for a whole either.
//! * Cells count as larger than they are by [`MARGIN`]. That is more than a ray, a point, a corner
//!   or a crossing is moved by any rounding, here and in the tests of triangles.
//! * A crossing of the line through the middle of a column is on the same side of a cell without a
//!   surface as those of all its rays. So one ray a column tells for all its cells.

mod outline;
mod space;
mod sweep;

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::block::Block;
use super::lists::first_hits;
use super::traverse::Trip;
use crate::geometry::{Aabb, Hit, Ray};
use outline::odd_edges;
use space::Space;
use sweep::{cells, columns};

/// How much larger than it is a cell counts on every side, in units of a cell.
const MARGIN: f64 = 1.0 / 64.0;

/// How many columns may be visited a triangle, on average, to see which cells triangles reach into.
/// If it were more, cells are made larger.
const VISITS: f64 = 8.0;

/// Two bits a cell, of which the first says that a surface may be in it, and the second that it is
/// inside.
pub(super) struct Grid {
    space: Space,
    cells: Vec<AtomicU64>,
}

const INSIDE: u64 = 0b01;
const MIXED: u64 = 0b10;

/// Cells in a word.
const IN_WORD: usize = 32;

/// A one for every cell of a word.
const ONES: u64 = 0x5555_5555_5555_5555;

impl Grid {
    /// The grid of the triangles of a layout, so many of them and in a box, whose ways out go
    /// `along` an axis. `None` where there is no room for cells.
    pub(super) fn new(trip: &Trip, bounds: Aabb, along: usize, triangles: usize) -> Option<Self> {
        let triangles = Triangles::new(&trip.layout.blocks, triangles);
        let space = Space::new(bounds, along, triangles.0.len())?;
        let space = triangles.in_few_columns(space)?;
        let words = space.len().div_ceil(IN_WORD);
        let grid = Self { space, cells: (0..words).map(|_| AtomicU64::new(0)).collect() };
        grid.mark_surface(&triangles);
        grid.mark_outline(&triangles);
        grid.fill(trip);
        Some(grid)
    }

    /// Whether a point of the box is inside, if its cell tells.
    #[inline]
    pub(super) fn look(&self, point: &[f32; 3]) -> Option<bool> {
        let cell = self.space.cell(point);
        let state = self.cells[cell / IN_WORD].load(Relaxed) >> (2 * (cell % IN_WORD));
        (state & MIXED == 0).then_some(state & INSIDE != 0)
    }

    pub(super) fn size_bytes(&self) -> usize {
        size_of_val(&self.cells[..])
    }

    /// Marks the cells that triangles reach into.
    fn mark_surface(&self, triangles: &Triangles) {
        let Space { counts, .. } = self.space;
        let height = self.space.height();
        triangles.0.par_iter().with_min_len(1024).for_each(|corners| {
            let corners = corners.map(|corner| self.space.place(&corner));
            columns(&corners, counts, |column, [from, to]| {
                self.mark(column, false, [from, to]);
                self.mark(column, true, [height - to, height - from]);
            });
        });
    }

    /// Marks the cells whose ways out pass edges of an odd number of triangles.
    fn mark_outline(&self, triangles: &Triangles) {
        let Space { counts, .. } = self.space;
        let height = self.space.height();
        for [from, to] in odd_edges(&triangles.0) {
            let edge = [from, to, to].map(|end| self.space.place(&end));
            columns(&edge, counts, |column, [lowest, highest]| {
                self.mark(column, false, [lowest, f64::INFINITY]);
                self.mark(column, true, [height - highest, f64::INFINITY]);
            });
        }
    }

    /// Marks cells of half a column, between distances from where it ends.
    fn mark(&self, column: [usize; 2], is_above: bool, range: [f64; 2]) {
        let marked = cells(range, self.space.counts[2]);
        let first = self.space.column(column, is_above);
        self.set(first + marked.start()..first + marked.end() + 1, MIXED);
    }

    /// Says of the cells of all columns whether they are inside, those with a surface too.
    fn fill(&self, trip: &Trip) {
        let [rows, of_row, _] = self.space.counts;
        (0..rows).into_par_iter().for_each(|x| {
            let ray = |y| {
                let (origin, along) = self.space.foot([x, y]);
                let mut direction = [0.0; 3];
                direction[along] = 1.0;
                Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, direction) }
            };
            let rays: Vec<Ray> = (0..of_row).map(ray).collect();
            let (all, mut room) = (|_: usize| |_: u32| true, Vec::new());
            first_hits(trip, &rays, usize::MAX, all, &mut room, |y, hits| {
                self.fill_column([x, y], hits);
            });
        });
    }

    /// By what is crossed from the foot of a column to its top.
    fn fill_column(&self, column: [usize; 2], hits: &[Hit]) {
        let height = self.space.height();
        let mut crossed: Vec<f64> = hits.iter().map(|hit| self.space.rise(hit.t)).collect();
        self.fill_half(column, false, &crossed);
        crossed.reverse();
        crossed.iter_mut().for_each(|place| *place = height - *place);
        self.fill_half(column, true, &crossed);
    }

    /// By what is crossed from where half a column ends, onward.
    fn fill_half(&self, column: [usize; 2], is_above: bool, crossed: &[f64]) {
        let count = self.space.counts[2];
        let first = self.space.column(column, is_above);
        // Cells whose middles are beyond it.
        let beyond = |place: f64| (place + 0.5).floor().clamp(0.0, count as f64) as usize;
        for pair in crossed.chunks(2) {
            let end = pair.get(1).map_or(count, |place| beyond(*place));
            self.set(first + beyond(pair[0])..first + end, INSIDE);
        }
    }

    /// Sets a bit of some cells.
    fn set(&self, range: Range<usize>, bit: u64) {
        let mut start = range.start;
        while start < range.end {
            let word = start / IN_WORD;
            let end = range.end.min(IN_WORD * (word + 1));
            let ones = ONES >> (2 * (IN_WORD - (end - start))) << (2 * (start % IN_WORD));
            let bits = ones * bit;
            // Most are set already, and looking costs less.
            if self.cells[word].load(Relaxed) & bits != bits {
                self.cells[word].fetch_or(bits, Relaxed);
            }
            start = end;
        }
    }
}

/// The corners of the triangles of a layout, each once.
struct Triangles(Vec<[[f32; 3]; 3]>);

impl Triangles {
    fn new(blocks: &[Block], count: usize) -> Self {
        let mut corners = vec![[[0.0; 3]; 3]; count];
        for block in blocks {
            for (triangle, of) in block.places().map(|lane| block.triangle(lane)) {
                corners[triangle as usize] = of;
            }
        }
        Self(corners)
    }

    /// Cells so large that triangles are in few columns each.
    fn in_few_columns(&self, space: Space) -> Option<Space> {
        // Of all triangles together: the areas of their boxes in columns, and half the girths.
        let size = |corners: &[[f32; 3]; 3]| {
            let corners = corners.map(|corner| space.place(&corner));
            let [x, y] = [0, 1].map(|axis| {
                let along = corners.map(|corner| corner[axis]);
                along.into_iter().fold(f64::NEG_INFINITY, f64::max)
                    - along.into_iter().fold(f64::INFINITY, f64::min)
            });
            [x * y, x + y]
        };
        let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        let [area, girth] = self.0.par_iter().map(size).reduce(|| [0.0; 2], add);
        let (mut wanted, mut scale) = (space, 1.0);
        while area * scale * scale + girth * scale > VISITS * self.0.len() as f64 {
            (wanted, scale) = (wanted.coarser()?, 0.5 * scale);
            if wanted.counts == [1; 3] {
                return None;
            }
        }
        Some(wanted)
    }
}

#[cfg(test)]
mod tests;
