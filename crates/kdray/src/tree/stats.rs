//! What a tree is like: sizes, depth, and what a ray can expect to pay.

use super::{Kind, Tree, check};
use crate::build::Cost;

/// Statistics of a tree.
///
/// `e_inner`, `e_leaf` and `e_prim` are sums of surface areas over the root's: what a random line
/// through the root's box is expected to meet of inner nodes, leaves and references. A tree whose
/// root has no area has sums of zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Stats {
    /// Inner nodes and leaves.
    pub nodes: usize,
    /// Leaves, the empty ones included.
    pub leaves: usize,
    /// Leaves without references.
    pub empty_leaves: usize,
    /// References of all leaves together.
    pub references: usize,
    /// Inner nodes on the longest way to a leaf.
    pub depth: u32,
    /// `leaf_histogram[n]` leaves have `n` references.
    pub leaf_histogram: Vec<usize>,
    /// Inner nodes that a line through the root meets.
    pub e_inner: f64,
    /// Leaves that it meets, the empty ones included.
    pub e_leaf: f64,
    /// References in those leaves.
    pub e_prim: f64,
    /// Bytes of nodes and references.
    pub bytes: usize,
}

impl Stats {
    /// What a ray is expected to pay at these prices, in units of one intersection:
    /// `(C_T e_inner + C_I e_prim) / C_I` \[MB90].
    #[must_use]
    pub fn sah_cost(&self, cost: &Cost) -> f64 {
        self.e_inner * f64::from(cost.traversal) / f64::from(cost.intersect) + self.e_prim
    }
}

impl Tree {
    /// Statistics of the tree. Costs one pass over the nodes.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let root_area = self.bounds().half_area();
        let mut stats = Stats {
            nodes: self.nodes().len(),
            leaves: 0,
            empty_leaves: 0,
            references: self.references().len(),
            depth: 0,
            leaf_histogram: Vec::new(),
            e_inner: 0.0,
            e_leaf: 0.0,
            e_prim: 0.0,
            bytes: self.size_bytes(),
        };
        let (nodes, references) = (self.nodes(), self.references());
        let result = check::walk(
            nodes,
            references,
            self.bounds(),
            self.triangle_count(),
            |index, bounds, depth| {
                let area = if root_area > 0.0 { bounds.half_area() / root_area } else { 0.0 };
                stats.depth = stats.depth.max(depth);
                match nodes[index].kind() {
                    Kind::Inner { .. } => stats.e_inner += area,
                    Kind::Leaf { count, .. } => stats.count_leaf(count, area),
                }
            },
        );
        debug_assert_eq!(result, Ok(()), "builders and file checks only let trees through");
        stats
    }
}

impl Stats {
    fn count_leaf(&mut self, count: usize, area: f64) {
        self.leaves += 1;
        if self.leaf_histogram.len() <= count {
            self.leaf_histogram.resize(count + 1, 0);
        }
        self.leaf_histogram[count] += 1;
        self.empty_leaves += usize::from(count == 0);
        self.e_leaf += area;
        self.e_prim += area * count as f64;
    }
}
