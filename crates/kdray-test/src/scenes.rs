//! Generated scenes, each for a reason: small to medium, and the same bits on every machine.

use kdray::Mesh;
use kdray_mesh::Loaded;
use kdray_mesh::generate::{cube, grid, slivers, soup, sphere, torus_knot};

use crate::{Random, degenerate};

/// A mesh with a name for the messages of failing tests.
#[derive(Clone)]
pub struct Scene {
    /// What the mesh is.
    pub name: String,
    /// The mesh.
    pub mesh: Mesh,
    /// Whether every edge has two triangles, so that a line crosses it an even number of times.
    pub is_closed: bool,
}

impl Scene {
    /// An open scene.
    ///
    /// # Panics
    ///
    /// If the positions are not finite or an index is out of range.
    #[must_use]
    pub fn open(name: impl Into<String>, loaded: &Loaded) -> Self {
        let mesh = loaded.mesh().expect("generated meshes are sound");
        Self { name: name.into(), mesh, is_closed: false }
    }

    /// A closed scene.
    ///
    /// # Panics
    ///
    /// As [`Scene::open`].
    #[must_use]
    pub fn closed(name: impl Into<String>, loaded: &Loaded) -> Self {
        Self { is_closed: true, ..Self::open(name, loaded) }
    }
}

/// All scenes: the ordinary ones, then those of [`crate::degenerate`].
pub fn all() -> impl Iterator<Item = Scene> {
    ordinary().into_iter().chain(degenerate::all())
}

/// Scenes such as users have.
#[must_use]
pub fn ordinary() -> Vec<Scene> {
    let one = of_corners([[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
    vec![
        Scene::open("no triangles", &Loaded::default()),
        Scene::open("one triangle", &one),
        Scene::closed("cube", &cube()),
        Scene::closed("sphere", &sphere(3)),
        Scene::closed("torus knot", &torus_knot([2, 3], 90, 6)),
        Scene::open("grid", &grid(16)),
        Scene::open("tilted grid", &moved(&grid(12), |[x, y, z]| [x, y + 0.3 * x - 0.7 * z, z])),
        Scene::open("soup", &soup(800, 1)),
        Scene::open("dense soup", &soup_of_size(300, 2, 1.0)),
        Scene::open("soup of many sizes", &soup_of_many_sizes(700, 3)),
        Scene::open("lattice soup", &lattice_soup(600, 4, 4)),
        Scene::open("slivers", &slivers(400, 5)),
        Scene::open("teapot in a stadium", &stadium()),
        Scene::closed("city", &city(9)),
    ]
}

/// The closed ones of [`all`], moved and scaled in many ways.
#[must_use]
pub fn closed() -> Vec<Scene> {
    let shapes = [
        ("cube", cube()),
        ("sphere", sphere(2)),
        ("knot", torus_knot([2, 3], 40, 5)),
        ("city", city(5)),
    ];
    let places: [(f64, [f64; 3]); 7] = [
        (1.0, [0.0; 3]),
        (0.1, [0.3, -0.7, 1.1]),
        (1e3, [5.0, 77.0, -3.0]),
        (1e-15, [0.0; 3]),
        (1e15, [3e15, 0.0, -2e15]),
        (1.0, [1e6, -2e6, 3e6]),
        (1.0, [1e9, 1e9, 1e9]),
    ];
    let placed = |(name, loaded): &(&str, Loaded)| {
        let place = |(scale, offset): (f64, [f64; 3])| {
            let world = |p: [f64; 3]| [0, 1, 2].map(|axis| offset[axis] + scale * p[axis]);
            Scene::closed(format!("{name} of size {scale} at {offset:?}"), &moved(loaded, world))
        };
        places.map(place)
    };
    shapes.iter().flat_map(placed).collect()
}

/// Loose triangles with the given corners.
#[must_use]
pub fn of_corners(corners: impl IntoIterator<Item = [[f64; 3]; 3]>) -> Loaded {
    let mut loaded = Loaded::default();
    for triangle in corners {
        let first = loaded.positions.len() as u32;
        loaded.positions.extend(triangle);
        loaded.triangles.push([first, first + 1, first + 2]);
    }
    loaded
}

/// The same triangles with every vertex moved.
#[must_use]
pub fn moved(loaded: &Loaded, place: impl Fn([f64; 3]) -> [f64; 3]) -> Loaded {
    let positions = loaded.positions.iter().map(|position| place(*position)).collect();
    Loaded { positions, ..loaded.clone() }
}

/// The triangles of both.
#[must_use]
pub fn joined(mut one: Loaded, other: &Loaded) -> Loaded {
    let first = one.positions.len() as u32;
    one.positions.extend(&other.positions);
    one.triangles.extend(other.triangles.iter().map(|corners| corners.map(|index| index + first)));
    one
}

/// `count` loose triangles of about `size` in the cube from -1 to 1.
#[must_use]
pub fn soup_of_size(count: usize, seed: u64, size: f64) -> Loaded {
    let mut random = Random::new(seed);
    of_corners((0..count).map(|_| near(&mut random, size)))
}

/// Loose triangles from a millionth to all of the scene in size.
#[must_use]
pub fn soup_of_many_sizes(count: usize, seed: u64) -> Loaded {
    let mut random = Random::new(seed);
    of_corners((0..count).map(|_| {
        let size = 0.5_f64.powi(random.below(21) as i32);
        near(&mut random, size)
    }))
}

/// Loose triangles with corners on a lattice: shared planes, flat ones and lines in plenty.
#[must_use]
pub fn lattice_soup(count: usize, seed: u64, reach: usize) -> Loaded {
    let mut random = Random::new(seed);
    of_corners((0..count).map(|_| [(); 3].map(|()| random.lattice_point(reach))))
}

/// A corner anywhere and the other two within `size` of it.
fn near(random: &mut Random, size: f64) -> [[f64; 3]; 3] {
    let center = random.point();
    [(); 3].map(|()| {
        let offset = random.point();
        [0, 1, 2].map(|axis| center[axis] + size * offset[axis])
    })
}

/// A detailed thing a ten-thousandth the size of the scene that it stands in.
fn stadium() -> Loaded {
    let field = moved(&grid(4), |p| p.map(|x| 100.0 * x));
    let teapot = moved(&torus_knot([2, 3], 40, 6), |[x, y, z]| {
        [31.0 + 0.01 * x, 0.02 + 0.01 * y, -47.0 + 0.01 * z]
    });
    joined(field, &teapot)
}

/// `side * side` axis-aligned houses, some wall to wall.
#[must_use]
pub fn city(side: usize) -> Loaded {
    let mut random = Random::new(11);
    let mut houses = Loaded::default();
    for block in 0..side * side {
        let corner = [(block % side) as f64, 0.0, (block / side) as f64];
        let size = [random.pick(&[0.5, 0.75, 1.0]), random.pick(&[1.0, 2.0, 2.5]), 1.0];
        let house = moved(&cube(), |p| {
            [0, 1, 2].map(|axis| corner[axis] + size[axis] * (0.5 + 0.5 * p[axis]))
        });
        houses = joined(houses, &house);
    }
    houses
}
