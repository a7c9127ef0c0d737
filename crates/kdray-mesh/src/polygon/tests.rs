use std::collections::HashMap;
use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;

/// A polygon in the plane z = 0 of a frame that lies askew in space.
fn askew(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
    points
        .iter()
        .map(|[x, y]| [x + 0.25 * y + 100.0, y - 0.5 * x, 0.5 * x + 0.25 * y - 7.0])
        .collect()
}

fn triangulate(positions: &[[f64; 3]]) -> (Vec<[u32; 3]>, bool) {
    let corners: Vec<u32> = (0..positions.len() as u32).collect();
    let mut triangles = Vec::new();
    let clean = Triangulator::default().triangulate(&corners, positions, &mut triangles);
    (triangles, clean)
}

/// The area of a polygon as a vector along its normal, twice.
fn area(positions: &[[f64; 3]], corners: &[u32]) -> [f64; 3] {
    newell_normal(corners, positions)
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// n - 2 triangles, and each edge of the polygon once, with every other edge used both ways.
fn assert_edges_are_kept(count: usize, triangles: &[[u32; 3]]) {
    assert_eq!(triangles.len(), count - 2);
    let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *balance.entry([from, to]).or_default() += 1;
            *balance.entry([to, from]).or_default() -= 1;
        }
    }
    for (&[from, to], &uses) in &balance {
        let is_border = to as usize == (from as usize + 1) % count;
        let is_border_reversed = from as usize == (to as usize + 1) % count;
        assert_eq!(uses, i32::from(is_border) - i32::from(is_border_reversed), "{from} {to}");
    }
}

/// No overlap: the areas of the triangles add up to the area of the polygon.
fn assert_area_is_kept(positions: &[[f64; 3]], triangles: &[[u32; 3]]) {
    let corners: Vec<u32> = (0..positions.len() as u32).collect();
    let whole = length(area(positions, &corners));
    let parts: f64 = triangles.iter().map(|triangle| length(area(positions, triangle))).sum();
    assert!((whole - parts).abs() <= 1e-9 * whole, "{whole} {parts}");
}

#[test]
fn a_dart_is_cut_at_its_notch() {
    let dart = askew(&[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]]);
    for turn in 0..4 {
        let mut dart = dart.clone();
        dart.rotate_left(turn);
        let (triangles, clean) = triangulate(&dart);
        assert!(clean);
        assert_edges_are_kept(4, &triangles);
        assert_area_is_kept(&dart, &triangles);
    }
}

#[test]
fn a_star_that_crosses_itself_keeps_its_edges() {
    let point = |corner: u32| {
        let angle = f64::from(corner) * TAU * 2.0 / 5.0;
        [angle.cos(), angle.sin()]
    };
    let (triangles, _) = triangulate(&askew(&[0, 1, 2, 3, 4].map(point)));
    assert_edges_are_kept(5, &triangles);
}

#[test]
fn polygons_without_area_keep_their_corners() {
    for polygon in [vec![[1.0; 3]; 5], vec![[f64::NAN; 3]; 4], vec![[1e300, -1e300, 1e300]; 4]] {
        assert_eq!(triangulate(&polygon).0.len(), polygon.len() - 2);
    }
}

#[test]
fn a_tangle_ends_with_the_work_allowed() {
    let jump = |corner: u64| (corner.wrapping_mul(6_364_136_223_846_793_005) >> 40) as f64;
    let points: Vec<[f64; 2]> = (0..4_000).map(|k| [jump(2 * k + 1), jump(2 * k + 2)]).collect();
    let corners: Vec<u32> = (0..points.len() as u32).collect();
    let mut triangles = Vec::new();
    let mut triangulator = Triangulator { work_left: 10_000, ..Triangulator::default() };
    let clean = triangulator.triangulate(&corners, &askew(&points), &mut triangles);
    assert!(!clean && triangulator.work_left == 0);
    assert_edges_are_kept(points.len(), &triangles);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    /// Polygons seen whole from one point inside, concave as a rule, some edges with corners in them.
    #[test]
    fn simple_polygons_keep_edges_and_area(
        radii in prop::collection::vec((0.2..2.0_f64, 0_usize..3), 3..40),
        is_reversed: bool,
    ) {
        let count = radii.len();
        let corner = |k: usize| {
            let angle = TAU * k as f64 / count as f64;
            let radius = radii[k % count].0;
            // Multiples of a power of two, so that the corners in an edge lie exactly on it.
            [radius * angle.cos(), radius * angle.sin()].map(|x| (x * 4096.0).round() * 12.0)
        };
        let mut points = Vec::new();
        for k in 0..count {
            let (from, to, extra) = (corner(k), corner(k + 1), radii[k].1);
            let part = |step: usize| step as f64 / (extra + 1) as f64;
            points.extend((0..=extra).map(|step| {
                [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * part(step))
            }));
        }
        if is_reversed {
            points.reverse();
        }
        let positions = askew(&points);
        let (triangles, clean) = triangulate(&positions);
        prop_assert!(clean);
        assert_edges_are_kept(points.len(), &triangles);
        assert_area_is_kept(&positions, &triangles);
    }
}
