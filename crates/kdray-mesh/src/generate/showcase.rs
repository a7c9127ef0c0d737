//! The scene that a newcomer sees first: a still life with everything that tries a kd-tree.

use super::solids::add_knot;
use super::surface::{Ends, add_box, add_cap, add_sheet, add_vertex};
use super::vector::{Random, Vector, add, mix, scale, sin_cos};
use crate::Loaded;

/// A still life of exactly `triangles` triangles; at least one.
///
/// Around the origin, y up, on a square floor of 11 units: a fluted gourd, a trefoil knot, a helical gear
/// and a rounded cube (closed), a bowl and a curling ribbon (open), a lattice of bars and a meadow of thin
/// blades. Every coordinate is exact in `f32`.
///
/// ```
/// let scene = kdray_mesh::generate::showcase(100_000);
/// assert_eq!(scene.triangles.len(), 100_000);
/// assert!(scene.positions.iter().flatten().all(|value| value.abs() < 6.0));
/// ```
pub fn showcase(triangles: usize) -> Loaded {
    let triangles = triangles.max(1);
    let mut mesh = Loaded::default();
    add_floor(&mut mesh, triangles);
    add_lattice(&mut mesh, triangles / 1500);
    let rest = triangles - mesh.triangles.len();
    for (percent, piece) in PIECES {
        let first = mesh.positions.len();
        // Divided first, so that no count is too great for it.
        piece(&mut mesh, rest / 100 * percent + rest % 100 * percent / 100);
        rest_on_floor(&mut mesh.positions[first..]);
    }
    add_ribbon(&mut mesh, rest / 16);
    let left = triangles - mesh.triangles.len();
    add_meadow(&mut mesh, left);
    mesh
}

/// Adds a piece of at most so many triangles.
pub(super) type Piece = fn(&mut Loaded, usize);

/// The pieces that stand on the floor, and their parts of the triangles in percent.
const PIECES: [(usize, Piece); 5] =
    [(26, add_gourd), (26, add_trefoil), (12, add_gear), (9, add_rounded_cube), (8, add_bowl)];

/// Columns and rows of a sheet of at most `triangles`, with about `aspect` columns a row.
///
/// None when that would be less than three of either.
fn cells(triangles: usize, aspect: f64) -> Option<[usize; 2]> {
    let rows = ((triangles / 2) as f64 / aspect).sqrt() as usize;
    let columns = (triangles / 2).checked_div(rows)?;
    (rows >= 3 && columns >= 3).then_some([columns, rows])
}

/// Lowers or lifts a piece until it touches the floor.
fn rest_on_floor(points: &mut [Vector]) {
    let lowest = points.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
    for point in points {
        point[1] = f64::from((point[1] - lowest) as f32);
    }
}

/// A direction: `u` turns around the y axis from z to x, `v` from 0 below to 1 above.
fn direction(u: f64, v: f64) -> Vector {
    let ((sin_u, cos_u), (sin_v, cos_v)) = (sin_cos(u), sin_cos(v / 2.0));
    [sin_v * sin_u, -cos_v, sin_v * cos_u]
}

/// `point` turned around the y axis by so many turns.
fn turned(point: Vector, turns: f64) -> Vector {
    let (sin, cos) = sin_cos(turns);
    [cos * point[0] + sin * point[2], point[1], cos * point[2] - sin * point[0]]
}

/// Large triangles: the floor.
fn add_floor(mesh: &mut Loaded, triangles: usize) {
    let tiles = match triangles {
        0..3 => return,
        3..1_000 => 1,
        1_000..10_000 => 4,
        _ => 8,
    };
    add_sheet(mesh, [tiles, tiles], [Ends::Open; 2], |u, v| {
        [mix(-5.5, 5.5, u), 0.0, mix(5.5, -5.5, v)]
    });
}

