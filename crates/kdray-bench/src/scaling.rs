//! Build time against size: the generated scene at doubling counts.

use std::time::Instant;

use anyhow::Result;
use kdray::{BuildOptions, Tree};

use crate::memory;
use crate::record::{Size, Spread};

/// Timed builds of each size.
const PASSES: usize = 3;

/// Builds the showcase scene by kdray at `from`, twice `from`, and so on up to `to` triangles,
/// and hands every size to `done` as soon as it is measured.
pub(crate) fn run(
    from: usize,
    to: usize,
    threads: usize,
    mut done: impl FnMut(&Size),
) -> Result<Vec<Size>> {
    let mut sizes = Vec::new();
    let doubling = |count: &usize| count.checked_mul(2);
    for count in std::iter::successors(Some(from), doubling).take_while(|count| *count <= to) {
        let size = measure(count, threads)?;
        done(&size);
        sizes.push(size);
    }
    Ok(sizes)
}

fn measure(count: usize, threads: usize) -> Result<Size> {
    let mesh = kdray_mesh::generate::showcase(count).mesh()?;
    let options = BuildOptions { threads, ..BuildOptions::default() };
    let (tree, memory) = memory::measure(|| Tree::build(&mesh, &options));
    drop(tree?);
    let mut seconds = Vec::new();
    for _ in 0..PASSES {
        let start = Instant::now();
        let tree = Tree::build(&mesh, &options)?;
        seconds.push(start.elapsed().as_secs_f64());
        drop(tree);
    }
    let seconds = Spread::of_seconds(&seconds).expect("there is at least one pass");
    Ok(Size { triangles: mesh.triangles().len(), threads, seconds, memory })
}
