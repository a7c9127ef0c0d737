//! A mesh with its tree, and what answers queries over them on the CPU.

use std::sync::OnceLock;

use kdray::{Mesh, Sign, Tracer, Tree, Winding};
use rayon::prelude::*;

/// What a tree of Python is about, on whatever device.
pub(crate) struct Scene {
    pub(crate) mesh: Mesh,
    pub(crate) tree: Tree,
    tracer: OnceLock<Tracer>,
    winding: OnceLock<Winding>,
    equal_triangles: OnceLock<f64>,
}

impl Scene {
    pub(crate) fn new(mesh: Mesh, tree: Tree) -> Self {
        Self {
            mesh,
            tree,
            tracer: OnceLock::new(),
            winding: OnceLock::new(),
            equal_triangles: OnceLock::new(),
        }
    }

    /// The tree as the tracer has it; made with the first query on the CPU.
    pub(crate) fn tracer(&self) -> &Tracer {
        made(&self.tracer, || Tracer::new(&self.mesh, &self.tree))
    }

    pub(crate) fn winding(&self) -> &Winding {
        made(&self.winding, || Winding::new(&self.mesh))
    }

    /// How many triangles of one size would be as hard to hit twice: one over the probability that two
    /// places of the surface are on one triangle.
    pub(crate) fn equal_triangles(&self) -> f64 {
        *made(&self.equal_triangles, || {
            let area = |triangle: usize| {
                let [a, b, c] = self.mesh.triangle(triangle);
                let [u, v] = [b, c].map(|p| [0, 1, 2].map(|axis| f64::from(p[axis] - a[axis])));
                let cross = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| u[i] * v[j] - u[j] * v[i]);
                cross.iter().map(|it| it * it).sum::<f64>().sqrt()
            };
            let areas = (0..self.mesh.triangles().len()).into_par_iter().map(area);
            let sums = areas.map(|it| (it, it * it));
            let (sum, squares) = sums.reduce(|| (0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            if squares > 0.0 { sum * sum / squares } else { f64::INFINITY }
        })
    }

    pub(crate) fn sign(&self, winding: bool) -> Sign<'_> {
        if winding { Sign::Winding(self.winding()) } else { Sign::Parity }
    }
}

/// What is in `cell`, made if there is nothing.
///
/// Threads that ask for it at the same time all make it. They cannot wait for the first of them: a
/// thread of a pool that waits takes up other work, which could be to wait for what it is making.
fn made<T>(cell: &OnceLock<T>, make: impl FnOnce() -> T) -> &T {
    if let Some(there) = cell.get() {
        return there;
    }
    let made = make();
    cell.get_or_init(|| made)
}