/// Long thin boxes: a frame, and at most 20 bars for each diagonal.
fn add_lattice(mesh: &mut Loaded, bars: usize) {
    const WIDTH: f64 = 9.6;
    const HEIGHT: f64 = 2.4;
    const DEPTH: f64 = -4.3;
    const HALF: f64 = 0.03;
    let bars = bars.min(20);
    if bars == 0 {
        return;
    }
    let depth = [0.0, 0.0, HALF];
    for side in [-1.0, 1.0] {
        let (rail, post) = ([0.0, side * HEIGHT / 2.0, 0.0], [side * WIDTH / 2.0, 0.0, 0.0]);
        let middle = [0.0, HEIGHT / 2.0 + HALF, DEPTH];
        add_box(mesh, add(middle, rail), [[WIDTH / 2.0, 0.0, 0.0], [0.0, HALF, 0.0], depth]);
        add_box(mesh, add(middle, post), [[HALF, 0.0, 0.0], [0.0, HEIGHT / 2.0, 0.0], depth]);
    }
    for bar in 0..bars {
        // A bar starts at the lower rail, or at the side where that is too short.
        let start = mix(-HEIGHT, WIDTH, (bar as f64 + 0.5) / bars as f64);
        let (from, to) = (start.max(0.0), (start + HEIGHT).min(WIDTH));
        let (half, middle) = ((to - from) / 2.0, (to + from) / 2.0);
        for side in [-1.0, 1.0] {
            let centre = [side * (middle - WIDTH / 2.0), middle - start, DEPTH + side * HALF];
            let along = [side * half, half, 0.0];
            let across = scale([-1.0, side, 0.0], HALF / 2.0);
            add_box(mesh, centre, [along, across, [0.0, 0.0, HALF / 2.0]]);
        }
    }
}

pub(super) fn add_gourd(mesh: &mut Loaded, triangles: usize) {
    let Some([columns, rows]) = cells(triangles, 1.6) else {
        return;
    };
    add_cap(mesh, [columns, rows + 1], true, |u, v| {
        let (sin, _) = sin_cos(v / 2.0);
        let flute = sin_cos(4.5 * u + 0.35 * v).1.abs();
        let bead = sin_cos(36.0 * u).0 * sin_cos(14.0 * v).0;
        let radius = 1.5 + sin * sin * (0.32 * (flute - 0.6) + 0.012 * bead);
        let [x, y, z] = scale(direction(u, v), radius);
        [x - 1.75, 0.92 * y, z + 0.1]
    });
}

pub(super) fn add_trefoil(mesh: &mut Loaded, triangles: usize) {
    let Some(cells) = cells(triangles, 9.0) else {
        return;
    };
    add_knot(mesh, [2, 3], cells, 0.27, |point| {
        let turned = turned(scale(point, 1.15), 0.06);
        add(turned, [1.85, 0.0, -1.0])
    });
}

/// A ring with teeth, twisted from its lower to its upper face, which is hollowed; its edges are sharp.
pub(super) fn add_gear(mesh: &mut Loaded, triangles: usize) {
    const HEIGHT: f64 = 0.5;
    let Some([_, rows]) = cells(triangles, 5.0) else {
        return;
    };
    let rows = (rows / 4 * 4).max(4);
    let columns = triangles / (2 * rows);
    add_sheet(mesh, [columns, rows], [Ends::Joined; 2], |u, v| {
        let (side, part) = ((4.0 * v).floor(), (4.0 * v).fract());
        let (inward, height) = match side as u32 {
            0 => (0.0, part),
            1 => (part, 1.0),
            2 => (1.0, 1.0 - part),
            _ => (1.0 - part, 0.0),
        };
        let tooth = (2.4 * sin_cos(16.0 * u).0).clamp(-1.0, 1.0);
        let radius = mix(1.1, 0.42, inward) + 0.11 * tooth * libm::pow(1.0 - inward, 6.0);
        let hollow = (8.0 * inward * (1.0 - inward) - 0.9).clamp(0.0, 1.0) * height;
        let (sin, cos) = sin_cos(u + 0.03 * height);
        [radius * sin + 2.6, HEIGHT * height - 0.14 * hollow, radius * cos + 2.2]
    });
}

