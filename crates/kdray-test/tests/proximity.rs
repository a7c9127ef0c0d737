//! What is near a point, and what is inside, are what trying every triangle gives.

use kdray::{Aabb, BuildOptions, Mesh, Tracer, Tree};
use kdray_test::rays::RayMaker;
use kdray_test::{Scene, oracle, scenes, shared};

fn tracer_of(mesh: &Mesh) -> (Tree, Tracer) {
    let tree = Tree::build(mesh, &BuildOptions::default()).expect("the options are in range");
    let tracer = Tracer::new(mesh, &tree);
    (tree, tracer)
}

/// Query points on, in and around every scene.
fn for_points(count: usize, mut check: impl FnMut(&str, &Mesh, &Tracer, [f32; 3], [f32; 3])) {
    let extra = shared::mesh("happy_res4.ply").map(|mesh| ("happy_res4".to_owned(), mesh));
    let all = scenes::all().map(|Scene { name, mesh, .. }| (name.to_string(), mesh)).chain(extra);
    for (name, mesh) in all {
        let (tree, tracer) = tracer_of(&mesh);
        let mut maker = RayMaker::new(&mesh, &tree, 21);
        let count = (4_000_000 / mesh.triangles().len().max(1)).min(count);
        for _ in 0..count {
            let (ray, other) = (maker.line(), maker.target());
            check(&name, &mesh, &tracer, ray.origin, other);
        }
    }
}

/// The largest coordinate in play.
fn reach_of(mesh: &Mesh, point: [f32; 3]) -> f64 {
    let Aabb { lower, upper } = mesh.bounds();
    let all = lower.into_iter().chain(upper).chain(point);
    all.fold(0.0, |reach, v| reach.max(f64::from(v.abs())))
}

#[test]
fn closest_points_as_brute_force() {
    for_points(1_000, |name, mesh, tracer, point, _| {
        let found = tracer.closest_point(point, f32::INFINITY);
        let wanted = oracle::closest_distance(mesh, point);
        let Some(wanted) = wanted else {
            assert_eq!(found, None, "{name}");
            return;
        };
        let found = found.expect("there are triangles");
        let (distance, wanted) = (f64::from(found.distance), wanted.sqrt());
        // Rounded once to single precision; the two ways to it differ by roundings of doubles,
        // which count where the distance is small beside the coordinates.
        let tolerance = wanted * f64::from(f32::EPSILON) + 1e-14 * reach_of(mesh, point);
        assert!((distance - wanted).abs() <= tolerance, "{name} {point:?}: {found:?} {wanted}");
        // The smallest numbers are not made smaller by a hundredth.
        let shorter = found.distance * 0.99;
        let nearer = tracer.closest_point(point, shorter);
        assert!(shorter == found.distance || nearer.is_none(), "{name} {point:?}: {nearer:?}");
    });
}

#[test]
fn spheres_as_brute_force() {
    for_points(200, |name, mesh, tracer, center, other| {
        let apart = (0..3).map(|axis| (other[axis] - center[axis]).powi(2)).sum::<f32>();
        let radius = 0.3 * apart.sqrt();
        let mut found = Vec::new();
        tracer.within_sphere(center, radius, &mut found);
        let limit = f64::from(radius) * f64::from(radius);
        assert!(found.is_sorted_by(|a, b| a < b), "{name}: {found:?}");
        for triangle in 0..mesh.triangles().len() {
            let distance = oracle::squared_distance(center, &mesh.triangle(triangle));
            // On the sphere, roundings decide.
            if (distance - limit).abs() > 1e-12 * (limit + reach_of(mesh, center).powi(2)) {
                let is_found = found.binary_search(&(triangle as u32)).is_ok();
                let wanted = distance <= limit;
                assert_eq!(is_found, wanted, "{name}: {triangle} {center:?} {radius} {distance}");
            }
        }
    });
}

/// A triangle is in the answer if a part of it, clipped in double precision, is in the box.
#[test]
fn boxes_as_brute_force() {
    for_points(200, |name, mesh, tracer, one, other| {
        let region = Aabb::of_points(&[one, other]);
        let mut found = Vec::new();
        tracer.within_box(&region, &mut found);
        assert!(found.is_sorted_by(|a, b| a < b), "{name}: {found:?}");
        for triangle in 0..mesh.triangles().len() {
            let corners = mesh.triangle(triangle);
            let is_found = found.binary_search(&(triangle as u32)).is_ok();
            if let Some(wanted) = oracle::clearly_overlaps(&corners, &region) {
                assert_eq!(is_found, wanted, "{name}: {triangle} {corners:?} {region:?}");
            }
        }
    });
}

/// Parity agrees with the winding number of closed meshes that do not wind around twice.
#[test]
fn inside_as_the_winding_number() {
    let simple = scenes::closed().into_iter().take(3);
    for Scene { name, mesh, .. } in simple {
        let (tree, tracer) = tracer_of(&mesh);
        let mut maker = RayMaker::new(&mesh, &tree, 22);
        for _ in 0..300 {
            let point = maker.line().origin;
            let distance = oracle::closest_distance(&mesh, point).expect("there are triangles");
            if distance.sqrt() < 1e-6 * reach_of(&mesh, point) {
                continue; // As good as on the surface.
            }
            let winding = oracle::winding_number(&mesh, point);
            let odd = winding.round().rem_euclid(2.0) == 1.0;
            assert_eq!(tracer.contains(point), odd, "{name} {point:?}: {winding}");
        }
    }
}
