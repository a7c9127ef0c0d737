//! Winding numbers are what the sum over every triangle gives, and signs follow from them.

use kdray::{Aabb, BuildOptions, Mesh, Sign, Tracer, Tree, Winding};
use kdray_test::rays::RayMaker;
use kdray_test::{Scene, oracle, scenes};

/// Solid angles that the brute force may sum for a scene.
const ANGLES: usize = 1_000_000;

/// Points in and around every scene, none of them as good as on the surface.
fn for_points(mut check: impl FnMut(&Scene, &Tracer, &Winding, [f32; 3])) {
    for scene in scenes::all() {
        let mesh = &scene.mesh;
        let tree = Tree::build(mesh, &BuildOptions::default()).expect("the options are in range");
        let (tracer, winding) = (Tracer::new(mesh, &tree), Winding::new(mesh));
        let mut maker = RayMaker::new(mesh, &tree, 31);
        let count = (ANGLES / mesh.triangles().len().max(1)).clamp(50, 500);
        for _ in 0..count {
            let point = maker.line().origin;
            let distance = oracle::closest_distance(mesh, point).unwrap_or(f64::INFINITY).sqrt();
            if distance > 1e-6 * reach_of(mesh, point) {
                check(&scene, &tracer, &winding, point);
            }
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
fn numbers_keep_their_tolerance() {
    for_points(|Scene { name, mesh, .. }, _, winding, point| {
        let wanted = oracle::winding_number(mesh, point);
        for tolerance in [0.3, 1e-2, 1e-4, 0.0] {
            let found = winding.number(point, tolerance);
            let off = (found - wanted).abs();
            assert!(off <= tolerance + 1e-9, "{name} {point:?}: {found}, {wanted}");
        }
    });
}

#[test]
fn inside_is_where_the_sum_says() {
    let mut inside = 0;
    for_points(|Scene { name, mesh, .. }, _, winding, point| {
        let number = oracle::winding_number(mesh, point).abs();
        if (number - 0.5).abs() > 1e-9 {
            assert_eq!(winding.contains(point), number > 0.5, "{name} {point:?}: {number}");
            inside += usize::from(number > 0.5);
        }
    });
    assert!(inside > 500, "only {inside} points were inside");
}

#[test]
fn signed_distances_are_closest_distances_with_a_sign() {
    for_points(|Scene { name, mesh, is_closed, .. }, tracer, winding, point| {
        let found = tracer.signed_distance(point, Sign::Winding(winding));
        let closest = tracer.closest_point(point, f32::INFINITY);
        assert_eq!(found.map(f32::abs), closest.map(|closest| closest.distance), "{name}");
        let Some(found) = found else { return };
        assert_eq!(found < 0.0, winding.contains(point) && found != 0.0, "{name} {point:?}");
        let number = oracle::winding_number(mesh, point).abs();
        if *is_closed && number < 1.5 {
            let by_parity = tracer.signed_distance(point, Sign::Parity);
            assert_eq!(by_parity, Some(found), "{name} {point:?}: {number}");
        }
    });
}

#[test]
fn points_and_meshes_without_meaning_have_no_inside() {
    let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    let winding = Winding::new(&mesh.expect("sound"));
    for bad in [f32::NAN, f32::INFINITY] {
        assert_eq!(winding.number([0.25, bad, 1.0], 0.1), 0.0);
        assert!(!winding.contains([0.25, bad, 1.0]));
    }
    let nothing = Winding::new(&Mesh::new(&[], &[]).expect("sound"));
    assert_eq!((nothing.number([0.0; 3], 0.0), nothing.size_bytes()), (0.0, 0));
}

/// A sphere with a hole: inside is inside still.
#[test]
fn holes_are_bridged() {
    let scenes = scenes::ordinary();
    let sphere = &scenes.iter().find(|scene| scene.name == "sphere").expect("it is there").mesh;
    let below = |triangle: &&[u32; 3]| {
        triangle.iter().any(|vertex| sphere.positions()[*vertex as usize][2] < 0.8)
    };
    let triangles: Vec<_> = sphere.triangles().iter().filter(below).copied().collect();
    assert!(triangles.len() < sphere.triangles().len(), "there is a hole");
    let mesh = Mesh::new(sphere.positions(), &triangles).expect("sound");
    let winding = Winding::new(&mesh);
    assert!(winding.contains([0.0, 0.0, 0.5]) && !winding.contains([0.0, 0.0, 1.2]));
    assert!(winding.contains([0.6, 0.0, 0.0]) && !winding.contains([1.2, 0.0, 0.0]));
}
