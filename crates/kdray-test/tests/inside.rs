//! Whether points are inside, asked together: by cells without a surface, and by rays in the
//! others.

use kdray::{BatchOptions, BuildOptions, Sign, Tracer, Tree};
use kdray_mesh::generate::sphere;
use kdray_test::rays::RayMaker;
use kdray_test::{Random, Scene, scenes, shared};

/// Points anywhere in the bounds and around them, and where rays would start from and go to.
fn points_of(scene: &Scene, tree: &Tree) -> Vec<[f32; 3]> {
    let bounds = scene.mesh.bounds();
    let (mut random, mut maker) = (Random::new(31), RayMaker::new(&scene.mesh, tree, 32));
    let anywhere = |random: &mut Random| {
        let place = random.point();
        [0, 1, 2].map(|axis| {
            let [lower, upper] = [bounds.lower[axis], bounds.upper[axis]];
            lower + (0.5 + 0.55 * place[axis] as f32) * (upper - lower)
        })
    };
    // A plane of cells, if there is a power of two of them.
    let even = |[x, y, z]: [f32; 3], random: &mut Random| {
        let part = random.below(33) as f32 / 32.0;
        let along =
            |axis: usize| bounds.lower[axis] + part * (bounds.upper[axis] - bounds.lower[axis]);
        match random.below(3) {
            0 => [along(0), y, z],
            1 => [x, along(1), z],
            _ => [x, y, along(2)],
        }
    };
    let count = scene.mesh.triangles().len().max(3000);
    (0..count)
        .flat_map(|_| {
            let here = anywhere(&mut random);
            [here, even(here, &mut random), maker.line().origin, maker.target()]
        })
        .collect()
}

fn tracer_of(scene: &Scene) -> (Tree, Tracer) {
    let tree =
        Tree::build(&scene.mesh, &BuildOptions::default()).expect("the options are in range");
    let tracer = Tracer::new(&scene.mesh, &tree);
    (tree, tracer)
}

#[test]
fn together_as_alone() {
    let scan =
        |name: &str| Some(Scene { name: name.into(), mesh: shared::mesh(name)?, is_closed: false });
    let scans = ["happy_res4.ply", "teapot.ply"].into_iter().filter_map(scan);
    for scene in scenes::all().chain(scenes::closed()).chain(scans) {
        let (tree, tracer) = tracer_of(&scene);
        let points = points_of(&scene, &tree);
        for threads in [0, 2] {
            let options = BatchOptions { threads, ..BatchOptions::default() };
            let mut inside = vec![false; points.len()];
            let batch = tracer.batch(options).expect("two threads");
            batch.contains(&points, Sign::Parity, &mut inside).expect("nobody cancels");
            for (point, inside) in points.iter().zip(inside) {
                assert_eq!(tracer.contains(*point), inside, "{}: {point:?}", scene.name);
            }
        }
    }
}

/// Cells take memory, so they are made when enough points have been asked.
#[test]
fn a_few_points_make_no_cells() {
    let scene = Scene::closed("sphere", &sphere(4));
    let (tree, tracer) = tracer_of(&scene);
    let points = points_of(&scene, &tree);
    let batch = tracer.batch(BatchOptions::default()).expect("no threads are started");
    let ask = |points: &[[f32; 3]]| {
        let mut inside = vec![false; points.len()];
        batch.contains(points, Sign::Parity, &mut inside).expect("nobody cancels");
        tracer.size_bytes()
    };
    let before = tracer.size_bytes();
    assert_eq!(ask(&points[..100]), before);
    let after = ask(&points);
    let triangles = scene.mesh.triangles().len();
    assert!(after > before && after - before < 6 * triangles, "{before} {after} {triangles}");
    assert_eq!(ask(&points), after);
}
