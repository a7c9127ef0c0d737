//! The nodes near the root alone, for somebody who builds elsewhere what is below them.

use super::large::Maker;
use super::set::Set;
use super::sweep::Candidate;
use super::{Context, Node, make};
use crate::build::meter::Meter;
use crate::build::{BuildError, BuildOptions, Growth, Limits};
use crate::geometry::{Aabb, Mesh};
use crate::tree::{self, Tree};

/// The nodes near the root.
pub enum Crown {
    /// A plane, and what is on its sides.
    Inner {
        /// Axis of the plane.
        axis: usize,
        /// Where on it the plane is.
        position: f32,
        /// Left and right.
        children: Box<[Crown; 2]>,
    },
    /// A leaf and its triangles.
    Leaf(Vec<u32>),
    /// A node of which no more is known.
    Below(Below),
}

/// A node, and its references in the order of their triangles.
pub struct Below {
    /// The node's box.
    pub bounds: Aabb,
    /// How far it is below the root.
    pub depth: u32,
    /// By reference: the triangle.
    pub triangles: Vec<u32>,
    /// By reference: the bounds of its part.
    pub parts: Vec<Aabb>,
}

impl Crown {
    /// Cuts nodes until they have `most` references at most.
    ///
    /// # Errors
    ///
    /// As [`Tree::build`].
    pub fn new(mesh: &Mesh, options: &BuildOptions, most: usize) -> Result<Self, BuildError> {
        make(&Most(most), mesh, &Limits::new(mesh, options)?, &Meter::new(options))
    }

    /// How many inner nodes and leaves there are, and how many references below.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        match self {
            Self::Inner { children, .. } => {
                let [left, right] = [0, 1].map(|side| children[side].counts());
                [1 + left[0] + right[0], left[1] + right[1]]
            }
            Self::Leaf(_) => [1, 0],
            Self::Below(below) => [0, below.triangles.len()],
        }
    }

    /// The tree. `build` gives nodes and references of what is below, where references are places in
    /// [`Below::triangles`].
    ///
    /// # Errors
    ///
    /// Those of `build`, and [`BuildError::TreeTooLarge`].
    pub fn into_tree<E: From<BuildError>>(
        self,
        mesh: &Mesh,
        options: &BuildOptions,
        mut build: impl FnMut(&Below) -> Result<(Vec<tree::Node>, Vec<u32>), E>,
    ) -> Result<Tree, E> {
        let mut growth = Growth::default();
        self.grow(&mut growth, &mut build)?;
        let Growth { nodes, references, .. } = growth;
        Ok(Tree::from_parts(mesh, nodes, references, options.cost))
    }

    fn grow<E: From<BuildError>>(
        self,
        growth: &mut Growth,
        build: &mut impl FnMut(&Below) -> Result<(Vec<tree::Node>, Vec<u32>), E>,
    ) -> Result<(), E> {
        match self {
            Self::Inner { axis, position, children } => {
                let place = growth.push_inner(axis, position);
                let [left, right] = *children;
                left.grow(growth, build)?;
                growth.set_right(place);
                right.grow(growth, build)?;
            }
            Self::Leaf(triangles) => growth.push_leaf(&triangles, &Aabb::EMPTY),
            Self::Below(below) => {
                let (nodes, mut references) = build(&below)?;
                references.iter_mut().for_each(|place| *place = below.triangles[*place as usize]);
                growth.append(&Growth { nodes, references, parts: Vec::new() });
            }
        }
        growth.check_size().map_err(E::from)
    }
}

/// Cuts what has more references.
struct Most(usize);

impl Maker for Most {
    type Subtree = Crown;

    fn most(&self) -> usize {
        self.0
    }

    fn below(&self, context: &Context, set: Set, node: Node) -> Result<Crown, BuildError> {
        let bytes = set.triangles.len() * (size_of::<Aabb>() + size_of::<u32>());
        context.meter.charge("crown", bytes)?;
        let (triangles, parts) = (set.triangles.to_vec(), set.parts());
        Ok(Crown::Below(Below { bounds: node.bounds, depth: node.depth, triangles, parts }))
    }

    fn leaf(&self, context: &Context, set: &Set, _: &Node) -> Result<Crown, BuildError> {
        context.meter.charge("crown", size_of_val(set.triangles))?;
        Ok(Crown::Leaf(set.triangles.to_vec()))
    }

    fn joined(
        &self,
        _: &Context,
        &Candidate { axis, position, .. }: &Candidate,
        children: [Crown; 2],
    ) -> Result<Crown, BuildError> {
        Ok(Crown::Inner { axis, position, children: Box::new(children) })
    }
}
