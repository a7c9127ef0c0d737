//! The builder that sorts the events of every node anew: O(N log² N) \[WH06], section 4.2.

use super::meter::Meter;
use super::naive::{Reference, build_with};
use super::options::Limits;
use super::plane::{Plane, Side};
use super::{BuildError, Growth, NodeCost};
use crate::geometry::{Aabb, Mesh};

/// The exact tree, by sorting in every node.
pub(super) fn build(mesh: &Mesh, limits: &Limits, meter: &Meter) -> Result<Growth, BuildError> {
    build_with(mesh, limits, meter, (cheapest_plane, 2 * size_of::<(f32, Kind)>()))
}

/// Where a reference ends, lies flat or starts along an axis. At one position they come in this
/// order.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    End,
    Planar,
    Start,
}

/// The first of the cheapest planes in order of axis and position, if cheaper than a leaf.
fn cheapest_plane(references: &[Reference], bounds: &Aabb, cost: &NodeCost) -> Option<Plane> {
    let mut best = None;
    let mut best_price = cost.leaf(references.len());
    for axis in 0..3 {
        let events = sorted_events(references, axis);
        let (mut left, mut right) = (0, references.len() as i32);
        for group in events.chunk_by(|a, b| a.0 == b.0) {
            let position = group[0].0;
            let count = |kind| group.iter().filter(|event| event.1 == kind).count() as i32;
            let flat = count(Kind::Planar);
            right -= flat + count(Kind::End);
            if bounds.lower[axis] < position && position < bounds.upper[axis] {
                let distances = [position - bounds.lower[axis], bounds.upper[axis] - position];
                let options =
                    [(Side::Left, [left + flat, right]), (Side::Right, [left, right + flat])];
                for (flat, counts) in options {
                    let price = cost.split(axis, distances, counts);
                    if price < best_price {
                        best_price = price;
                        best = Some(Plane { axis, position, flat });
                    }
                }
            }
            left += flat + count(Kind::Start);
        }
    }
    best
}

fn sorted_events(references: &[Reference], axis: usize) -> Vec<(f32, Kind)> {
    let mut events = Vec::with_capacity(2 * references.len());
    for reference in references {
        let (lower, upper) = (reference.bounds.lower[axis], reference.bounds.upper[axis]);
        if lower == upper {
            events.push((lower, Kind::Planar));
        } else {
            events.extend([(lower, Kind::Start), (upper, Kind::End)]);
        }
    }
    events.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    events
}
