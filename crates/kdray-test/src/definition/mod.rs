//! The definition of the tree, written down a second time.
//!
//! Without clipping, the bounds of a reference are those of its triangle cut to the node's box, so
//! every plane and every leaf follows from the mesh alone: [`check`] works them out by sorting and
//! compares. For clipped trees see [`clipped`].

pub mod clipped;
mod polygon;

use kdray::tree::Kind;
use kdray::{Aabb, BuildOptions, Cost, Mesh, Tree};

/// A triangle in a node.
#[derive(Clone, Copy)]
struct Reference {
    triangle: u32,
    bounds: Aabb,
}

/// A plane, and the child that gets what lies in it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plane {
    axis: usize,
    position: f32,
    is_flat_left: bool,
}

/// Checks that a tree built with these options, `clip` off, is the one that the definition gives.
///
/// # Errors
///
/// A sentence that names the first node that differs.
pub fn check(mesh: &Mesh, tree: &Tree, options: &BuildOptions) -> Result<(), String> {
    let bounds = |triangle: usize| Aabb::of_points(&mesh.triangle(triangle));
    let reference = |index| Reference { triangle: index as u32, bounds: bounds(index) };
    let references: Vec<Reference> = (0..mesh.triangles().len()).map(reference).collect();
    let max_depth = options.max_depth.unwrap_or_else(|| default_depth(mesh.triangles().len()));
    Check { tree, options, max_depth }.node(0, &references, mesh.bounds(), 0)
}

/// `8 + 1.3 log2 N`, rounded.
fn default_depth(triangles: usize) -> u32 {
    (8.0 + 1.3 * (triangles.max(1) as f64).log2()).round() as u32
}

struct Check<'a> {
    tree: &'a Tree,
    options: &'a BuildOptions<'a>,
    max_depth: u32,
}

impl Check<'_> {
    fn node(
        &self,
        index: usize,
        references: &[Reference],
        bounds: Aabb,
        depth: u32,
    ) -> Result<(), String> {
        let is_leaf = depth >= self.max_depth || references.len() <= self.options.max_leaf as usize;
        let plane =
            if is_leaf { None } else { best_plane(references, &bounds, &self.options.cost) };
        match (self.tree.nodes()[index].kind(), plane) {
            (Kind::Leaf { first, count }, None) => {
                let found = &self.tree.references()[first..first + count];
                if found.iter().copied().eq(references.iter().map(|r| r.triangle)) {
                    return Ok(());
                }
                Err(format!("leaf {index} has {found:?}"))
            }
            (Kind::Inner { axis, position, right }, Some(plane))
                if (axis, position.to_bits()) == (plane.axis, plane.position.to_bits()) =>
            {
                let [left_bounds, right_bounds] = bounds.cut(axis, position);
                let left_part = part(references, &plane, &left_bounds, true);
                self.node(index + 1, &left_part, left_bounds, depth + 1)?;
                let right_part = part(references, &plane, &right_bounds, false);
                self.node(right, &right_part, right_bounds, depth + 1)
            }
            (found, wanted) => Err(format!("node {index} is {found:?} instead of {wanted:?}")),
        }
    }
}

/// The references that reach one child, with their bounds there.
fn part(references: &[Reference], plane: &Plane, bounds: &Aabb, is_left: bool) -> Vec<Reference> {
    let reaches = |r: &&Reference| {
        let (lower, upper) = (r.bounds.lower[plane.axis], r.bounds.upper[plane.axis]);
        let touches = if is_left { lower < plane.position } else { upper > plane.position };
        let is_flat = lower == plane.position && upper == plane.position;
        touches || is_flat && plane.is_flat_left == is_left
    };
    let cut = |r: &Reference| {
        let mut part = r.bounds;
        part.lower[plane.axis] = part.lower[plane.axis].max(bounds.lower[plane.axis]);
        part.upper[plane.axis] = part.upper[plane.axis].min(bounds.upper[plane.axis]);
        Reference { bounds: part, ..*r }
    };
    references.iter().filter(reaches).map(cut).collect()
}

/// Lowest cost, then lowest axis, then lowest position; `None` if no plane is cheaper than a leaf.
fn best_plane(references: &[Reference], bounds: &Aabb, cost: &Cost) -> Option<Plane> {
    let prices = Prices::new(bounds, cost);
    let mut best = (prices.leaf(references.len()), None);
    for axis in 0..3 {
        let sorted = |values: fn(&Reference, usize) -> f32| {
            let mut values: Vec<f32> = references.iter().map(|r| values(r, axis)).collect();
            values.sort_by(f32::total_cmp);
            values
        };
        let lowers = sorted(|r, axis| r.bounds.lower[axis]);
        let uppers = sorted(|r, axis| r.bounds.upper[axis]);
        let mut positions = [&lowers[..], &uppers].concat();
        positions.sort_by(f32::total_cmp);
        positions.dedup();
        for position in positions {
            if !(bounds.lower[axis] < position && position < bounds.upper[axis]) {
                continue;
            }
            // Flat references are among those that neither start below nor end above.
            let left = lowers.partition_point(|lower| *lower < position);
            let right = uppers.len() - uppers.partition_point(|upper| *upper <= position);
            let is_flat =
                |r: &&Reference| [r.bounds.lower[axis], r.bounds.upper[axis]] == [position; 2];
            let flat = references.iter().filter(is_flat).count();
            for (is_flat_left, counts) in
                [(true, [left + flat, right]), (false, [left, right + flat])]
            {
                let price = prices.split(axis, position, counts);
                if price < best.0 {
                    best = (price, Some(Plane { axis, position, is_flat_left }));
                }
            }
        }
    }
    best.1
}

/// The prices of a node's planes times its half area, rounded as the documentation of the builder
/// fixes it: decisions fall on the last bit.
struct Prices<'a> {
    cost: &'a Cost,
    bounds: &'a Aabb,
    half_area: f32,
}

impl<'a> Prices<'a> {
    fn new(bounds: &'a Aabb, cost: &'a Cost) -> Self {
        let [x, y, z] = bounds.extent();
        Self { cost, bounds, half_area: x * (y + z) + y * z }
    }

    fn leaf(&self, count: usize) -> f32 {
        (self.cost.intersect * self.half_area) * count as f32
    }

    fn split(&self, axis: usize, position: f32, [left, right]: [usize; 2]) -> f32 {
        let extent = self.bounds.extent();
        let (b, c) = (extent[(axis + 1) % 3], extent[(axis + 2) % 3]);
        let face = self.cost.intersect * (b * c);
        let girth = self.cost.intersect * (b + c);
        let below = position - self.bounds.lower[axis];
        let above = self.bounds.upper[axis] - position;
        let volumes = left as f32 * below + right as f32 * above;
        let price =
            self.cost.traversal * self.half_area + (face * (left + right) as f32 + girth * volumes);
        if left == 0 || right == 0 { price * (1.0 - self.cost.empty_bonus) } else { price }
    }
}
