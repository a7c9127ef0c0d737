//! The surface area heuristic, and nothing else.

use crate::geometry::Aabb;

/// What the builder thinks a ray pays.
///
/// A ray that enters a node enters a child with probability equal to the ratio of their surface
/// areas \[MB90], so cutting a node costs
///
/// ```text
/// traversal + intersect (N_left S_left + N_right S_right) / S
/// ```
///
/// and keeping it as a leaf costs `intersect N`. Only the ratio of the two prices matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Price of visiting an inner node, `C_T`. More gives shallower trees with larger leaves.
    pub traversal: f32,
    /// Price of testing one triangle, `C_I`.
    pub intersect: f32,
    /// A plane that cuts off empty space costs this fraction less \[WH06].
    pub empty_bonus: f32,
}

impl Default for Cost {
    /// With steps from 1 to 4 tests, trees got smaller and tracing faster. From 4 to 12 the CPU, which
    /// tests eight triangles at once, traces alike from ever smaller trees (at 6, a tenth less time to
    /// build and a fifth less memory than at 4), while a GPU, which tests one after the other, slows:
    /// a tenth at 6, a fifth at 8.
    fn default() -> Self {
        Self { traversal: 6.0, intersect: 1.0, empty_bonus: 0.2 }
    }
}

/// The prices of one node's planes, times the node's half area: nothing is divided.
///
/// Every builder on every device computes `price` with these operations in this order, each
/// rounded to single precision, so they agree on which plane is cheapest to the last bit. A price
/// never decreases when a count grows; the sweep relies on that.
#[derive(Clone, Copy, Debug)]
pub struct NodeCost {
    /// By axis: intersection price times the area of the face that a plane shows.
    pub(crate) face: [f32; 3],
    /// By axis: intersection price times half the girth of that face.
    pub(crate) girth: [f32; 3],
    /// Traversal price times the half area.
    pub(crate) step: f32,
    /// Intersection price times the half area.
    test: f32,
    /// What a plane with an empty side pays, as a fraction.
    pub empty_factor: f32,
}

impl NodeCost {
    /// The prices of the node with these `bounds`.
    #[must_use]
    pub fn new(cost: &Cost, bounds: &Aabb) -> Self {
        let [x, y, z] = bounds.extent();
        let half_area = x * (y + z) + y * z;
        Self {
            face: [y * z, z * x, x * y].map(|area| cost.intersect * area),
            girth: [y + z, z + x, x + y].map(|girth| cost.intersect * girth),
            step: cost.traversal * half_area,
            test: cost.intersect * half_area,
            empty_factor: 1.0 - cost.empty_bonus,
        }
    }

    /// Price of keeping `count` references in a leaf.
    #[must_use]
    pub fn leaf(&self, count: usize) -> f32 {
        self.test * count as f32
    }

    /// Price of a plane at distances `below` and `above` from the two faces of the node, with
    /// `left` and `right` references on its sides.
    #[must_use]
    #[inline(always)]
    pub fn split(&self, axis: usize, [below, above]: [f32; 2], [left, right]: [i32; 2]) -> f32 {
        let volumes = left as f32 * below + right as f32 * above;
        let tests = self.face[axis] * (left + right) as f32 + self.girth[axis] * volumes;
        let price = self.step + tests;
        let empty = (left == 0) | (right == 0);
        price * if empty { self.empty_factor } else { 1.0 }
    }

    /// Whether no plane can be cheaper than a leaf, whatever the counts: the traversal step alone
    /// costs as much.
    #[must_use]
    pub fn is_surely_leaf(&self, count: usize) -> bool {
        self.leaf(count) <= self.empty_factor * self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_cube_cut_in_half() {
        let cost = Cost { traversal: 1.0, intersect: 2.0, empty_bonus: 0.5 };
        let cube = Aabb { lower: [0.0; 3], upper: [1.0; 3] };
        let node = NodeCost::new(&cost, &cube);
        // Half areas: 3 for the cube, 2 for each half.
        assert_eq!(node.leaf(5), 2.0 * 5.0 * 3.0);
        assert_eq!(node.split(0, [0.5, 0.5], [3, 4]), 3.0 + 2.0 * (3.0 * 2.0 + 4.0 * 2.0));
        assert_eq!(node.split(2, [0.5, 0.5], [0, 4]), 0.5 * (3.0 + 2.0 * 4.0 * 2.0));
    }
}
