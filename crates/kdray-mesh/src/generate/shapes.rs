//! Open surfaces and loose triangles, for tests and measurements.

use super::surface::{Ends, add_sheet, add_vertex};
use super::vector::{Random, add, normalise, scale};
use crate::Loaded;

/// A square from -1 to 1 in the plane y = 0, of `2 * n * n` triangles that share their edges.
///
/// ```
/// assert_eq!(kdray_mesh::generate::grid(10).triangles.len(), 200);
/// ```
pub fn grid(n: usize) -> Loaded {
    let mut mesh = Loaded::default();
    add_sheet(&mut mesh, [n, n], [Ends::Open; 2], |u, v| [2.0 * u - 1.0, 0.0, 1.0 - 2.0 * v]);
    mesh
}

/// `n` loose triangles, about a tenth as long as the cube from -1 to 1 that they fill.
///
/// ```
/// use kdray_mesh::generate::soup;
/// assert_eq!(soup(100, 7), soup(100, 7));
/// assert_ne!(soup(100, 7), soup(100, 8));
/// ```
pub fn soup(n: usize, seed: u64) -> Loaded {
    loose(n, seed, |random| {
        let centre = cube_point(random);
        [(); 3].map(|()| add(centre, scale(cube_point(random), 0.1)))
    })
}

/// `n` loose needles in the cube from -1 to 1: long triangles, ten thousand times as long as wide.
///
/// ```
/// assert_eq!(kdray_mesh::generate::slivers(50, 1).positions.len(), 150);
/// ```
pub fn slivers(n: usize, seed: u64) -> Loaded {
    loose(n, seed, |random| {
        let (start, end) = (cube_point(random), cube_point(random));
        let sideways = normalise(add(cube_point(random), [0.0, 3.0, 0.0]));
        [start, end, add(end, scale(sideways, 1e-4))]
    })
}

fn cube_point(random: &mut Random) -> [f64; 3] {
    [(); 3].map(|()| random.between(-1.0, 1.0))
}

fn loose(n: usize, seed: u64, triangle: impl Fn(&mut Random) -> [[f64; 3]; 3]) -> Loaded {
    let (mut mesh, mut random) = (Loaded::default(), Random::new(seed));
    for _ in 0..n {
        let corners = triangle(&mut random).map(|point| add_vertex(&mut mesh, point));
        mesh.triangles.push(corners);
    }
    mesh
}
