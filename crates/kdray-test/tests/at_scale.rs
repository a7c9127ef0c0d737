//! Millions of queries of every mesh in a folder, against every triangle.
//!
//! Takes a while, so it runs when asked for, on the meshes of up to 100,000 triangles in the folder
//! that the variable `KDRAY_MESHES` names:
//!
//! ```sh
//! KDRAY_MESHES=../shared/meshes cargo test -p kdray-test --test at_scale -- --ignored --nocapture
//! ```
//!
//! `KDRAY_RAYS` changes the number of rays. A small generated scene is checked in every run.

use std::collections::HashSet;
use std::path::PathBuf;
use std::time::Instant;

use kdray::{Aabb, BatchOptions, BuildOptions, Hit, Mesh, Ray, Sign, Tracer, Tree, Winding};
use kdray_test::rays::RayMaker;
use kdray_test::sieve::Sieve;
use kdray_test::{oracle, scenes};
use rayon::prelude::*;

/// Meshes with more triangles are passed over.
const LARGEST: usize = 100_000;

struct Subject {
    name: String,
    mesh: Mesh,
    tree: Tree,
    tracer: Tracer,
}

impl Subject {
    fn new(name: String, mesh: Mesh) -> Self {
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
        let tracer = Tracer::new(&mesh, &tree);
        Self { name, mesh, tree, tracer }
    }

    /// All checks, with about `rays` rays.
    fn check(&self, rays: usize) {
        let Self { name, mesh, .. } = self;
        let start = Instant::now();
        let closed = is_closed(mesh);
        println!(
            "{name}: {} triangles{}",
            mesh.triangles().len(),
            if closed { ", closed" } else { "" }
        );
        let hits = self.check_hits(rays);
        println!("  {hits} hits of {rays} rays as brute force, {:.0?}", start.elapsed());
        self.check_points(rays / 100);
        println!("  {} points and regions as brute force, {:.0?}", rays / 100, start.elapsed());
        if closed {
            let lines = self.check_parity(rays);
            println!("  {lines} lines cross evenly, {:.0?}", start.elapsed());
            let points = self.check_inside(rays / 10);
            println!("  {points} points inside as by winding, {:.0?}", start.elapsed());
        }
    }

    fn maker(&self, seed: u64) -> RayMaker<'_> {
        RayMaker::new(&self.mesh, &self.tree, seed)
    }

    fn check_hits(&self, count: usize) -> usize {
        let mut maker = self.maker(61);
        let rays: Vec<Ray> = (0..count).map(|_| maker.line()).collect();
        let sieve = Sieve::new(&self.mesh);
        let check = |rays: &[Ray]| {
            let mut found = Vec::new();
            let wanted = sieve.all_hits(rays);
            for (ray, wanted) in rays.iter().zip(&wanted) {
                self.tracer.all_hits(ray, &mut found);
                let key = |hit: &Hit| (hit.triangle, hit.t.to_bits());
                let is_right = found.iter().map(key).eq(wanted.iter().map(key));
                assert!(is_right, "{}: {ray:?}: {found:?}, not {wanted:?}", self.name);
            }
            wanted.iter().map(Vec::len).sum::<usize>()
        };
        rays.par_chunks(64).map(check).sum()
    }

    fn check_points(&self, count: usize) {
        let mut maker = self.maker(62);
        let pairs: Vec<_> = (0..count).map(|_| (maker.line().origin, maker.target())).collect();
        pairs.par_iter().for_each(|(point, other)| {
            self.check_closest(*point);
            self.check_box(&Aabb::of_points(&[*point, *other]));
        });
    }

    /// Within two ulps of brute force, and the sphere of that size holds a triangle.
    fn check_closest(&self, point: [f32; 3]) {
        let Self { name, mesh, tracer, .. } = self;
        let wanted = oracle::closest_distance(mesh, point).expect("there are triangles").sqrt();
        let found = tracer.closest_point(point, f32::INFINITY).expect("there are triangles");
        let ulp = f64::from((wanted as f32).next_up()) - f64::from(wanted as f32);
        let off = (f64::from(found.distance) - wanted).abs();
        let rounding = 1e-14 * reach_of(mesh, point);
        assert!(off <= 2.0 * ulp + rounding, "{name}: {point:?}: {found:?}, not {wanted}");
        let radius = 1.5 * found.distance;
        let mut within = Vec::new();
        tracer.within_sphere(point, radius, &mut within);
        let limit = f64::from(radius) * f64::from(radius);
        for triangle in 0..mesh.triangles().len() as u32 {
            let squared = oracle::squared_distance(point, &mesh.triangle(triangle as usize));
            if (squared - limit).abs() > 1e-12 * limit + rounding * rounding {
                let is_within = within.binary_search(&triangle).is_ok();
                assert_eq!(is_within, squared < limit, "{name}: {triangle} {point:?} {radius}");
            }
        }
    }

    fn check_box(&self, region: &Aabb) {
        let mut within = Vec::new();
        self.tracer.within_box(region, &mut within);
        for triangle in 0..self.mesh.triangles().len() as u32 {
            let corners = self.mesh.triangle(triangle as usize);
            let bounds = Aabb::of_points(&corners);
            let apart = (0..3).any(|axis| {
                bounds.upper[axis] < region.lower[axis] || region.upper[axis] < bounds.lower[axis]
            });
            let wanted =
                if apart { Some(false) } else { oracle::clearly_overlaps(&corners, region) };
            if let Some(wanted) = wanted {
                let is_within = within.binary_search(&triangle).is_ok();
                assert_eq!(is_within, wanted, "{}: {triangle} {region:?}", self.name);
            }
        }
    }

    /// Random lines, and lines through every vertex and the middle of every edge.
    fn check_parity(&self, count: usize) -> usize {
        let Self { name, mesh, tracer, .. } = self;
        let mut maker = self.maker(63);
        let mut rays: Vec<Ray> = (0..count).map(|_| maker.line()).collect();
        let mut aim = |target: [f32; 3]| {
            let origin = maker.line().origin;
            let direction = [0, 1, 2].map(|axis| target[axis] - origin[axis]);
            // From the target itself, which it would be at, it goes anywhere.
            let here = direction == [0.0; 3];
            rays.push(Ray::new(origin, if here { [0.0, 0.0, 1.0] } else { direction }));
            rays.push(Ray::new(target, direction.map(|v| if here { 1.0 } else { v })));
        };
        mesh.positions().iter().for_each(|target| aim(*target));
        for [a, b] in edges(mesh) {
            let [a, b] = [a, b].map(|vertex| mesh.positions()[vertex as usize]);
            aim([0, 1, 2].map(|axis| a[axis] + 0.5 * (b[axis] - a[axis])));
        }
        rays.par_iter().for_each(|ray| {
            let line = Ray { t_min: f32::NEG_INFINITY, ..*ray };
            let crossings = tracer.count_hits(&line);
            assert!(crossings.is_multiple_of(2), "{name}: {crossings} crossings of {line:?}");
        });
        rays.len()
    }

    /// Points inside by parity are those around which the mesh winds an odd number of times. Many
    /// of them together are told what each is told alone.
    fn check_inside(&self, count: usize) -> usize {
        let Self { name, mesh, tracer, .. } = self;
        let winding = Winding::new(mesh);
        let mut maker = self.maker(64);
        let points: Vec<[f32; 3]> = (0..count).map(|_| maker.line().origin).collect();
        let mut together = vec![false; count];
        let batch = tracer.batch(BatchOptions::default()).expect("no threads are started");
        batch.contains(&points, Sign::Parity, &mut together).expect("nobody cancels");
        let alone = points.par_iter().zip(&together);
        alone.for_each(|(point, told)| {
            assert_eq!(tracer.contains(*point), *told, "{name}: {point:?}")
        });
        let is_checked = |point: &&[f32; 3]| {
            let found = tracer.closest_point(**point, f32::INFINITY).expect("there are triangles");
            if f64::from(found.distance) < 1e-6 * reach_of(mesh, **point) {
                return false;
            }
            let number = winding.number(**point, 0.1);
            let odd = number.round().rem_euclid(2.0) == 1.0;
            assert_eq!(tracer.contains(**point), odd, "{name}: {point:?}: {number}");
            true
        };
        points.par_iter().filter(is_checked).count()
    }
}

