//! The tracer gives what trying every triangle gives: the same triangle, and t, u, v bit for bit.

use std::ops::Range;

use kdray::{BuildOptions, Hit, Mesh, Ray, Tracer, Tree};
use kdray_test::rays::RayMaker;
use kdray_test::{Scene, oracle, presets, scenes, shared};
use rayon::prelude::*;

/// Triangle tests that the brute force may spend on one tree of a scene.
const TESTS: usize = 12_000_000;
/// Rays for one tree of a scene: as many as the tests allow, within these.
const RAYS: std::ops::RangeInclusive<usize> = 4_000..=12_000;

fn bits(hit: Option<Hit>) -> Option<(u32, [u32; 3])> {
    hit.map(|hit| (hit.triangle, [hit.t, hit.u, hit.v].map(f32::to_bits)))
}

/// Says what is wrong with the answers for a ray.
fn mistake(mesh: &Mesh, tracer: &Tracer, ray: &Ray) -> Option<String> {
    let (found, wanted) = (tracer.closest_hit(ray), oracle::closest_hit(mesh, ray));
    if bits(found) != bits(wanted) {
        return Some(format!("{ray:?}: closest {found:?} instead of {wanted:?}"));
    }
    let (counted, _) = tracer.closest_hit_counted(ray);
    if bits(counted) != bits(wanted) {
        return Some(format!("{ray:?}: counted {counted:?} instead of {wanted:?}"));
    }
    let any = tracer.any_hit(ray);
    (any != wanted.is_some()).then(|| format!("{ray:?}: any {any}, closest {wanted:?}"))
}

/// Mistakes among `count` rays.
fn mistakes(
    name: &str,
    mesh: &Mesh,
    options: &BuildOptions,
    count: usize,
    mut ray: impl FnMut(&mut RayMaker) -> Ray,
) -> Vec<String> {
    let tree = Tree::build(mesh, options).expect("the options are in range");
    let tracer = Tracer::new(mesh, &tree);
    let mut maker = RayMaker::new(mesh, &tree, 1);
    let rays: Vec<Ray> = (0..count).map(|_| ray(&mut maker)).collect();
    let wrong: Vec<String> =
        rays.par_iter().filter_map(|ray| mistake(mesh, &tracer, ray)).collect();
    let total = wrong.len();
    let sentence = |mistake: &String| format!("{name}: {total} of {count}: {mistake}");
    wrong.iter().take(2).map(sentence).collect()
}

#[test]
fn every_scene_as_brute_force() {
    let mut wrong = Vec::new();
    let mut traced = 0;
    for Scene { name, mesh, .. } in scenes::all() {
        let count = (TESTS / mesh.triangles().len().max(1)).clamp(*RAYS.start(), *RAYS.end());
        for (preset, options) in presets::few() {
            let name = format!("{name}, {preset}");
            wrong.extend(mistakes(&name, &mesh, &options, count, |maker| maker.any()));
            traced += count;
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(traced >= 1_000_000, "{traced} rays");
}

fn assert_directions(exponents: &Range<f64>) {
    let mut wrong = Vec::new();
    for Scene { name, mesh, .. } in scenes::ordinary() {
        let ray = |maker: &mut RayMaker| maker.scaled(exponents);
        wrong.extend(mistakes(&name, &mesh, &BuildOptions::default(), 4000, ray));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Directions need not have unit length: `t` is in units of it.
#[test]
fn directions_of_any_length() {
    assert_directions(&(-20.0..20.0));
}

/// So short that `t` overflows at some hits.
#[test]
fn directions_near_the_smallest_number() {
    assert_directions(&(-38.0..-20.0));
}

/// So long that `t` underflows at most hits.
#[test]
fn directions_near_the_largest_number() {
    assert_directions(&(20.0..37.0));
}

/// Every hit, the only one in the interval: its leaf must be visited for its `t`.
#[test]
fn intervals_of_one_hit() {
    let mut wrong = Vec::new();
    for Scene { name, mesh, .. } in scenes::all() {
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
        let tracer = Tracer::new(&mesh, &tree);
        let mut maker = RayMaker::new(&mesh, &tree, 4);
        let rays: Vec<Ray> = (0..3000).map(|_| maker.line()).collect();
        let lost = |ray: &Ray| {
            let missed = |hit: &Hit| !tracer.any_hit(&Ray { t_min: hit.t, t_max: hit.t, ..*ray });
            let hit = oracle::hits(&mesh, ray).find(missed)?;
            Some(format!("{name}: {ray:?} lost {hit:?}"))
        };
        let lost: Vec<String> = rays.par_iter().filter_map(lost).collect();
        wrong.extend(lost.first().map(|first| format!("{} rays, such as {first}", lost.len())));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn bunny_as_brute_force() {
    let Some(mesh) = shared::mesh("bunny.ply") else { return };
    let wrong = mistakes("bunny", &mesh, &BuildOptions::default(), 10_000, |maker| maker.any());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn batches_as_single_rays() {
    let mesh = kdray_mesh::generate::torus_knot([2, 3], 90, 6).mesh().expect("sound");
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
    let tracer = Tracer::new(&mesh, &tree);
    let mut maker = RayMaker::new(&mesh, &tree, 2);
    for count in [0, 1, 7, 1024, 5000] {
        let rays: Vec<Ray> = (0..count).map(|_| maker.any()).collect();
        let (mut hits, mut any) = (vec![None; count], vec![false; count]);
        tracer.closest_hits(&rays, &mut hits);
        tracer.any_hits(&rays, &mut any);
        for (index, ray) in rays.iter().enumerate() {
            assert_eq!(bits(hits[index]), bits(tracer.closest_hit(ray)), "{ray:?}");
            assert_eq!(any[index], tracer.any_hit(ray), "{ray:?}");
        }
    }
}

/// A tree from a file traces like the tree that was saved.
#[test]
fn trees_from_files_trace_alike() {
    let mesh = scenes::lattice_soup(300, 4, 4).mesh().expect("sound");
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
    let opened = Tree::from_bytes(&tree.to_bytes()).expect("just written");
    let (one, other) = (Tracer::new(&mesh, &tree), Tracer::new(&mesh, &opened));
    let mut maker = RayMaker::new(&mesh, &tree, 3);
    for _ in 0..2000 {
        let ray = maker.any();
        assert_eq!(bits(one.closest_hit(&ray)), bits(other.closest_hit(&ray)), "{ray:?}");
    }
}
