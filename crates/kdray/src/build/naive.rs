//! The builder that is the definition: every candidate plane against every reference, O(N²).

use super::meter::Meter;
use super::options::Limits;
use super::plane::{Plane, Side};
use super::{BuildError, Growth, NodeCost};
use crate::geometry::{Aabb, Mesh};

/// A triangle in a node, with the bounds of its part there.
#[derive(Clone, Copy)]
pub(super) struct Reference {
    pub(super) triangle: u32,
    pub(super) bounds: Aabb,
}

/// How a builder of whole-reference lists finds the cheapest plane of a node.
pub(super) type FindPlane = fn(&[Reference], &Aabb, &NodeCost) -> Option<Plane>;

/// The exact tree, by counting.
pub(super) fn build(mesh: &Mesh, limits: &Limits, meter: &Meter) -> Result<Growth, BuildError> {
    build_with(mesh, limits, meter, (cheapest_plane, 2 * size_of::<f32>()))
}

/// The exact tree, with planes found by a function that allocates so many bytes a reference.
pub(super) fn build_with(
    mesh: &Mesh,
    limits: &Limits,
    meter: &Meter,
    (find_plane, find_bytes): (FindPlane, usize),
) -> Result<Growth, BuildError> {
    let references = root_references(mesh);
    meter.charge("root", capacity_bytes(&references))?;
    let growth = Growth::default();
    let mut context = Context { mesh, limits, meter, find_plane, find_bytes, growth, booked: 0 };
    context.node(references, mesh.bounds(), 0, 1.0)?;
    context.growth.check_size()?;
    Ok(context.growth)
}

fn root_references(mesh: &Mesh) -> Vec<Reference> {
    let bounds = |triangle| Aabb::of_points(&mesh.triangle(triangle));
    let reference = |index| Reference { triangle: index as u32, bounds: bounds(index) };
    (0..mesh.triangles().len()).map(reference).collect()
}

struct Context<'a> {
    mesh: &'a Mesh,
    limits: &'a Limits,
    meter: &'a Meter<'a>,
    find_plane: FindPlane,
    find_bytes: usize,
    growth: Growth,
    /// Bytes that were booked for the growth.
    booked: usize,
}

fn capacity_bytes(references: &Vec<Reference>) -> usize {
    references.capacity() * size_of::<Reference>()
}

impl Context<'_> {
    /// Builds the subtree of a node; `share` is its part of the whole build.
    fn node(
        &mut self,
        references: Vec<Reference>,
        bounds: Aabb,
        depth: u32,
        share: f64,
    ) -> Result<(), BuildError> {
        self.meter.check_cancelled()?;
        let may_split = depth < self.limits.max_depth && references.len() > self.limits.max_leaf;
        let cost = NodeCost::new(&self.limits.cost, &bounds);
        let find_bytes = self.find_bytes * references.len();
        self.meter.charge("sweep", find_bytes)?;
        let plane = if may_split { (self.find_plane)(&references, &bounds, &cost) } else { None };
        self.meter.release(find_bytes);
        let Some(plane) = plane else {
            let triangles: Vec<u32> = references.iter().map(|r| r.triangle).collect();
            let parts = references.iter().fold(Aabb::EMPTY, |all, r| all.union(&r.bounds));
            self.growth.push_leaf(&triangles, &parts);
            self.meter.advance(share);
            self.meter.release(capacity_bytes(&references));
            let grown = self.growth.capacity_bytes() - self.booked;
            self.booked += grown;
            return self.meter.charge("tree", grown);
        };
        let [left_bounds, right_bounds] = bounds.cut(plane.axis, plane.position);
        let left = self.children(&references, &plane, Side::Left, &left_bounds);
        let right = self.children(&references, &plane, Side::Right, &right_bounds);
        self.meter.charge("split", capacity_bytes(&left) + capacity_bytes(&right))?;
        self.meter.release(capacity_bytes(&references));
        drop(references);
        let place = self.growth.push_inner(plane.axis, plane.position);
        self.node(left, left_bounds, depth + 1, 0.5 * share)?;
        self.growth.set_right(place);
        self.node(right, right_bounds, depth + 1, 0.5 * share)
    }

    /// The references of the child on `side`: those on it, and the parts of straddlers.
    fn children(
        &self,
        references: &[Reference],
        plane: &Plane,
        side: Side,
        bounds: &Aabb,
    ) -> Vec<Reference> {
        let reach = |reference: &Reference| match plane.side_of(&reference.bounds) {
            Side::Both => {
                let corners = self.mesh.triangle(reference.triangle as usize);
                let part = self.limits.part(&corners, bounds)?;
                Some(Reference { bounds: part, ..*reference })
            }
            reached => (reached == side).then_some(*reference),
        };
        let mut children = Vec::with_capacity(references.len());
        children.extend(references.iter().filter_map(reach));
        children
    }
}

/// The first of the cheapest planes in order of axis and position, if cheaper than a leaf.
fn cheapest_plane(references: &[Reference], bounds: &Aabb, cost: &NodeCost) -> Option<Plane> {
    let mut best = None;
    let mut best_price = cost.leaf(references.len());
    for axis in 0..3 {
        let ends = |r: &Reference| [r.bounds.lower[axis], r.bounds.upper[axis]];
        let mut candidates: Vec<f32> = references.iter().flat_map(ends).collect();
        candidates.sort_by(f32::total_cmp);
        candidates.dedup();
        candidates.retain(|p| bounds.lower[axis] < *p && *p < bounds.upper[axis]);
        for position in candidates {
            let (price, flat) = price_of(references, bounds, cost, axis, position);
            if price < best_price {
                best_price = price;
                best = Some(Plane { axis, position, flat });
            }
        }
    }
    best
}

/// Price of a plane, and the cheaper side for the references that lie in it (left on a tie).
fn price_of(
    references: &[Reference],
    bounds: &Aabb,
    cost: &NodeCost,
    axis: usize,
    position: f32,
) -> (f32, Side) {
    let count = |wanted: fn(f32, f32, f32) -> bool| {
        let is_wanted =
            |r: &&Reference| wanted(r.bounds.lower[axis], r.bounds.upper[axis], position);
        references.iter().filter(is_wanted).count() as i32
    };
    let left = count(|lower, _, p| lower < p);
    let right = count(|_, upper, p| upper > p);
    let flat = count(|lower, upper, p| lower == p && upper == p);
    let distances = [position - bounds.lower[axis], bounds.upper[axis] - position];
    let price_left = cost.split(axis, distances, [left + flat, right]);
    let price_right = cost.split(axis, distances, [left, right + flat]);
    if price_left <= price_right { (price_left, Side::Left) } else { (price_right, Side::Right) }
}
