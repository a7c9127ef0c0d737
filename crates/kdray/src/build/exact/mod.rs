//! The builder for everybody: O(N log N) by sorting once \[WH06], parallel over subtrees and,
//! near the root, over axes.
//!
//! A node goes through the stages of a level: [`sweep`] finds its plane, [`split`] assigns and
//! clips its references and splits its sorted events. Large nodes own their lists and free them
//! as soon as their children have theirs; small subtrees run depth-first in one piece of scratch
//! memory that stays in the cache; [`tiny`] ones have no events, for their references are few enough
//! to be counted at every plane.

mod columns;
mod crown;
mod event;
mod lanes;
mod large;
mod partition;
mod pricing;
mod set;
mod small;
mod sort;
mod split;
mod sweep;
mod tiny;

use std::sync::Mutex;

use super::meter::Meter;
use super::options::Limits;
use super::{BuildError, Growth, NodeCost};
use crate::geometry::{Aabb, Mesh};
pub use crown::{Below, Crown};
use large::{Maker, Whole};
use small::Small;

/// Everything a task of the build needs to know.
struct Context<'a> {
    mesh: &'a Mesh,
    limits: &'a Limits,
    meter: &'a Meter<'a>,
    /// Memory of small subtrees that are finished, for the next.
    idle: Mutex<Vec<Small>>,
}

/// A node before its children are known.
#[derive(Clone, Copy)]
struct Node {
    bounds: Aabb,
    depth: u32,
    /// Its part of the whole build, for the progress report.
    share: f64,
}

impl Node {
    /// The children, with `left` and `right` references, at a plane.
    fn cut(&self, axis: usize, position: f32, [left, right]: [usize; 2]) -> [Self; 2] {
        let [left_bounds, right_bounds] = self.bounds.cut(axis, position);
        let part = self.share / (left + right).max(1) as f64;
        let child = |bounds, count: usize| Self {
            bounds,
            depth: self.depth + 1,
            share: part * count as f64,
        };
        [child(left_bounds, left), child(right_bounds, right)]
    }
}

impl Context<'_> {
    /// The prices of a node's planes, or `None` if it is a leaf without a look at them.
    fn prices(&self, node: &Node, count: usize) -> Option<NodeCost> {
        if count <= self.limits.max_leaf || node.depth >= self.limits.max_depth {
            return None;
        }
        let cost = NodeCost::new(&self.limits.cost, &node.bounds);
        (!cost.is_surely_leaf(count)).then_some(cost)
    }

    /// Runs both, at the same time if the build has threads.
    fn join<A: Send, B: Send>(
        &self,
        a: impl FnOnce() -> A + Send,
        b: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        if self.limits.threads > 1 { rayon::join(a, b) } else { (a(), b()) }
    }
}

/// The exact tree.
pub(super) fn build(mesh: &Mesh, limits: &Limits, meter: &Meter) -> Result<Growth, BuildError> {
    make(&Whole, mesh, limits, meter)
}

/// What `maker` makes of the root and what is below.
fn make<M: Maker>(
    maker: &M,
    mesh: &Mesh,
    limits: &Limits,
    meter: &Meter,
) -> Result<M::Subtree, BuildError> {
    let context = Context { mesh, limits, meter, idle: Mutex::default() };
    if limits.threads == 1 {
        return large::build(&context, maker);
    }
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(limits.threads).build().map_err(|error| {
            BuildError::Threads { threads: limits.threads, reason: error.to_string() }
        })?;
    pool.install(|| large::build(&context, maker))
}
