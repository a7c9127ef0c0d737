//! The definition for clipped trees, as closely as it can be checked without the builder's own
//! clipping.
//!
//! The bounds of a reference may exceed those of its part by a few ulps, so they are known as an
//! interval: at least the part by double-precision clipping, at most the part in a slightly grown
//! box, slightly grown. From the intervals follow a lowest and a highest price of every plane. The
//! plane that the tree has must be able to be the cheapest one, and leaves must refer to every
//! triangle that surely has a part in them and to none that surely has not.

use kdray::tree::Kind;
use kdray::{Aabb, BuildOptions, Mesh, Tree};

use super::polygon::{Bounds, clip};

/// A triangle that may be in a node.
#[derive(Clone, Copy)]
struct Reference {
    triangle: u32,
    /// The bounds are inside this box.
    outer: Bounds,
    /// The bounds hold this box, if the triangle surely has a part in the node.
    inner: Option<Bounds>,
}

/// The lowest and the highest that something can be.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: f64,
    high: f64,
}

/// Prices in double precision and in single precision differ by less, relatively.
const ROUNDING: f64 = 1e-5;

/// Checks that a tree built with these options, `clip` on and neither depth nor leaf size limited,
/// may be the one that the definition gives.
///
/// # Errors
///
/// A sentence that names the first node that cannot be.
pub fn check(mesh: &Mesh, tree: &Tree, options: &BuildOptions) -> Result<(), String> {
    let bounds = mesh.bounds();
    let reach = |v: &f32| f64::from(v.abs());
    let largest = bounds.lower.iter().chain(&bounds.upper).map(reach).fold(0.0, f64::max);
    // A clipped corner is off by at most six times eleven half ulps (see `geometry/clip.rs`).
    let margin = 7.0 * 11.0 * 0.5 * f64::from(f32::EPSILON) * largest;
    let check = Check { mesh, tree, options, margin };
    let everything: Vec<u32> = (0..mesh.triangles().len() as u32).collect();
    check.node(0, &everything, &bounds)
}

struct Check<'a> {
    mesh: &'a Mesh,
    tree: &'a Tree,
    options: &'a BuildOptions<'a>,
    margin: f64,
}

impl Check<'_> {
    fn node(&self, index: usize, candidates: &[u32], bounds: &Aabb) -> Result<(), String> {
        let boxed = Bounds::of(bounds);
        let reference = |triangle: &u32| self.reference(*triangle, &boxed);
        let references: Vec<Reference> = candidates.iter().filter_map(reference).collect();
        let cheapest = self.cheapest(&references, &boxed);
        let intersect = f64::from(self.options.cost.intersect) * boxed.half_area();
        match self.tree.nodes()[index].kind() {
            Kind::Leaf { first, count } => {
                let found = &self.tree.references()[first..first + count];
                self.leaf(index, found, &references)?;
                if cheapest < count as f64 * intersect * (1.0 - ROUNDING) {
                    return Err(format!("leaf {index} should have been cut"));
                }
                Ok(())
            }
            Kind::Inner { axis, position, right } => {
                let price = self.price(&references, &boxed, axis, f64::from(position)).low;
                let leaf = references.len() as f64 * intersect;
                if price > cheapest.min(leaf) * (1.0 + ROUNDING) {
                    return Err(format!("node {index} could be cut for {cheapest}, not {price}"));
                }
                let triangles: Vec<u32> = references.iter().map(|r| r.triangle).collect();
                let [left_bounds, right_bounds] = bounds.cut(axis, position);
                self.node(index + 1, &triangles, &left_bounds)?;
                self.node(right, &triangles, &right_bounds)
            }
        }
    }

    fn leaf(&self, index: usize, found: &[u32], references: &[Reference]) -> Result<(), String> {
        for triangle in found {
            if !references.iter().any(|r| r.triangle == *triangle) {
                return Err(format!("triangle {triangle} is not near leaf {index}"));
            }
        }
        let is_lost = |r: &&Reference| r.inner.is_some() && !found.contains(&r.triangle);
        match references.iter().find(is_lost) {
            Some(lost) => Err(format!("leaf {index} has lost triangle {}", lost.triangle)),
            None => Ok(()),
        }
    }

    /// What is known of a triangle in a node; `None` if it surely has no part there.
    fn reference(&self, triangle: u32, bounds: &Bounds) -> Option<Reference> {
        let corners = self.mesh.triangle(triangle as usize);
        let whole = Bounds::of(&Aabb::of_points(&corners));
        let outer = clip(&corners, &bounds.grown(self.margin))?;
        let outer = outer.grown(self.margin).and(&whole).and(bounds);
        // What only touches the box, or lies in a face, may belong to the neighbour.
        let reaches_in = |part: &Bounds| {
            (0..3).all(|axis| {
                part.upper[axis] > bounds.lower[axis] + self.margin
                    && part.lower[axis] < bounds.upper[axis] - self.margin
            })
        };
        Some(Reference { triangle, outer, inner: clip(&corners, bounds).filter(reaches_in) })
    }

    /// The highest price that the cheapest of the planes can have.
    fn cheapest(&self, references: &[Reference], bounds: &Bounds) -> f64 {
        let mut cheapest = f64::INFINITY;
        for reference in references {
            let Some(inner) = reference.inner else { continue };
            for axis in 0..3 {
                let ends = [
                    (reference.outer.lower[axis], inner.lower[axis]),
                    (reference.outer.upper[axis], inner.upper[axis]),
                ];
                for (outer, inner) in ends {
                    let is_inside = bounds.lower[axis] < outer && outer < bounds.upper[axis];
                    // A plane whose place is not known to the last bit says nothing.
                    if is_inside && outer == inner {
                        let price = self.price(references, bounds, axis, outer);
                        cheapest = cheapest.min(price.high);
                    }
                }
            }
        }
        cheapest
    }

    /// The price of a plane, by the lowest and the highest counts there can be.
    fn price(
        &self,
        references: &[Reference],
        bounds: &Bounds,
        axis: usize,
        position: f64,
    ) -> Range {
        let (mut least, mut most) = ([0_u32; 2], [0_u32; 2]);
        for Reference { outer, inner, .. } in references {
            if let Some(inner) = inner {
                least[0] += u32::from(inner.lower[axis] < position);
                least[1] += u32::from(inner.upper[axis] > position);
            }
            let may_be_flat = outer.lower[axis] <= position
                && position <= outer.upper[axis]
                && inner.is_none_or(|b| b.lower[axis] >= position && b.upper[axis] <= position);
            most[0] += u32::from(outer.lower[axis] < position || may_be_flat);
            most[1] += u32::from(outer.upper[axis] > position || may_be_flat);
        }
        let price = |counts| self.sah(bounds, axis, position, counts);
        let empty_factor = 1.0 - f64::from(self.options.cost.empty_bonus);
        let low = if least.contains(&0) { empty_factor } else { 1.0 } * price(least);
        let high = if most.contains(&0) { empty_factor } else { 1.0 } * price(most);
        Range { low, high }
    }

    /// The surface area heuristic, times the node's half area.
    fn sah(&self, bounds: &Bounds, axis: usize, position: f64, [left, right]: [u32; 2]) -> f64 {
        let (mut below, mut above) = (*bounds, *bounds);
        (below.upper[axis], above.lower[axis]) = (position, position);
        f64::from(self.options.cost.traversal) * bounds.half_area()
            + f64::from(self.options.cost.intersect)
                * (f64::from(left) * below.half_area() + f64::from(right) * above.half_area())
    }
}
