//! How often a mesh winds around a point: the generalised winding number \[JKS13].
//!
//! It is the sum of the solid angles of all triangles over that of the whole sphere: an integer
//! off a closed surface, and a sensible number in between for a surface with holes. `cluster`
//! arranges the triangles in clusters of clusters, each of which knows what it looks like from
//! afar, in the manner of \[BDS+18], and how wrong that may be. `angle` sums the exact angles of
//! triangles. Near clusters are opened, far ones taken as a whole.

mod angle;
mod cluster;

use crate::geometry::Mesh;
use angle::{Fan, Turns};
use cluster::{Child, Cluster};

/// The winding numbers of a mesh. Owns what it needs; share it between threads.
///
/// About 100 bytes a triangle ([`Winding::size_bytes`]), besides those of a tracer, which does not
/// need it.
///
/// ```
/// use kdray::{Mesh, Winding};
///
/// // A tetrahedron without its floor.
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let mesh = Mesh::new(&corners, &[[0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let winding = Winding::new(&mesh);
/// assert!(winding.number([0.2, 0.2, 0.2], 1e-3) > 0.7);
/// assert!(winding.contains([0.2, 0.2, 0.2]) && !winding.contains([0.2, 0.2, -0.2]));
/// # Ok::<(), kdray::MeshError>(())
/// ```
pub struct Winding {
    clusters: Vec<Cluster>,
    fans: Vec<Fan>,
}

/// Clusters off by at most this are taken as a whole by [`Winding::contains`], at first. More
/// makes the sums shorter, and more of them have to be made again.
const COARSE: f64 = 1.0 / 64.0;

/// Below this, clusters are opened down to the triangles.
const FINEST: f64 = 1e-8;

/// A cluster is opened into at most eight, and there are no more levels than this.
const STACK: usize = 7 * 12 + 8;

impl Winding {
    /// Winding numbers of `mesh`. Takes O(N log N).
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let (clusters, fans) = cluster::arrange(mesh);
        Self { clusters, fans }
    }

    /// How often the mesh winds around `point`, off by at most `tolerance`: 1 inside a closed mesh
    /// whose triangles are counter-clockwise as seen from outside, 0 outside.
    ///
    /// The tolerance is kept, not hoped for: every cluster that is taken as a whole comes with a
    /// bound of its error, and where the bounds add up to more than `tolerance` smaller ones are
    /// taken. With zero it is the sum over all triangles. On the surface the number jumps and may
    /// be anything between. A point that is not finite has the number zero.
    #[must_use]
    pub fn number(&self, point: [f32; 3], tolerance: f64) -> f64 {
        let mut coarsest = tolerance / 16.0;
        loop {
            let (number, error) = self.sum(point, coarsest);
            // Exact sums have no error, and nothing is within a tolerance of NaN.
            if error <= tolerance || coarsest == 0.0 {
                return number;
            }
            // Half as many clusters are half as wrong when each is off by four times less.
            coarsest = finer(coarsest, (tolerance / error).powi(2));
        }
    }

    /// Whether `point` is inside: whether the mesh winds around it more than half a time, whichever
    /// way it is wound. The answer is that of the sum over all triangles, roundings of doubles
    /// aside.
    #[must_use]
    pub fn contains(&self, point: [f32; 3]) -> bool {
        let mut coarsest = COARSE;
        loop {
            let (number, error) = self.sum(point, coarsest);
            let above = number.abs() - 0.5;
            if error < above.abs() || coarsest == 0.0 {
                return above > 0.0;
            }
            coarsest = finer(coarsest, 0.125);
        }
    }

    /// Bytes that it holds.
    #[must_use]
    pub fn size_bytes(&self) -> usize {
        size_of_val(&self.clusters[..]) + size_of_val(&self.fans[..])
    }

    /// The winding number and a bound of its error, where clusters that are off by at most
    /// `coarsest` are taken as a whole.
    fn sum(&self, point: [f32; 3], coarsest: f64) -> (f64, f64) {
        if !point.iter().all(|value| value.is_finite()) {
            return (0.0, 0.0);
        }
        let point = point.map(f64::from);
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { self.sum_avx2(point, coarsest) };
        }
        self.sum_with(point, coarsest)
    }

    /// [`Self::sum_with`], compiled for several lanes at once: the same arithmetic.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn sum_avx2(&self, point: [f64; 3], coarsest: f64) -> (f64, f64) {
        self.sum_with(point, coarsest)
    }

    #[inline(always)]
    fn sum_with(&self, point: [f64; 3], coarsest: f64) -> (f64, f64) {
        let (mut far, mut error) = (0.0, 0.0);
        let mut near = Turns::default();
        let mut stack = [0_u32; STACK];
        let mut height = usize::from(!self.clusters.is_empty());
        while height > 0 {
            height -= 1;
            let cluster = &self.clusters[stack[height] as usize];
            let (numbers, errors) = cluster.seen_from(point);
            for place in 0..8 {
                if errors[place] <= coarsest {
                    far += numbers[place];
                    error += errors[place];
                    continue;
                }
                match cluster.child(place) {
                    Child::Nothing => {}
                    Child::Fan(index) => near.add(&self.fans[index], point),
                    Child::Cluster(index) => {
                        stack[height] = index;
                        height += 1;
                    }
                }
            }
        }
        (far + near.number(), error)
    }
}

/// A lower threshold, or zero.
fn finer(coarsest: f64, factor: f64) -> f64 {
    let finer = coarsest * factor.clamp(1e-3, 0.5);
    if finer > FINEST { finer } else { 0.0 }
}
