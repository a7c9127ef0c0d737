//! What grows with the scene, and how fast: in counts, which are the same on every machine.

use kdray::{BuildOptions, Counts, Mesh, Tracer, Tree};
use kdray_mesh::generate::{sphere, torus_knot};
use kdray_test::rays::RayMaker;
use kdray_test::scenes;

/// What a scene costs.
struct Costs {
    triangles: f64,
    /// References a triangle.
    references: f64,
    /// Bytes a triangle at the peak of the build.
    peak: f64,
    depth: f64,
    /// Wide nodes and blocks a ray.
    steps: f64,
    tests: f64,
}

const RAYS: u32 = 5000;

fn costs(mesh: &Mesh) -> Costs {
    let options = BuildOptions { threads: 1, ..BuildOptions::default() };
    let (tree, report) = Tree::build_reported(mesh, &options).expect("the options are in range");
    let tracer = Tracer::new(mesh, &tree);
    let mut maker = RayMaker::new(mesh, &tree, 81);
    let mut sum = Counts::default();
    for _ in 0..RAYS {
        let (_, counts) = tracer.closest_hit_counted(&maker.line());
        sum.steps += counts.steps;
        sum.tests += counts.tests;
    }
    let triangles = mesh.triangles().len() as f64;
    Costs {
        triangles,
        references: tree.references().len() as f64 / triangles,
        peak: report.peak_bytes as f64 / triangles,
        depth: tree.stats().depth.into(),
        steps: f64::from(sum.steps) / f64::from(RAYS),
        tests: f64::from(sum.tests) / f64::from(RAYS),
    }
}

/// From a thousand to eighty thousand triangles and more, every time four times as many.
fn series() -> Vec<(&'static str, Vec<Costs>)> {
    let spheres = [3, 4, 5, 6].map(|level| costs(&sphere(level).mesh().expect("sound")));
    let knots =
        [1, 2, 4, 8].map(|n| costs(&torus_knot([2, 3], 60 * n, 8 * n).mesh().expect("sound")));
    let soups = [1, 4, 16].map(|n| {
        let size = 0.1 / f64::from(n).cbrt();
        costs(&scenes::soup_of_size(1000 * n as usize, 82, size).mesh().expect("sound"))
    });
    vec![("sphere", spheres.into()), ("knot", knots.into()), ("soup", soups.into())]
}

#[test]
fn costs_grow_slowly() {
    for (name, series) in series() {
        for pair in series.windows(2) {
            let [small, large] = pair else { unreachable!("windows of two") };
            let at = format!("{name} of {} triangles", large.triangles);
            // Four times the triangles are two levels more of a balanced tree.
            assert!(
                large.depth <= small.depth + 8.0,
                "{at}: depth {} {}",
                small.depth,
                large.depth
            );
            assert!(
                large.steps <= 1.6 * small.steps + 2.0,
                "{at}: steps {} {}",
                small.steps,
                large.steps
            );
            assert!(
                large.tests <= 1.6 * small.tests + 2.0,
                "{at}: tests {} {}",
                small.tests,
                large.tests
            );
            assert!(
                large.references <= 1.25 * small.references,
                "{at}: {} references a triangle",
                large.references
            );
            assert!(large.peak <= 1.25 * small.peak, "{at}: {} bytes a triangle", large.peak);
        }
        let last = series.last().expect("there are scenes");
        assert!(last.references < 8.0, "{name}: {} references a triangle", last.references);
    }
}
