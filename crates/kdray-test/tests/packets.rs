//! Rays that go the same way are answered in packets, and each as it is alone.

use std::ops::ControlFlow;

use kdray::{BatchOptions, BuildOptions, Hit, Lists, Ray, Tracer, Tree};
use kdray_test::random::Random;
use kdray_test::rays::RayMaker;
use kdray_test::scenes;

/// Rays of a bundle: some packets, and some rays more.
const RAYS: usize = 61;

/// Bundles a scene.
const BUNDLES: usize = 400;

/// Rays about `ray`: from its origin or from beside it, by so much.
fn bundle(ray: Ray, random: &mut Random, spread: [f64; 2]) -> Vec<Ray> {
    let size = |v: [f32; 3]| v.iter().fold(0.0, |size: f32, v| v.abs().max(size));
    let sizes = [size(ray.origin).max(1e-3), size(ray.direction)];
    let length = random.pick(&[1.0, 0.01, 100.0]);
    let mut beside = |v: [f32; 3], which: usize| {
        let step = spread[which] as f32 * sizes[which];
        v.map(|v| v + step * random.between(-1.0, 1.0) as f32)
    };
    let one = |index: usize| {
        let stretch = if index % 7 == 3 { length } else { 1.0 };
        let direction = beside(ray.direction, 1).map(|v| v * stretch);
        Ray { origin: beside(ray.origin, 0), direction, ..ray }
    };
    (0..RAYS).map(one).collect()
}

fn as_alone(name: &str, tracer: &Tracer, rays: &[Ray]) -> usize {
    let (mut closest, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    tracer.closest_hits(rays, &mut closest);
    tracer.any_hits(rays, &mut any);
    let batch = tracer.batch(BatchOptions::default()).expect("no threads are started");
    let (mut counts, mut lists) = (vec![0; rays.len()], Vec::new());
    batch.count_hits(rays, &mut counts).expect("nobody cancels");
    let collect = |found: Lists<Hit>| {
        lists.extend(found.lists().map(<[Hit]>::to_vec));
        ControlFlow::Continue(())
    };
    batch.all_hits(rays, collect).expect("nobody cancels");
    let mut all = Vec::new();
    let bits = |hit: Hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle];
    for (index, ray) in rays.iter().enumerate() {
        let alone = tracer.closest_hit(ray);
        assert_eq!(alone.map(bits), closest[index].map(bits), "{name}: ray {index} of {rays:?}");
        assert_eq!(tracer.any_hit(ray), any[index], "{name}: ray {index} of {rays:?}");
        tracer.all_hits(ray, &mut all);
        assert_eq!(all, lists[index], "{name}: ray {index} of {rays:?}");
        assert_eq!(all.len(), counts[index] as usize, "{name}: ray {index} of {rays:?}");
    }
    closest.iter().flatten().count()
}

#[test]
fn bundles_on_every_scene() {
    let mut random = Random::new(77);
    let mut hits = 0;
    for scene in scenes::all() {
        let tree = Tree::build(&scene.mesh, &BuildOptions::default()).expect("sound options");
        let tracer = Tracer::new(&scene.mesh, &tree);
        let mut maker = RayMaker::new(&scene.mesh, &tree, 78);
        for index in 0..BUNDLES {
            let spread = random.pick(&[[0.0, 0.0], [0.0, 1e-3], [1e-3, 0.0], [0.02, 0.05]]);
            let ray = if index % 3 == 0 { maker.line() } else { maker.any() };
            hits += as_alone(&scene.name, &tracer, &bundle(ray, &mut random, spread));
        }
    }
    assert!(hits > 10_000, "only {hits} hits");
}

/// A camera whose picture is of vertices and edges, with rays left out and of limited length.
#[test]
fn rays_through_vertices_and_of_no_meaning() {
    let mut random = Random::new(79);
    let mut hits = 0;
    for scene in scenes::ordinary() {
        let tree = Tree::build(&scene.mesh, &BuildOptions::default()).expect("sound options");
        let tracer = Tracer::new(&scene.mesh, &tree);
        let bounds = scene.mesh.bounds();
        let eye = [0, 1, 2].map(|axis| bounds.upper[axis] + 2.0 * bounds.extent()[axis].max(0.1));
        let positions = scene.mesh.positions();
        let first = random.below(positions.len().max(1));
        let aimed = |index: usize| {
            let target = positions.get((first + index) % positions.len().max(1));
            let target = target.copied().unwrap_or_default();
            let ray = Ray::new(eye, [0, 1, 2].map(|axis| target[axis] - eye[axis]));
            match index % 11 {
                4 => Ray { direction: [f32::NAN; 3], ..ray },
                5 => Ray { t_max: 0.99, ..ray },
                6 => Ray { t_min: 1.0, ..ray },
                7 => Ray { t_min: 1.0, t_max: 1.0, ..ray },
                _ => ray,
            }
        };
        hits += as_alone(&scene.name, &tracer, &(0..2_000).map(aimed).collect::<Vec<_>>());
    }
    assert!(hits > 10_000, "only {hits} hits");
}
