//! The leaves along a ray come in order, and hold its hits.

use std::ops::ControlFlow;

use kdray::trace::intersect;
use kdray::{BuildOptions, Hit, Mesh, Ray, Tracer, Tree};
use kdray_test::rays::RayMaker;
use kdray_test::{Scene, oracle, scenes};

fn key(hit: &Hit) -> (u32, u32) {
    (hit.triangle, hit.t.to_bits())
}

fn check(name: &str, mesh: &Mesh, tracer: &Tracer, ray: &Ray) {
    let (mut last, mut covered) = (ray.t_min, Vec::new());
    tracer.visit_leaves(ray, |leaf| {
        assert!(last <= leaf.t_min && leaf.t_min <= leaf.t_max, "{name}: {ray:?}");
        assert!(leaf.t_max <= ray.t_max, "{name}: {ray:?}");
        last = leaf.t_min;
        let triangles: Vec<u32> = leaf.triangles().collect();
        let mut once = triangles.clone();
        once.sort_unstable();
        assert!(!once.is_empty() && once.is_sorted_by(|a, b| a < b), "{triangles:?}");
        let hit = |triangle: &u32| intersect(ray, *triangle, &mesh.triangle(*triangle as usize));
        let inside = |hit: &Hit| (leaf.t_min..=leaf.t_max).contains(&hit.t);
        covered.extend(triangles.iter().filter_map(hit).filter(inside));
        ControlFlow::Continue(())
    });
    covered.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
    covered.dedup();
    let wanted = oracle::all_hits(mesh, ray);
    let keys = |hits: &[Hit]| hits.iter().map(key).collect::<Vec<_>>();
    assert_eq!(keys(&covered), keys(&wanted), "{name}: {ray:?}");
}

#[test]
fn leaves_are_ordered_and_cover_all_hits() {
    for Scene { name, mesh, .. } in scenes::all() {
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
        let tracer = Tracer::new(&mesh, &tree);
        let mut maker = RayMaker::new(&mesh, &tree, 51);
        for _ in 0..(2_000_000 / mesh.triangles().len().max(1)).clamp(200, 2_000) {
            let ray = maker.any();
            if ray.t_min <= ray.t_max {
                check(&name, &mesh, &tracer, &ray);
            }
        }
    }
}

#[test]
fn a_visit_ends_where_it_is_broken_off() {
    let mesh = scenes::ordinary().swap_remove(4).mesh;
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
    let tracer = Tracer::new(&mesh, &tree);
    let mut maker = RayMaker::new(&mesh, &tree, 52);
    let mut visits = 0;
    for ray in (0..1000).map(|_| maker.line()) {
        let mut leaves = 0;
        tracer.visit_leaves(&ray, |_| {
            leaves += 1;
            ControlFlow::Break(())
        });
        assert!(leaves <= 1);
        visits += leaves;
    }
    assert!(visits > 100, "only {visits} rays met a leaf");
}
