//! Look for the closest point.
//!
//! Bounds from above tell how near it is at most, before any triangle is worked out; what may be as
//! near is kept, and worked out in double precision at the end: that is few triangles, most often
//! those around one vertex.

use super::apart::{Apart, apart};
use super::block::{Block, LANES};
use super::eights::Eights;
use super::near::{NearVisitor, blocks_of};
use super::prepare::lesser;
use super::proximity::rounded_up;
use super::wide::Child;
use crate::geometry::nearest::{Nearest, nearest_on_triangle};

/// The last triangles that were found. Where points are near each other, the closest triangle is
/// hardly nearer than the nearest of these.
#[derive(Default)]
pub(super) struct Seeds {
    block: Option<Block>,
    next: usize,
}

impl Seeds {
    pub(super) fn add(&mut self, triangle: u32, corners: &[[f32; 3]; 3]) {
        let block = self.block.get_or_insert_with(|| Block::of(triangle, corners));
        if block.replace(self.next, triangle, corners) {
            self.next = (self.next + 1) % LANES;
        }
    }
}

/// A triangle that was worked out.
pub(super) struct Found {
    pub(super) triangle: u32,
    pub(super) corners: [[f32; 3]; 3],
    pub(super) nearest: Nearest,
}

/// Triangles that are kept until it is known how near the closest is; if there are more, some are
/// worked out early.
const KEPT: usize = 32;

/// Blocks that are looked at before it is asked which of their triangles may be the closest: no jump
/// depends on a single one.
const ROWS: usize = 8;

/// Looks for the closest point.
pub(super) struct Search<'a> {
    point: [f32; 3],
    seeds: Option<&'a Block>,
    best: Option<Found>,
    /// The squared distance of the best, or up to which it may be.
    limit: f64,
    /// The closest point is not farther, squared.
    until: f32,
    kept: [Kept<'a>; KEPT],
    count: usize,
}

/// A triangle that may be the closest, and how far it is at least, squared.
#[derive(Clone, Copy)]
struct Kept<'a> {
    triangle: u32,
    least: f32,
    /// Where its corners are.
    place: Option<(&'a Block, usize)>,
}

impl<'a> NearVisitor<'a> for Search<'a> {
    #[inline(always)]
    fn start<E: Eights>(&mut self, point: &[E; 3]) -> f32 {
        if let Some(seeds) = self.seeds {
            self.shorten(apart(seeds, point).most);
        }
        self.until
    }

    fn is_far(&self) -> bool {
        self.seeds.is_none()
    }

    #[inline(always)]
    fn leaves<E: Eights>(&mut self, blocks: &'a [Block], leaves: &[Child], point: &[E; 3]) -> f32 {
        let mut nearest = point[0].all(self.until);
        let mut rows = [(nearest, &blocks[0]); ROWS];
        let mut count = 0;
        for leaf in leaves {
            for block in blocks_of(blocks, *leaf) {
                let Apart { least, most } = apart(block, point);
                nearest = most.min(nearest);
                rows[count] = (least, block);
                count += 1;
                if count == ROWS {
                    self.sift(&rows, nearest);
                    count = 0;
                }
            }
        }
        self.sift(&rows[..count], nearest);
        self.until
    }
}

impl<'a> Search<'a> {
    pub(super) fn new(point: [f32; 3], limit: f64, seeds: &'a Seeds) -> Self {
        let kept = [Kept { triangle: 0, least: 0.0, place: None }; KEPT];
        let (seeds, until) = (seeds.block.as_ref(), rounded_up(limit));
        Self { point, seeds, best: None, limit, until, kept, count: 0 }
    }

    pub(super) fn end(mut self) -> Option<Found> {
        self.work_out();
        self.best
    }

    /// Triangles are this near, squared.
    #[inline(always)]
    fn shorten<E: Eights>(&mut self, most: E) {
        if most.is_less(most.all(self.until)) != 0 {
            self.until = most.numbers().into_iter().fold(self.until, |a, b| lesser(b, a));
        }
    }

    /// Keeps the triangles of blocks, each with how far they are at least, that may be the closest
    /// if some are as near as `nearest`.
    #[inline(always)]
    fn sift<E: Eights>(&mut self, rows: &[(E, &'a Block)], nearest: E) {
        self.shorten(nearest);
        for (least, block) in rows {
            let mut near = least.is_at_most(least.all(self.until));
            if near != 0 {
                let least = least.numbers();
                while near != 0 {
                    let lane = near.trailing_zeros() as usize & (LANES - 1);
                    near &= near - 1;
                    self.keep(block, lane, least[lane]);
                }
            }
        }
    }

    /// Keeps a triangle, which may be in several leaves, once.
    #[inline(always)]
    fn keep(&mut self, block: &'a Block, lane: usize, least: f32) {
        let triangle = block.index(lane);
        if self.kept[..self.count].iter().any(|kept| kept.triangle == triangle) {
            return;
        }
        if self.count == KEPT {
            self.work_out();
        }
        self.kept[self.count] = Kept { triangle, least, place: Some((block, lane)) };
        self.count += 1;
    }

    /// Works out those that were kept and may still be the closest.
    fn work_out(&mut self) {
        for index in 0..self.count {
            let Kept { least, place, .. } = self.kept[index];
            if let Some((block, lane)) = place
                && least <= self.until
            {
                self.look(block.triangle(lane));
            }
        }
        self.count = 0;
    }

    #[inline]
    fn look(&mut self, (triangle, corners): (u32, [[f32; 3]; 3])) {
        let best = self.best.as_ref().map(|best| best.triangle);
        if best == Some(triangle) {
            return;
        }
        let nearest = nearest_on_triangle(self.point, &corners);
        let tie = || best.is_none_or(|best| triangle < best);
        let distance = nearest.squared_distance;
        if distance < self.limit || distance == self.limit && tie() {
            self.limit = distance;
            self.until = lesser(self.until, rounded_up(distance));
            self.best = Some(Found { triangle, corners, nearest });
        }
    }
}
