//! Which triangles of a leaf make a block.
//!
//! A leaf of more triangles than a block holds is halved, and its halves, so that the boxes of its
//! blocks are small: a ray that meets the leaf passes by most of them.

use smallvec::SmallVec;

use crate::geometry::Aabb;
use crate::geometry::ordered::ordered;
use crate::trace::block::LANES;

/// Leaves of more triangles keep their order. No wide node holds as many blocks.
const MOST: usize = 8 * LANES;

/// A triangle, and what is in the leaf of it.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) triangle: u32,
    pub(super) bounds: Aabb,
}

/// Brings parts in the order of their blocks, all of which are full where that is possible. Gives the
/// number of parts of each block to `block`.
pub(super) fn bunch(parts: &mut [Part], block: &mut impl FnMut(&[Part])) {
    if parts.len() > MOST {
        parts.chunks(LANES).for_each(block);
    } else if parts.len() <= LANES {
        parts.sort_unstable_by_key(|part| part.triangle);
        block(parts);
    } else {
        let left = halve(parts);
        let (left, right) = parts.split_at_mut(left);
        bunch(left, block);
        bunch(right, block);
    }
}

/// Orders parts so that the first of them, as many as are given back, and the others are best apart:
/// of the ways with the fewest blocks, the one whose boxes are met least.
fn halve(parts: &mut [Part]) -> usize {
    let mut orders = [[0; MOST]; 3];
    let (mut best, mut best_cost) = ((0, 1), f32::INFINITY);
    for (axis, order) in orders.iter_mut().enumerate() {
        let order = &mut order[..parts.len()];
        sort(parts, axis, order);
        let (left, cost) = cut(parts, order);
        if cost < best_cost {
            (best, best_cost) = ((axis, left), cost);
        }
    }
    let order = &orders[best.0][..parts.len()];
    let ordered: SmallVec<[Part; MOST]> =
        order.iter().map(|keyed| parts[place_of(*keyed)]).collect();
    parts.copy_from_slice(&ordered);
    best.1
}

/// Of an order, how many parts are best to the left, and the cost.
fn cut(parts: &[Part], order: &[u64]) -> (usize, f32) {
    let count = parts.len();
    // How many blocks each side fills, if they are as few as can be.
    let blocks = |left: usize| {
        let [of_left, of_right] = [left, count - left].map(|count| count.div_ceil(LANES));
        (of_left + of_right == count.div_ceil(LANES)).then_some([of_left as f32, of_right as f32])
    };
    let (mut all, mut below) = (Aabb::EMPTY, [0.0; MOST]);
    for (at, keyed) in order.iter().enumerate() {
        all = all.union(&parts[place_of(*keyed)].bounds);
        if blocks(at + 1).is_some() {
            below[at] = all.half_area() as f32;
        }
    }
    all = Aabb::EMPTY;
    let mut best = (1, f32::INFINITY);
    for left in (1..count).rev() {
        all = all.union(&parts[place_of(order[left])].bounds);
        if let Some([of_left, of_right]) = blocks(left) {
            let cost = below[left - 1] * of_left + all.half_area() as f32 * of_right;
            best = if cost < best.1 { (left, cost) } else { best };
        }
    }
    best
}

/// Places of parts in the order of their middles, below keys that are ordered in the same way.
fn sort(parts: &[Part], axis: usize, order: &mut [u64]) {
    for (place, (part, keyed)) in parts.iter().zip(&mut *order).enumerate() {
        let key = ordered(part.bounds.lower[axis] + part.bounds.upper[axis]);
        *keyed = u64::from(key) << 32 | place as u64;
    }
    order.sort_unstable();
}

fn place_of(keyed: u64) -> usize {
    keyed as u32 as usize & (MOST - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::noise::noise;

    fn parts(count: usize, state: &mut u32) -> Vec<Part> {
        let part = |triangle| {
            let corner = [(); 3].map(|()| 10.0 * noise(state));
            let size = noise(state);
            let bounds = Aabb { lower: corner, upper: corner.map(|at| at + size) };
            Part { triangle, bounds }
        };
        (0..count as u32).map(part).collect()
    }

    #[test]
    fn blocks_are_as_few_as_can_be_and_hold_every_part_once() {
        let mut state = 3;
        for count in 1..150 {
            let mut parts = parts(count, &mut state);
            let (mut blocks, mut seen) = (0, Vec::new());
            bunch(&mut parts, &mut |block| {
                assert!((1..=LANES).contains(&block.len()), "{} of {count}", block.len());
                blocks += 1;
                seen.extend(block.iter().map(|part| part.triangle));
            });
            assert_eq!(blocks, count.div_ceil(LANES), "of {count}");
            seen.sort_unstable();
            assert_eq!(seen, (0..count as u32).collect::<Vec<_>>());
        }
    }

    #[test]
    fn parts_that_lie_apart_are_in_blocks_apart() {
        let mut parts = parts(12, &mut 5);
        for (at, part) in parts.iter_mut().enumerate().filter(|(at, _)| at % 2 == 0) {
            part.bounds.lower[1] += 100.0 + at as f32;
            part.bounds.upper[1] += 100.0 + at as f32;
        }
        let mut blocks = Vec::new();
        bunch(&mut parts, &mut |block| {
            blocks.push(block.iter().map(|part| part.triangle).collect::<Vec<_>>());
        });
        assert_eq!(blocks, [[1, 3, 5, 7, 9, 11], [0, 2, 4, 6, 8, 10]]);
    }
}
