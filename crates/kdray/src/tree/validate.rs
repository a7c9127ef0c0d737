//! Prove that a tree is one of its mesh: against the geometry, not against the builder.

use rayon::prelude::*;

use super::check::{self, Fault};
use super::{Kind, Tree};
use crate::geometry::{Aabb, Mesh};

/// The first thing found wrong with a tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Violation {
    /// The tree was built from another mesh.
    #[error("the tree is of another mesh: {what} differ")]
    OtherMesh {
        /// What is different.
        what: &'static str,
    },
    /// The nodes do not make a tree.
    #[error("{0}")]
    Structure(#[from] Fault),
    /// A leaf refers to a triangle that does not come near it.
    #[error("leaf {node} refers to triangle {triangle}, which does not reach its box")]
    Unreached {
        /// Index of the leaf.
        node: usize,
        /// The triangle.
        triangle: u32,
    },
    /// A part of a triangle lies in a leaf that does not refer to it.
    #[error("triangle {triangle} has a part in leaf {node}, which does not refer to it")]
    Missing {
        /// Index of the leaf.
        node: usize,
        /// The triangle.
        triangle: u32,
    },
}

/// A part of a triangle thinner than this, relative to the scene, need not be referred to:
/// clipping in double precision cannot tell it from none.
const THINNEST: f64 = 1e-13;

impl Tree {
    /// Checks that this is a kd-tree of `mesh`: nodes in depth-first order, planes inside their
    /// boxes, leaves in order; every reference reaches its leaf, and every part of every triangle,
    /// found anew by clipping in double precision, lies in leaves that refer to it.
    ///
    /// Costs about as much as the build, on all cores.
    ///
    /// # Errors
    ///
    /// The first [`Violation`].
    pub fn validate(&self, mesh: &Mesh) -> Result<(), Violation> {
        self.check_mesh(mesh)?;
        self.check_leaves(mesh)?;
        let scene = self.bounds();
        let reach = |v: f32| f64::from(v.abs());
        let largest = scene.lower.into_iter().chain(scene.upper).map(reach).fold(0.0, f64::max);
        let cover = Cover { tree: self, thinnest: THINNEST * largest };
        let missing = (0..mesh.triangles().len()).into_par_iter().find_map_first(|triangle| {
            let polygon = mesh.triangle(triangle).map(|corner| corner.map(f64::from));
            let node = cover.find_missing(0, triangle as u32, &polygon)?;
            Some(Violation::Missing { node, triangle: triangle as u32 })
        });
        missing.map_or(Ok(()), Err)
    }

    fn check_mesh(&self, mesh: &Mesh) -> Result<(), Violation> {
        let other = |what| Err(Violation::OtherMesh { what });
        if self.triangle_count() != mesh.triangles().len() {
            return other("numbers of triangles");
        }
        if self.bounds() != mesh.bounds() {
            return other("bounds");
        }
        if !self.is_of(mesh) { other("positions or frames") } else { Ok(()) }
    }

    fn check_leaves(&self, mesh: &Mesh) -> Result<(), Violation> {
        let (nodes, references) = (self.nodes(), self.references());
        let mut unreached = None;
        check::walk(nodes, references, self.bounds(), self.triangle_count(), |node, bounds, _| {
            let Kind::Leaf { first, count } = nodes[node].kind() else {
                return;
            };
            // The walk has not yet said whether the leaf's references are all there.
            let leaf = references.get(first..).unwrap_or_default();
            let astray = |triangle: &&u32| {
                let known = (**triangle as usize) < mesh.triangles().len();
                known && !touches(bounds, &mesh.triangle(**triangle as usize))
            };
            if let Some(triangle) = leaf.iter().take(count).find(astray) {
                unreached.get_or_insert(Violation::Unreached { node, triangle: *triangle });
            }
        })?;
        unreached.map_or(Ok(()), Err)
    }
}

/// Whether the bounds of the triangle meet the box.
fn touches(bounds: &Aabb, triangle: &[[f32; 3]; 3]) -> bool {
    let other = Aabb::of_points(triangle);
    (0..3).all(|axis| {
        bounds.lower[axis] <= other.upper[axis] && other.lower[axis] <= bounds.upper[axis]
    })
}

/// Follows the parts of triangles down the tree.
struct Cover<'a> {
    tree: &'a Tree,
    thinnest: f64,
}

impl Cover<'_> {
    /// A leaf below `node` that holds a part of `polygon` and does not refer to `triangle`.
    fn find_missing(&self, node: usize, triangle: u32, polygon: &[[f64; 3]]) -> Option<usize> {
        match self.tree.nodes()[node].kind() {
            Kind::Leaf { first, count } => {
                let leaf = &self.tree.references()[first..first + count];
                leaf.binary_search(&triangle).is_err().then_some(node)
            }
            Kind::Inner { axis, position, right } => {
                let position = f64::from(position);
                let values = polygon.iter().map(|corner| corner[axis]);
                let lower = values.clone().fold(f64::INFINITY, f64::min);
                let upper = values.fold(f64::NEG_INFINITY, f64::max);
                let below = position - lower > self.thinnest;
                let above = upper - position > self.thinnest;
                let left =
                    || self.find_missing(node + 1, triangle, &cut(polygon, axis, position, 1.0));
                let right =
                    || self.find_missing(right, triangle, &cut(polygon, axis, position, -1.0));
                match (below, above) {
                    (true, true) => left().or_else(right),
                    (true, false) => left(),
                    (false, true) => right(),
                    // In the plane: one side is enough.
                    (false, false) => left().and_then(|missing| right().map(|_| missing)),
                }
            }
        }
    }
}

/// The part of `polygon` where `side * (coordinate - position) <= 0`, corners in the plane kept.
fn cut(polygon: &[[f64; 3]], axis: usize, position: f64, side: f64) -> Vec<[f64; 3]> {
    let beyond = |corner: &[f64; 3]| side * (corner[axis] - position) > 0.0;
    if !polygon.iter().any(beyond) || polygon.iter().all(beyond) {
        // Nothing to cut; or a part as good as in the plane, which is followed as it is.
        return polygon.to_vec();
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (index, corner) in polygon.iter().enumerate() {
        let next = &polygon[(index + 1) % polygon.len()];
        if !beyond(corner) {
            kept.push(*corner);
        }
        if beyond(corner) != beyond(next) {
            let t = (position - corner[axis]) / (next[axis] - corner[axis]);
            let mut point =
                [0, 1, 2].map(|other| corner[other] + (next[other] - corner[other]) * t);
            point[axis] = position;
            kept.push(point);
        }
    }
    kept
}
