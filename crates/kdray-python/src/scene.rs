//! A mesh with its tree, and what answers queries over them on the CPU.

use std::sync::OnceLock;

use kdray::{Mesh, Sign, Tracer, Tree, Winding};

/// What a tree of Python is about, on whatever device.
pub(crate) struct Scene {
    pub(crate) mesh: Mesh,
    pub(crate) tree: Tree,
    tracer: OnceLock<Tracer>,
    winding: OnceLock<Winding>,
}

impl Scene {
    pub(crate) fn new(mesh: Mesh, tree: Tree) -> Self {
        Self { mesh, tree, tracer: OnceLock::new(), winding: OnceLock::new() }
    }

    /// The tree as the tracer has it; made with the first query on the CPU.
    pub(crate) fn tracer(&self) -> &Tracer {
        made(&self.tracer, || Tracer::new(&self.mesh, &self.tree))
    }

    pub(crate) fn winding(&self) -> &Winding {
        made(&self.winding, || Winding::new(&self.mesh))
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