/// The largest coordinate in play.
fn reach_of(mesh: &Mesh, point: [f32; 3]) -> f64 {
    let Aabb { lower, upper } = mesh.bounds();
    let all = lower.into_iter().chain(upper).chain(point);
    all.fold(0.0, |reach, v| reach.max(f64::from(v.abs())))
}

/// Every edge once, from its lower vertex to its higher.
fn edges(mesh: &Mesh) -> HashSet<[u32; 2]> {
    let of = |[a, b, c]: &[u32; 3]| [[*a, *b], [*b, *c], [*c, *a]];
    mesh.triangles().iter().flat_map(of).map(|[a, b]| [a.min(b), a.max(b)]).collect()
}

/// Whether every edge, from either side, is there as often as its opposite.
fn is_closed(mesh: &Mesh) -> bool {
    let mut uses = std::collections::HashMap::new();
    let of = |[a, b, c]: &[u32; 3]| [[*a, *b], [*b, *c], [*c, *a]];
    let place = |vertex: u32| mesh.positions()[vertex as usize].map(f32::to_bits);
    for [a, b] in mesh.triangles().iter().flat_map(of) {
        let [a, b] = [place(a), place(b)];
        *uses.entry([a.min(b), a.max(b)]).or_insert(0) += 1_usize;
    }
    uses.values().all(|count| count.is_multiple_of(2))
}

#[test]
fn a_generated_scene() {
    let scene = scenes::ordinary().swap_remove(4);
    Subject::new(scene.name.to_string(), scene.mesh).check(20_000);
}

#[test]
#[ignore = "takes minutes a mesh, and a folder of meshes"]
fn every_mesh_of_a_folder() {
    let folder = PathBuf::from(std::env::var_os("KDRAY_MESHES").expect("KDRAY_MESHES is a folder"));
    let folder = if folder.is_relative() {
        // Cargo runs tests in the folder of their crate.
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(folder)
    } else {
        folder
    };
    let rays =
        std::env::var("KDRAY_RAYS").map_or(1_000_000, |rays| rays.parse().expect("a number"));
    let entries = std::fs::read_dir(&folder).expect("KDRAY_MESHES can be read");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    let mut checked = 0;
    for file in files.iter().filter(|file| file.extension().is_some_and(|it| it == "ply")) {
        let mesh = kdray_mesh::load(file).expect("a well-formed mesh").mesh().expect("finite");
        if mesh.triangles().len() <= LARGEST {
            Subject::new(file.display().to_string(), mesh).check(rays);
            checked += 1;
        }
    }
    assert!(checked > 0, "no mesh of at most {LARGEST} triangles in {}", folder.display());
}
