//! Scenes on which builders and tracers go wrong: ties, no area, extreme places and sizes.

use kdray_mesh::Loaded;
use kdray_mesh::generate::{cube, soup, sphere};

use crate::scenes::{joined, moved, of_corners, soup_of_size};
use crate::{Random, Scene};

/// All of them.
#[must_use]
pub fn all() -> Vec<Scene> {
    let mut scenes = without_area();
    scenes.extend(with_ties());
    scenes.extend(thin());
    scenes.extend(extreme());
    scenes
}

/// Points, segments, and planes full of triangles.
fn without_area() -> Vec<Scene> {
    let mut random = Random::new(21);
    let points = of_corners((0..300).map(|_| [random.point(); 3]));
    let point = of_corners((0..100).map(|_| [[0.25, -0.5, 3.0]; 3]));
    let segments = of_corners((0..300).map(|_| {
        let (start, end) = (random.point(), random.point());
        [start, end, start]
    }));
    let axis_segments = of_corners((0..200).map(|_| {
        let (start, axis) = (random.lattice_point(3), random.below(3));
        let mut end = start;
        end[axis] += 1.0;
        [start, start, end]
    }));
    let mixed = joined(joined(points.clone(), &segments), &soup(200, 22));
    let flat = soup_of_size(300, 23, 0.3);
    vec![
        Scene::open("points", &points),
        Scene::open("one point a hundred times", &point),
        Scene::open("segments", &segments),
        Scene::open("segments along the axes", &axis_segments),
        Scene::open("points, segments and triangles", &mixed),
        Scene::open("all in the plane z = 0", &moved(&flat, |[x, y, _]| [x, y, 0.0])),
        Scene::open("all in the plane x = 0.3", &moved(&flat, |[_, y, z]| [0.3, y, z])),
        Scene::open("all in a tilted plane", &moved(&flat, |[x, y, _]| [x, y, 0.5 * x - 0.25 * y])),
    ]
}

/// Many events at one place, and many triangles at one point.
fn with_ties() -> Vec<Scene> {
    let mut random = Random::new(31);
    let same = of_corners((0..500).map(|_| [[0.0; 3], [1.0, 0.2, 0.1], [0.3, 1.0, 0.9]]));
    let pencil = of_corners((0..200).map(|_| {
        let (tip, side) = (random.point(), random.point());
        let wide = |sign: f64| [0, 1, 2].map(|axis| sign * tip[axis] + 0.05 * side[axis]);
        [wide(-1.0), wide(1.0), tip]
    }));
    let fan = of_corners((0..200).map(|_| [[0.0; 3], random.point(), random.point()]));
    let stack = of_corners((0..40).flat_map(|level| square(1, f64::from(level % 20) * 0.1)));
    let faces =
        of_corners((0..3).flat_map(|axis| {
            [-1.0, 0.0, 1.0].into_iter().flat_map(move |place| square(axis, place))
        }));
    let doubled = (0..3).fold(Loaded::default(), |all, _| joined(all, &sphere(1)));
    let minus_zero = moved(&cube(), |p| p.map(|x| if x < 0.0 { -0.0 } else { 0.5 * x }));
    vec![
        Scene::open("five hundred times the same", &same),
        Scene::open("pencil", &pencil),
        Scene::open("fan", &fan),
        Scene::open("stack of parallel planes", &stack),
        Scene::open("flat ones in the faces of the box", &joined(faces, &soup(150, 32))),
        Scene::open("every face three times", &doubled),
        Scene::closed("coordinates of -0", &minus_zero),
    ]
}

/// Two triangles that are the square from -1 to 1 at `place` along `axis`.
fn square(axis: usize, place: f64) -> [[[f64; 3]; 3]; 2] {
    let corner = |u: f64, v: f64| {
        let mut corner = [place; 3];
        (corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (u, v);
        corner
    };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    [[0, 1, 2], [0, 2, 3]].map(|triangle| triangle.map(|index: usize| corners[index]))
}

/// Triangles much longer than wide, where rounding decides what is crossed.
fn thin() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for exponent in [-3, -5, -6, -7] {
        let width = 10.0_f64.powi(exponent);
        scenes.push(Scene::open(format!("needles 1e{exponent} wide"), &needles(250, width)));
    }
    let blades = moved(&soup_of_size(250, 42, 1.0), |[x, y, z]| [x, 1e-6 * y, z + 0.3 * x]);
    scenes.push(Scene::open("blades in a thin slab", &blades));
    scenes
}

/// Needles across the scene, every second one beside another.
fn needles(count: usize, width: f64) -> Loaded {
    let mut random = Random::new(41);
    of_corners((0..count).map(|_| {
        let (start, end, side) = (random.point(), random.point(), random.point());
        [start, end, [0, 1, 2].map(|axis| end[axis] + width * side[axis])]
    }))
}

/// Sizes and places at the ends of what f32 can hold.
fn extreme() -> Vec<Scene> {
    let shape = joined(soup(250, 51), &sphere(1));
    let mut scenes = Vec::new();
    for scale in [1e15, 1e30, 1e-15, 1e-30, 1e-42] {
        let scaled = moved(&shape, |p| p.map(|x| scale * x));
        scenes.push(Scene::open(format!("size {scale:e}"), &scaled));
    }
    for distance in [1e6, 1e9] {
        let far = moved(&shape, |[x, y, z]| [distance + x, y - distance, z]);
        scenes.push(Scene::open(format!("{distance:e} from the origin"), &far));
    }
    let deep = of_corners((0..120).map(|level| {
        let place = 0.5_f64.powi(level);
        [[place; 3], [1.5 * place, place, place], [place, 1.25 * place, 1.5 * place]]
    }));
    scenes.push(Scene::open("each half as far as the last", &deep));
    let subnormal = joined(moved(&soup(150, 52), |p| p.map(|x| 1e-41 * x)), &cube());
    scenes.push(Scene::open("subnormal coordinates in a cube", &subnormal));
    let needle_box = moved(&soup(250, 53), |[x, y, z]| [1e9 * x, y, 1e-9 * z]);
    scenes.push(Scene::open("a box 1e18 times as long as high", &needle_box));
    scenes
}
