//! All hits of a ray, in order and each once, are what trying every triangle gives.

use kdray::{BuildOptions, Hit, Mesh, Ray, Tracer, Tree};
use kdray_test::rays::RayMaker;
use kdray_test::{Scene, oracle, scenes, shared};
use rayon::prelude::*;

/// Triangle tests that the brute force may spend on a scene.
const TESTS: usize = 8_000_000;

fn key(hit: &Hit) -> (u32, u32) {
    (hit.triangle, hit.t.to_bits())
}

/// Says what is wrong with the answers for a ray.
fn mistake(mesh: &Mesh, tracer: &Tracer, ray: &Ray) -> Option<String> {
    let wanted = oracle::all_hits(mesh, ray);
    let mut found = Vec::new();
    tracer.all_hits(ray, &mut found);
    let keys = |hits: &[Hit]| hits.iter().map(key).collect::<Vec<_>>();
    if keys(&found) != keys(&wanted) {
        return Some(format!("{ray:?}: {found:?} instead of {wanted:?}"));
    }
    if tracer.count_hits(ray) != wanted.len() {
        return Some(format!("{ray:?}: {} counted", tracer.count_hits(ray)));
    }
    for limit in [0, 1, 2, 5] {
        tracer.first_hits(ray, limit, &mut found);
        if keys(&found) != keys(&wanted[..limit.min(wanted.len())]) {
            return Some(format!("{ray:?}: first {limit} {found:?} of {wanted:?}"));
        }
    }
    // Without the first triangle, the second hit is the closest.
    let first = wanted.first()?.triangle;
    let second = tracer.only(|triangle| triangle != first).closest_hit(ray);
    let is_second = second.as_ref().map(key) == wanted.get(1).map(key);
    (!is_second).then(|| format!("{ray:?}: {second:?} behind {first} of {wanted:?}"))
}

fn assert_right(name: &str, mesh: &Mesh, count: usize) {
    let tree = Tree::build(mesh, &BuildOptions::default()).expect("the options are in range");
    let tracer = Tracer::new(mesh, &tree);
    let mut maker = RayMaker::new(mesh, &tree, 11);
    let rays: Vec<Ray> = (0..count).map(|_| maker.any()).collect();
    let wrong: Vec<String> =
        rays.par_iter().filter_map(|ray| mistake(mesh, &tracer, ray)).collect();
    assert!(wrong.is_empty(), "{name}: {} of {count}: {}", wrong.len(), wrong[0]);
}

#[test]
fn every_scene_as_brute_force() {
    for Scene { name, mesh, .. } in scenes::all() {
        let count = (TESTS / mesh.triangles().len().max(1)).clamp(1_000, 8_000);
        assert_right(&name, &mesh, count);
    }
}

#[test]
fn scans_as_brute_force() {
    for name in ["bunny.ply", "self_intersect.ply", "gears.ply", "happy_res4.ply"] {
        let Some(mesh) = shared::mesh(name) else { return };
        assert_right(name, &mesh, 1_000);
    }
}

/// A line enters a closed mesh as often as it leaves it, in turn.
#[test]
fn lines_enter_and_leave_in_turn() {
    for Scene { name, mesh, .. } in scenes::closed() {
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
        let tracer = Tracer::new(&mesh, &tree);
        let mut maker = RayMaker::new(&mesh, &tree, 12);
        let mut hits = Vec::new();
        for _ in 0..4_000 {
            let ray = Ray { t_min: f32::NEG_INFINITY, ..maker.line() };
            tracer.all_hits(&ray, &mut hits);
            assert!(hits.len().is_multiple_of(2), "{name}: {} hits of {ray:?}", hits.len());
        }
    }
}
