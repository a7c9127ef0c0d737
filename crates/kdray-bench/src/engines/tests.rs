//! Every engine answers as a brute-force search does.

use std::env;
use std::path::PathBuf;

use kdray::{Mesh, Ray};
use obvhs::triangle::Triangle;

use super::Engines;
use super::obvhs::{obvhs_ray, triangles};
use crate::definition::{Definition, Library, Mode, RaySet, Source};
use crate::engine::{Hit, Index};
use crate::rays::RayMaker;
use crate::trace::Answers;

/// Rays of a set that rounding may decide: those that graze an edge, and those that start
/// so close to a surface that their distance to it is mostly error.
const DECIDED_BY_ROUNDING: f64 = 2.0;

fn brute_force(triangles: &[Triangle], ray: &Ray) -> Hit {
    let ray = obvhs_ray(ray);
    let hits = triangles
        .iter()
        .zip(0..)
        .map(|(shape, triangle)| Hit { t: shape.intersect(&ray), triangle });
    let nearer = |a: Hit, b: Hit| if b.t < a.t { b } else { a };
    hits.fold(Hit::MISS, nearer)
}

fn closest(mesh: &Mesh, rays: &[Ray]) -> Vec<Hit> {
    let triangles = triangles(mesh);
    rays.iter().map(|ray| brute_force(&triangles, ray)).collect()
}

fn check(name: &str, index: &dyn Index, mesh: &Mesh, mode: Mode) {
    let reference = |rays: &[Ray]| closest(mesh, rays);
    let maker = RayMaker::new(mesh, 28, &reference);
    for set in [RaySet::Primary, RaySet::Bounce, RaySet::Chord, RaySet::Shadow] {
        // An odd count leaves the last packet part empty.
        let rays = &maker.rays(set)[1..];
        let truth = closest(mesh, rays);
        let mut hits = vec![Hit::MISS; rays.len()];
        index.closest(mode, rays, &mut hits);
        let any_truth = Answers::Any(truth.iter().map(|hit| hit.is_hit()).collect());
        let (truth, hits) = (Answers::Closest(truth), Answers::Closest(hits));
        let differ = hits.disagreement(&truth) * rays.len() as f64;
        assert!(differ <= DECIDED_BY_ROUNDING, "{name} {mode:?} closest {set:?}: {differ} rays");

        let mut occluded = vec![false; rays.len()];
        index.any(mode, rays, &mut occluded);
        let differ = Answers::Any(occluded).disagreement(&any_truth) * rays.len() as f64;
        assert!(differ <= DECIDED_BY_ROUNDING, "{name} {mode:?} any {set:?}: {differ} rays");
    }
}

#[test]
fn every_engine_of_the_peers_agrees_with_brute_force() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../bench/definitions/peers.toml");
    let definition = Definition::load(&path).expect("shipped definitions are valid");
    let mesh = crate::scene::load(&Source::Showcase(2_000), None).expect("generated");
    let embree = env::var_os("KDRAY_EMBREE").filter(|path| !path.is_empty());
    let embree = embree.map(PathBuf::from);
    let engines = Engines::new(embree.as_deref());
    for engine in &definition.engines {
        if embree.is_none() && matches!(engine.library, Library::Embree(_)) {
            println!("{} is not tested: KDRAY_EMBREE names no library", engine.name);
            continue;
        }
        let builder = engines.make(engine).and_then(|e| e.builder(2)).expect("present");
        let index = builder.build(&mesh).expect("the scene is ordinary");
        for mode in &engine.modes {
            check(&engine.name, index.as_ref(), &mesh, *mode);
        }
    }
}
