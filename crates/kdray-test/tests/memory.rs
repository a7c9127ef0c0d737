//! The memory that a build reports is the memory that it takes: measured at the allocator.
//!
//! One test in a binary of its own, so that nothing else allocates meanwhile.

use kdray::{BuildOptions, Builder, Mesh, Tree};
use kdray_mesh::generate::{soup, torus_knot};
use kdray_test::scenes;
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Reported and measured peak of a build, in bytes over what was there before it.
fn peaks(mesh: &Mesh, options: &BuildOptions) -> [f64; 2] {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let (tree, report) = Tree::build_reported(mesh, options).expect("the options are in range");
    let measured = ALLOCATOR.peak_usage() - before;
    drop(tree);
    [report.peak_bytes as f64, measured as f64]
}

#[test]
fn reported_peaks_are_measured_peaks() {
    let half_a_million = torus_knot([2, 3], 10_000, 25);
    let meshes = [
        ("knot of 500K triangles", half_a_million.mesh().expect("sound"), Some(200.0)),
        ("soup of 50K triangles", soup(50_000, 71).mesh().expect("sound"), None),
        (
            "dense soup of 5K triangles",
            scenes::soup_of_size(5000, 72, 0.3).mesh().expect("sound"),
            None,
        ),
    ];
    let mut wrong = Vec::new();
    for (name, mesh, limit) in meshes {
        for (builder, threads) in [(Builder::Exact, 1), (Builder::Exact, 4), (Builder::Resort, 1)] {
            // Sorting at every node takes long, and smaller meshes show the same.
            if builder == Builder::Resort && mesh.triangles().len() > 100_000 {
                continue;
            }
            let options = BuildOptions { builder, threads, ..BuildOptions::default() };
            let [reported, measured] = peaks(&mesh, &options);
            let per_triangle = measured / mesh.triangles().len() as f64;
            println!(
                "{name}, {builder:?} on {threads}: {reported} reported, {measured} measured, {per_triangle:.0} a triangle"
            );
            if !(0.85..=1.15).contains(&(reported / measured)) {
                wrong.push(format!("{name}, {builder:?} on {threads}: {reported} of {measured}"));
            }
            if builder == Builder::Exact && limit.is_some_and(|limit| per_triangle > limit) {
                wrong.push(format!("{name} on {threads}: {per_triangle:.0} bytes a triangle"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
