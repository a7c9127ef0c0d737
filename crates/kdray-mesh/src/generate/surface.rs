//! Surfaces over a rectangle of two parameters, closed or open, and the mesh they are added to.

use super::vector::{Vector, add, scale};
use crate::Loaded;

/// How the two ends of a parameter meet.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Ends {
    /// They do not: the surface has a border there.
    Open,
    /// The last column is the first.
    Joined,
}

/// Adds `point`, as `f32` has it, and gives its index.
pub(super) fn add_vertex(mesh: &mut Loaded, point: Vector) -> u32 {
    mesh.positions.push(point.map(|value| f64::from(value as f32)));
    u32::try_from(mesh.positions.len() - 1)
        .expect("fewer vertices than a triangle count can ask for")
}

/// Adds `columns` by `rows` cells of two triangles; `point` maps (u, v), each from 0 to 1.
///
/// The front is where u turns into v counter-clockwise.
pub(super) fn add_sheet(
    mesh: &mut Loaded,
    [columns, rows]: [usize; 2],
    [ends_u, ends_v]: [Ends; 2],
    point: impl Fn(f64, f64) -> Vector,
) {
    let lines = |cells: usize, ends: Ends| cells + usize::from(ends == Ends::Open);
    let (width, height) = (lines(columns, ends_u), lines(rows, ends_v));
    let first = mesh.positions.len();
    for row in 0..height {
        for column in 0..width {
            let (u, v) = (column as f64 / columns as f64, row as f64 / rows as f64);
            add_vertex(mesh, point(u, v));
        }
    }
    let index = |column: usize, row: usize| (first + row % height * width + column % width) as u32;
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [index(column, row), index(column + 1, row)];
            let [c, d] = [index(column + 1, row + 1), index(column, row + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
}

/// Adds a surface that is joined in u and shrinks to a point at v = 0, and at v = 1 if it is closed.
///
/// Closed it has `2 * columns * (rows - 1)` triangles and needs three rows; open it has
/// `columns * (2 * rows - 1)` and needs two.
pub(super) fn add_cap(
    mesh: &mut Loaded,
    [columns, rows]: [usize; 2],
    is_closed: bool,
    point: impl Fn(f64, f64) -> Vector,
) {
    let bands = if is_closed { rows - 2 } else { rows - 1 };
    let pole = add_vertex(mesh, point(0.0, 0.0));
    let ring = |row: usize, column: usize| pole + 1 + (row * columns + column % columns) as u32;
    add_sheet(mesh, [columns, bands], [Ends::Joined, Ends::Open], |u, v| {
        point(u, (1.0 + v * bands as f64) / rows as f64)
    });
    for column in 0..columns {
        mesh.triangles.push([pole, ring(0, column + 1), ring(0, column)]);
    }
    if is_closed {
        let pole = add_vertex(mesh, point(0.0, 1.0));
        for column in 0..columns {
            mesh.triangles.push([pole, ring(bands, column), ring(bands, column + 1)]);
        }
    }
}

/// Adds a closed box: its centre, and the three half edges, in right-handed order.
pub(super) fn add_box(mesh: &mut Loaded, centre: Vector, halves: [Vector; 3]) {
    const FACES: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let corner = |bits: usize| {
        let sign = |axis: usize| if bits >> axis & 1 == 1 { 1.0 } else { -1.0 };
        (0..3).fold(centre, |point, axis| add(point, scale(halves[axis], sign(axis))))
    };
    let first = add_vertex(mesh, corner(0));
    for bits in 1..8 {
        add_vertex(mesh, corner(bits));
    }
    for [a, b, c, d] in FACES.map(|face| face.map(|bits| first + bits)) {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
}
