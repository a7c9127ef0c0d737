//! What a mesh and its tree know for queries.

use std::sync::OnceLock;
use std::sync::atomic::AtomicUsize;

use super::grid::Grid;
use super::only::Only;
use super::simd::Best;
use super::tilt::{Tilt, tilts};
use super::traverse::{Trip, Visitor, traverse};
use crate::geometry::{Aabb, Hit, Mesh, Ray};
use crate::tree::Tree;

/// Answers queries over a mesh and its tree. Owns what it needs; share it between threads.
///
/// Copies triangles in leaf order, eight to a block: [`Tracer::size_bytes`] says what that takes.
/// The first query for a closest point or for what is within a sphere makes what such queries need
/// besides: about a sixth more memory, and some milliseconds for 100,000 triangles. Batches that
/// ask whether many points are inside make a grid of cells of which that is known: four bytes a
/// triangle, and a hundred while it is made.
pub struct Tracer {
    pub(super) trip: Trip,
    pub(super) bounds: Aabb,
    pub(super) triangle_count: usize,
    /// Made when first asked for.
    tilts: OnceLock<Vec<Tilt>>,
    /// Made when so many points have been asked whether they are inside that it is worth it, if
    /// then.
    pub(super) grid: OnceLock<Option<Grid>>,
    /// How many have been.
    pub(super) points_asked: AtomicUsize,
}

/// What a ray met on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Wide nodes: eight descendants of a node of the tree each.
    pub steps: u32,
    /// Leaves that have references.
    pub leaves: u32,
    /// Blocks of up to eight triangles.
    pub tests: u32,
}

impl Tracer {
    /// A tracer for `mesh` through its `tree`.
    ///
    /// # Panics
    ///
    /// If the tree is of another number of triangles.
    #[must_use]
    pub fn new(mesh: &Mesh, tree: &Tree) -> Self {
        assert_eq!(mesh.triangles().len(), tree.triangle_count(), "the tree is of another mesh");
        Self {
            trip: Trip::new(mesh, tree, Best::detect()),
            bounds: tree.bounds(),
            triangle_count: tree.triangle_count(),
            tilts: OnceLock::new(),
            grid: OnceLock::new(),
            points_asked: AtomicUsize::new(0),
        }
    }

    /// Queries that see only the triangles for which `accept` holds: a visibility mask, or
    /// everything but the triangle that a ray starts on.
    ///
    /// ```
    /// use kdray::{BuildOptions, Mesh, Ray, Tracer, Tree};
    ///
    /// let stack = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0],
    ///              [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// let mesh = Mesh::new(&stack, &[[0, 1, 2], [3, 4, 5]])?;
    /// let tracer = Tracer::new(&mesh, &Tree::build(&mesh, &BuildOptions::default())?);
    /// // Starts on triangle 0, which therefore does not count: no epsilon is needed.
    /// let ray = Ray::new([0.25, 0.25, 0.0], [0.0, 0.0, 1.0]);
    /// let hit = tracer.only(|triangle| triangle != 0).closest_hit(&ray).unwrap();
    /// assert_eq!(hit.triangle, 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn only<F: Fn(u32) -> bool>(&self, accept: F) -> Only<'_, F> {
        Only::new(self, accept)
    }

    fn all(&self) -> Only<'_, impl Fn(u32) -> bool + use<>> {
        self.only(|_| true)
    }

    /// The first triangle along the ray; of several at one `t` the one with the lowest index.
    ///
    /// Exactly the hit that [`intersect`](super::intersect()) gives for that triangle. Watertight:
    /// no ray slips between triangles that share an edge. \[PH04], \[WBA13]
    ///
    /// Fastest for a ray that goes like the one before it. Many that go another way each are mostly answered
    /// faster by [`Tracer::batch`].
    #[inline]
    #[must_use]
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.all().closest_hit(ray)
    }

    /// [`Tracer::closest_hit`], and what it took.
    #[must_use]
    pub fn closest_hit_counted(&self, ray: &Ray) -> (Option<Hit>, Counts) {
        self.all().closest_hit_counted(ray)
    }

    /// Whether anything is hit.
    #[inline]
    #[must_use]
    pub fn any_hit(&self, ray: &Ray) -> bool {
        self.all().any_hit(ray)
    }

    /// The first `limit` hits along the ray, in `hits`, in order of `t` and then of the triangle.
    /// What was in `hits` before is lost; its memory is used again.
    ///
    /// Each crossing comes once, however many leaves its triangle is in.
    pub fn first_hits(&self, ray: &Ray, limit: usize, hits: &mut Vec<Hit>) {
        self.all().first_hits(ray, limit, hits);
    }

    /// All hits along the ray, as [`Tracer::first_hits`] without a limit.
    ///
    /// The number of hits along a line through a closed mesh is even, whatever edges and vertices
    /// the line passes through.
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        self.all().all_hits(ray, hits);
    }

    /// How many triangles the ray hits.
    #[must_use]
    pub fn count_hits(&self, ray: &Ray) -> usize {
        self.all().count_hits(ray)
    }

    /// The vector instructions that this processor lets queries use: `avx512`, `avx2`,
    /// `neon` or `none`.
    #[must_use]
    pub fn simd() -> &'static str {
        Best::detect().name()
    }

    /// Bytes that the tracer holds.
    #[must_use]
    pub fn size_bytes(&self) -> usize {
        let tilts = self.tilts.get().map_or(0, |tilts| size_of_val(&tilts[..]));
        let grid = self.grid.get().and_then(Option::as_ref).map_or(0, Grid::size_bytes);
        self.trip.layout.size_bytes() + tilts + grid
    }

    /// What queries of points need besides.
    pub(super) fn tilts(&self) -> &[Tilt] {
        // On this thread alone: others of its pool may wait for it.
        self.tilts.get_or_init(|| tilts(&self.trip.layout))
    }

    /// Shows what lies along the ray from front to back.
    #[inline]
    pub(super) fn visit(&self, ray: &Ray, visitor: &mut impl Visitor) {
        traverse(&self.trip, ray, visitor);
    }
}
