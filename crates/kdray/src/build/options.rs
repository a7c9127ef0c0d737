//! What a build can be told.

use std::sync::atomic::AtomicBool;

use super::{BuildError, Cost};
use crate::geometry::{Aabb, Mesh};

/// The deepest tree that can be asked for; tracers keep a stack of this many entries.
pub const MAX_DEPTH: u32 = 255;

/// How to find the cheapest plane of each node. All give the same tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Builder {
    /// Sort once, keep the order while splitting: O(N log N) \[WH06]. The one to use.
    #[default]
    Exact,
    /// Sort the events of every node anew: O(N log² N) \[WH06].
    Resort,
    /// Count every candidate against every reference: O(N²). The oracle of the tests.
    Naive,
}

/// Options of a build; change the fields you care about.
///
/// ```
/// use kdray::{BuildOptions, Cost};
///
/// let shallow = BuildOptions { max_depth: Some(12), cost: Cost { traversal: 15.0, intersect: 20.0, ..Cost::default() }, ..BuildOptions::default() };
/// # let _ = shallow;
/// ```
#[derive(Clone)]
pub struct BuildOptions<'a> {
    /// How the planes are found.
    pub builder: Builder,
    /// What a ray is thought to pay.
    pub cost: Cost,
    /// Depth at which every node is a leaf, at most [`MAX_DEPTH`]; `None` for `8 + 1.3 log2 N`.
    pub max_depth: Option<u32>,
    /// Nodes of at most this many references are leaves without a look at their planes. More
    /// makes the tree smaller and the build faster; 0 leaves the decision to the cost alone.
    pub max_leaf: u32,
    /// Whether straddlers get the bounds of their clipped part (they do in the exact tree) or
    /// those of the whole triangle cut at the plane, which is faster to build and slower to trace.
    pub clip: bool,
    /// Threads that build; 0 for one a core. The tree is the same.
    pub threads: usize,
    /// Bytes the build may have allocated at any time, the tree included and the mesh not.
    pub memory_budget: Option<u64>,
    /// Called now and then, from any of the threads, with the fraction that is done.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
    /// When this becomes true the build ends soon with [`BuildError::Cancelled`].
    pub cancel: Option<&'a AtomicBool>,
}

impl Default for BuildOptions<'_> {
    fn default() -> Self {
        Self {
            builder: Builder::default(),
            cost: Cost::default(),
            max_depth: None,
            max_leaf: 0,
            clip: true,
            threads: 0,
            memory_budget: None,
            progress: None,
            cancel: None,
        }
    }
}

impl BuildOptions<'_> {
    /// Refuses options that have no meaning.
    fn check(&self) -> Result<(), BuildError> {
        let refuse =
            |option, value: String, expected| Err(BuildError::Option { option, value, expected });
        // Beyond these, products with counts and areas would leave the range of f32.
        let positive = |value: f32| (1e-6..=1e6).contains(&value);
        if !positive(self.cost.traversal) {
            return refuse("traversal", self.cost.traversal.to_string(), "between 1e-6 and 1e6");
        }
        if !positive(self.cost.intersect) {
            return refuse("intersect", self.cost.intersect.to_string(), "between 1e-6 and 1e6");
        }
        if !(0.0..1.0).contains(&self.cost.empty_bonus) {
            return refuse("empty_bonus", self.cost.empty_bonus.to_string(), "in 0..1");
        }
        match self.max_depth {
            Some(depth) if depth > MAX_DEPTH => {
                refuse("max_depth", depth.to_string(), "at most 255")
            }
            _ => Ok(()),
        }
    }
}

/// What a build took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildReport {
    /// The most bytes the build had allocated at one time, the tree included and the mesh not.
    pub peak_bytes: u64,
}

/// The options as the builders use them: every default resolved.
#[derive(Clone, Copy)]
pub struct Limits {
    /// What a ray is thought to pay.
    pub cost: Cost,
    /// Depth at which every node is a leaf.
    pub max_depth: u32,
    /// Nodes of at most this many references are leaves.
    pub max_leaf: usize,
    pub(super) threads: usize,
    /// Whether straddlers are clipped.
    pub clip: bool,
}

impl Limits {
    /// The options for `mesh`.
    ///
    /// # Errors
    ///
    /// [`BuildError::Option`] names the option that has no meaning.
    pub fn new(mesh: &Mesh, options: &BuildOptions) -> Result<Self, BuildError> {
        options.check()?;
        let default_depth = default_depth(mesh.triangles().len());
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        Ok(Self {
            cost: options.cost,
            max_depth: options.max_depth.unwrap_or(default_depth),
            max_leaf: options.max_leaf as usize,
            threads: if options.threads == 0 { cores() } else { options.threads },
            clip: options.clip,
        })
    }

    /// Bounds of a straddler's part in a child, or `None` if it has none.
    #[must_use]
    pub fn part(&self, triangle: &[[f32; 3]; 3], bounds: &Aabb) -> Option<Aabb> {
        use crate::geometry::clip::{clip, overlap};
        if self.clip { clip(triangle, bounds) } else { overlap(triangle, bounds) }
    }
}

/// `8 + 1.3 log2 N`, rounded \[PH04].
fn default_depth(triangles: usize) -> u32 {
    (8.5 + 1.3 * (triangles.max(1) as f64).log2()) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_depth_is_that_of_the_literature() {
        assert_eq!([0, 1, 2, 69_451, 871_414].map(default_depth), [8, 8, 9, 29, 34]);
    }

    #[test]
    fn costs_without_meaning_are_refused() {
        let cost = Cost { empty_bonus: 1.0, ..Cost::default() };
        let error = BuildOptions { cost, ..BuildOptions::default() }.check().unwrap_err();
        assert_eq!(error.to_string(), "option empty_bonus is 1, which is not in 0..1");
        let cost = Cost { traversal: f32::NAN, ..Cost::default() };
        assert!(BuildOptions { cost, ..BuildOptions::default() }.check().is_err());
    }
}
