//! A line crosses a closed mesh an even number of times, wherever it goes through.

use kdray::{BuildOptions, Mesh, Ray, Tree};
use kdray_test::rays::RayMaker;
use kdray_test::{Scene, oracle, scenes};

/// The ray and its way back, to both ends.
fn line(ray: &Ray) -> Ray {
    Ray { t_min: f32::NEG_INFINITY, t_max: f32::INFINITY, ..*ray }
}

fn crossings(mesh: &Mesh, ray: &Ray) -> usize {
    oracle::hits(mesh, &line(ray)).count()
}

fn assert_even(name: &str, mesh: &Mesh, ray: &Ray) {
    let crossings = crossings(mesh, ray);
    assert!(crossings.is_multiple_of(2), "{name}: {crossings} crossings of {:?}", line(ray));
}

/// At vertices, along edges, in the planes of flat faces, along the axes, and anywhere.
#[test]
fn lines_cross_closed_meshes_evenly() {
    for Scene { name, mesh, .. } in scenes::closed().into_iter().chain(closed_of_all()) {
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
        let mut maker = RayMaker::new(&mesh, &tree, 5);
        for _ in 0..4000 {
            assert_even(&name, &mesh, &maker.line());
        }
    }
}

fn closed_of_all() -> impl Iterator<Item = Scene> {
    scenes::all().filter(|scene| scene.is_closed)
}

/// Through every vertex and the middle of every edge, along the axes and along a diagonal.
#[test]
fn lines_through_every_vertex_and_edge() {
    let directions = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, -0.0],
        [1.0, 1.0, 0.0],
        [1.0, -1.0, 1.0],
        [0.3, 0.7, -0.2],
    ];
    for Scene { name, mesh, .. } in scenes::closed() {
        for triangle in 0..mesh.triangles().len().min(300) {
            let [a, b, _] = mesh.triangle(triangle);
            let middle = [0, 1, 2].map(|axis| a[axis] + 0.5 * (b[axis] - a[axis]));
            for origin in [a, middle] {
                for direction in directions {
                    assert_even(&name, &mesh, &Ray::new(origin, direction));
                }
            }
        }
    }
}

/// From inside a convex solid there is one way out, at vertices and edges too.
#[test]
fn rays_from_inside_leave_once() {
    for scene in ["cube", "sphere"] {
        let scenes = scenes::ordinary();
        let Scene { name, mesh, .. } =
            scenes.iter().find(|s| s.name == scene).expect("it is there");
        let mut targets = mesh.positions().to_vec();
        for triangle in 0..mesh.triangles().len() {
            let [a, b, _] = mesh.triangle(triangle);
            targets.push([0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis])));
        }
        for target in targets {
            let hits = oracle::hits(mesh, &Ray::new([0.0; 3], target)).count();
            assert_eq!(hits, 1, "{name}: {target:?}");
        }
    }
}
