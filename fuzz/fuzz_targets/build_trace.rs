//! Any triangles and any ray: all builders agree, the tree is valid, and the tracer finds the hit
//! that trying every triangle finds.

#![no_main]

use kdray::trace::intersect;
use kdray::{BuildOptions, Builder, Mesh, Ray, Tracer, Tree};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: ([[f32; 3]; 2], Vec<[[f32; 3]; 3]>)| {
    let ([origin, direction], corners) = input;
    let indices = |triangle: usize| [0, 1, 2].map(|corner| (3 * triangle + corner) as u32);
    let triangles: Vec<[u32; 3]> = (0..corners.len().min(64)).map(indices).collect();
    let Ok(mesh) = Mesh::new(corners.as_flattened(), &triangles) else { return };

    let build = |builder| {
        Tree::build(&mesh, &BuildOptions { builder, threads: 1, ..BuildOptions::default() })
    };
    let tree = build(Builder::Exact).expect("the options are in range");
    assert_eq!(Ok(&tree), build(Builder::Resort).as_ref());
    assert_eq!(Ok(&tree), build(Builder::Naive).as_ref());
    assert_eq!(tree.validate(&mesh), Ok(()));

    let ray = Ray::new(origin, direction);
    let hits = (0..triangles.len())
        .filter_map(|triangle| intersect(&ray, triangle as u32, &mesh.triangle(triangle)));
    let closest = hits.reduce(|best, hit| if hit.t < best.t { hit } else { best });
    let tracer = Tracer::new(&mesh, &tree);
    assert_eq!(tracer.closest_hit(&ray), closest);
    assert_eq!(tracer.any_hit(&ray), closest.is_some());
});
