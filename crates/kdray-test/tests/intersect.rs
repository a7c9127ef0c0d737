//! The ray-triangle test against rational arithmetic.

use kdray::trace::intersect;
use kdray::{Hit, Ray};
use kdray_test::Random;
use kdray_test::exact::{Meeting, meeting, rounded};

fn line(origin: [f32; 3], direction: [f32; 3]) -> Ray {
    Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, direction) }
}

fn single(point: [f64; 3]) -> [f32; 3] {
    point.map(|value| value as f32)
}

/// With small whole numbers and a ray along an axis nothing is rounded before the signs: inside
/// and outside are exact, and t, u and v are off by their own roundings only.
#[test]
fn rays_along_axes_on_a_lattice_are_exact() {
    let mut random = Random::new(61);
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..15_000 {
        let corners = [(); 3].map(|()| single(random.lattice_point(6)));
        let mut direction = [0.0; 3];
        direction[random.below(3)] = random.pick(&[1.0, -1.0, 2.0, -0.5]);
        let ray = line(single(random.lattice_point(6)), direction);
        let found = intersect(&ray, 0, &corners);
        let Some(exact) = meeting(&ray, &corners) else {
            assert_eq!(found, None, "{ray:?} is parallel to {corners:?}");
            continue;
        };
        if exact.is_inside() {
            inside += 1;
            let hit = found.unwrap_or_else(|| panic!("{ray:?} is inside {corners:?}"));
            assert_near(&hit, &exact, 1e-6);
        } else if exact.is_outside() {
            outside += 1;
            assert_eq!(found, None, "{ray:?} is outside {corners:?}");
        }
    }
    assert!(inside > 500 && outside > 1000, "{inside} inside, {outside} outside");
}

/// Of two triangles on the two sides of an edge, a ray through that edge hits exactly one.
#[test]
fn rays_through_a_shared_edge_hit_one_of_two() {
    let mut random = Random::new(62);
    let mut ties = 0;
    for _ in 0..20_000 {
        let [a, b, c, d] = [(); 4].map(|()| single(random.lattice_point(4)));
        let mut direction = [0.0; 3];
        direction[random.below(3)] = random.pick(&[1.0, -1.0]);
        let middle = [0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis]));
        let ray = line(middle, direction);
        let (Some(one), Some(other)) = (meeting(&ray, &[a, b, c]), meeting(&ray, &[b, a, d]))
        else {
            continue;
        };
        // The third corners as seen along the ray: the volumes of the two have one sign if the
        // triangles are on different sides.
        if on_same_side(&ray, [a, b, c, d]) {
            continue;
        }
        assert!(!one.is_outside() && !other.is_outside(), "the ray passes through the edge");
        ties += 1;
        let hits =
            [[a, b, c], [b, a, d]].iter().filter(|t| intersect(&ray, 0, t).is_some()).count();
        assert_eq!(hits, 1, "{ray:?} through the edge of {:?}", [a, b, c, d]);
    }
    assert!(ties > 500, "{ties} ties");
}

/// Whether c and d are on one side of the edge from a to b, seen along an axis.
fn on_same_side(ray: &Ray, [a, b, c, d]: [[f32; 3]; 4]) -> bool {
    let along = ray.direction.iter().position(|v| *v != 0.0).expect("the ray goes along an axis");
    let (x, y) = ((along + 1) % 3, (along + 2) % 3);
    let side = |p: [f32; 3]| (b[x] - a[x]) * (p[y] - a[y]) - (b[y] - a[y]) * (p[x] - a[x]);
    side(c) * side(d) >= 0.0
}

/// In general position: whatever is clearly inside is hit and whatever is clearly outside is not.
#[test]
fn clear_cases_in_general_position() {
    let mut random = Random::new(63);
    let (mut inside, mut outside) = (0, 0);
    for round in 0..10_000 {
        let corners = [(); 3].map(|()| single(random.point()));
        let far = if round % 3 == 0 { 100.0 } else { 2.0 };
        let origin = single(random.point().map(|v| far * v));
        let towards = single(random.point().map(|v| 0.7 * v));
        let direction = [0, 1, 2].map(|axis| towards[axis] - origin[axis]);
        let ray = line(origin, direction);
        let Some(exact) = meeting(&ray, &corners) else { continue };
        // Seen edge-on, a rounding moves the crossing far: only clear views are judged.
        if obliqueness(&ray, &corners) < 1e-2 {
            continue;
        }
        let clearance = exact.clearance();
        let found = intersect(&ray, 0, &corners);
        if clearance > 1e-2 {
            inside += 1;
            let hit = found.unwrap_or_else(|| panic!("{ray:?} is inside {corners:?}"));
            assert_near(&hit, &exact, 2e-2);
        } else if clearance < -1e-2 {
            outside += 1;
            assert_eq!(found, None, "{ray:?} is outside {corners:?}");
        }
    }
    assert!(inside > 500 && outside > 1000, "{inside} inside, {outside} outside");
}

/// Area of the triangle as the ray sees it, in units of the scene.
fn obliqueness(ray: &Ray, corners: &[[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let minus = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|axis| p[axis] - q[axis]);
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (p, q) = (minus(b, a), minus(c, a));
    let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    let direction = ray.direction.map(f64::from);
    dot(normal, direction).abs() / dot(direction, direction).sqrt()
}

/// Whether a hit is where exact arithmetic puts it, to within `tolerance`.
fn assert_near(hit: &Hit, exact: &Meeting, tolerance: f64) {
    let wanted = [&exact.t, &exact.weights[1], &exact.weights[2]].map(rounded);
    for (found, wanted) in [hit.t, hit.u, hit.v].into_iter().zip(wanted) {
        let error = (f64::from(found) - wanted).abs();
        assert!(error <= tolerance * wanted.abs().max(1.0), "{hit:?} instead of {wanted}");
    }
}