pub(super) fn add_rounded_cube(mesh: &mut Loaded, triangles: usize) {
    let Some([columns, rows]) = cells(triangles, 2.0) else {
        return;
    };
    add_cap(mesh, [columns, rows + 1], true, |u, v| {
        let direction = direction(u, v);
        let sum: f64 = direction.iter().map(|value| libm::pow(value.abs(), 6.0)).sum();
        let point = scale(direction, 0.72 / libm::pow(sum, 1.0 / 6.0));
        add(turned(point, 0.09), [-3.3, 0.0, 2.5])
    });
}

fn add_bowl(mesh: &mut Loaded, triangles: usize) {
    let Some([columns, rows]) = cells(triangles, 3.0) else {
        return;
    };
    add_cap(mesh, [columns, rows], false, |u, v| {
        let scallop = sin_cos(10.0 * u).1 * v * v * v * v;
        let ((sin, cos), radius) = (sin_cos(u), v * (1.05 + 0.07 * scallop));
        [radius * sin + 0.2, 0.85 * v * v + 0.06 * scallop, radius * cos + 2.9]
    });
}

/// A streamer that curls along the x axis above the rest.
fn add_ribbon(mesh: &mut Loaded, triangles: usize) {
    let rows = (((triangles / 80) as f64).sqrt() as usize).max(1);
    let columns = triangles / (2 * rows);
    if columns < 48 {
        return;
    }
    add_sheet(mesh, [columns, rows], [Ends::Open; 2], |u, v| {
        let (swell, _) = sin_cos(u / 2.0);
        let (sin, cos) = sin_cos(6.0 * u);
        let radius = 0.28 + 0.22 * swell;
        let across = mix(-1.0, 1.0, v) * (0.06 + 0.2 * swell);
        [mix(-4.6, 4.6, u) + across, 3.0 + 0.7 * swell + radius * cos, radius * sin - 2.9]
    });
}

/// Thin triangles: blades of grass behind and beside the pieces.
fn add_meadow(mesh: &mut Loaded, triangles: usize) {
    let mut random = Random::new(2011);
    let blade = ((triangles as f64).sqrt() as usize / 40).clamp(3, 15);
    let mut left = triangles;
    while left > 0 {
        let count = left.min(blade);
        left -= count;
        add_blade(mesh, &mut random, count);
    }
}

/// One blade: a strip of `count` triangles that narrows to its tip and bends over.
fn add_blade(mesh: &mut Loaded, random: &mut Random, count: usize) {
    let (sin, cos) = sin_cos(random.between(0.47, 1.03));
    let radius = mix(3.5, 5.0, random.unit().sqrt());
    let base = [radius * cos, 0.0, 0.85 * radius * sin];
    let (lean_sin, lean_cos) = sin_cos(random.unit());
    let height = random.between(0.35, 1.1);
    let bend = random.between(0.1, 0.5) * height;
    let first = mesh.positions.len() as u32;
    for step in 0..count + 2 {
        let part = step as f64 / (count + 1) as f64;
        let side = if step % 2 == 0 { -1.0 } else { 1.0 };
        let (half, reach) = (side * 0.022 * (1.0 - part), bend * part * part);
        let point = [
            reach * lean_cos - half * lean_sin,
            height * (part - 0.25 * part * part),
            reach * lean_sin + half * lean_cos,
        ];
        add_vertex(mesh, add(base, point));
    }
    for step in 0..count as u32 {
        let [a, b, c] = [step, step + 1, step + 2].map(|corner| first + corner);
        mesh.triangles.push(if step % 2 == 0 { [a, b, c] } else { [b, a, c] });
    }
}
