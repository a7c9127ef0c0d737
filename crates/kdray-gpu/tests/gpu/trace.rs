//! Queries on devices give the answers of the tracer on the CPU, bit for bit.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use kdray::{BatchError, BuildOptions, Hit, Mesh, Ray, Tree};
use kdray_gpu::record::Recording;
use kdray_gpu::{Device, GpuError, Rays, TraceOptions, Tracer};
use kdray_test::rays::RayMaker;
use kdray_test::{Random, Scene, oracle, scenes, shared};

use crate::support::{lavapipe, swiftshader};

/// A mesh, its tree, and what answers on the CPU.
struct Subject {
    name: String,
    mesh: Mesh,
    tree: Tree,
}

impl Subject {
    fn of_scene(Scene { name, mesh, .. }: Scene) -> Self {
        Self::new(name, mesh)
    }

    fn new(name: String, mesh: Mesh) -> Self {
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
        Self { name, mesh, tree }
    }

    /// Rays of every kind, some of them with limits and some without meaning.
    fn rays(&self, count: usize, seed: u64) -> Vec<Ray> {
        let mut maker = RayMaker::new(&self.mesh, &self.tree, seed);
        let ranges = [-1.0..1.0, -20.9..-15.0, 15.0..20.9, -20.9..20.9];
        let mut ray = |index: usize| match index % 8 {
            kind @ 0..4 => maker.scaled(&ranges[kind]),
            _ => maker.any(),
        };
        (0..count).map(&mut ray).collect()
    }
}

fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.triangle, hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits()])
}

/// Closest hits and whether there are any, against every triangle.
fn check_first(device: &Device, subject: &Subject, count: usize) {
    let Subject { name, mesh, tree } = subject;
    let rays = subject.rays(count, 71);
    let tracer = Tracer::new(device, mesh, tree).expect("it fits");
    let batch = tracer.batch(TraceOptions::default());
    let (mut hits, mut found) = (vec![None; count], vec![false; count]);
    batch.closest_hits(&rays, &mut hits).unwrap_or_else(|error| panic!("{name}: {error}"));
    batch.any_hits(&rays, &mut found).unwrap_or_else(|error| panic!("{name}: {error}"));
    for ((ray, hit), found) in rays.iter().zip(hits).zip(found) {
        let expected = oracle::closest_hit(mesh, ray);
        assert_eq!(bits(hit), bits(expected), "{name}: {ray:?}: {hit:?}, not {expected:?}");
        assert_eq!(found, expected.is_some(), "{name}: {ray:?}");
    }
}

/// All hits in order and their numbers, against every triangle.
fn check_all(device: &Device, subject: &Subject, count: usize) {
    let Subject { name, mesh, tree } = subject;
    let rays = subject.rays(count, 76);
    let tracer = Tracer::new(device, mesh, tree).expect("it fits");
    let expected: Vec<Vec<Hit>> = rays.iter().map(|ray| oracle::all_hits(mesh, ray)).collect();
    check_lists(&tracer, name, &rays, &expected);
}

fn check_lists(tracer: &Tracer, name: &str, rays: &[Ray], expected: &[Vec<Hit>]) {
    let batch = tracer.batch(TraceOptions::default());
    let mut counts = vec![0; rays.len()];
    batch.count_hits(rays, &mut counts).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut done = 0;
    let listed = batch.all_hits(rays, |lists| {
        assert_eq!(lists.first, done, "{name}: rays come in order");
        for hits in lists.lists() {
            let (ray, expected) = (rays[done], &expected[done]);
            let same = |(one, other): (&Hit, &Hit)| bits(Some(*one)) == bits(Some(*other));
            let is_same = hits.len() == expected.len() && hits.iter().zip(expected).all(same);
            assert!(is_same, "{name}: {ray:?}: {hits:?}, not {expected:?}");
            assert_eq!(counts[done] as usize, hits.len(), "{name}: {ray:?}");
            done += 1;
        }
        ControlFlow::Continue(())
    });
    listed.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(done, rays.len(), "{name}: every ray has a list");
}

#[test]
fn hits_of_every_scene() {
    for scene in scenes::all() {
        let subject = Subject::of_scene(scene);
        check_first(lavapipe(), &subject, 2000);
        check_all(lavapipe(), &subject, 1000);
    }
}

#[test]
fn hits_of_small_scenes_on_a_second_driver() {
    for scene in scenes::all().filter(|scene| scene.mesh.triangles().len() <= 250) {
        let subject = Subject::of_scene(scene);
        check_first(swiftshader(), &subject, 300);
        check_all(swiftshader(), &subject, 100);
    }
}

/// More rays than are on the device at once, and more hits than it may bind.
#[test]
fn lists_come_in_parts() {
    let subject = Subject::of_scene(scenes::ordinary().swap_remove(0));
    let layers = (0..2000).map(|layer| {
        let z = f64::from(layer);
        [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]]
    });
    let layers = Subject::of_scene(Scene::open("layers", &scenes::of_corners(layers)));
    for (subject, count) in [(subject, 300_000), (layers, 4500)] {
        let ray = |index: usize| Ray::new([0.25, 0.125, index as f32 - 5.0], [0.0, 0.0, 1.0]);
        let rays: Vec<Ray> = (0..count).map(|index| ray(index % 100)).collect();
        let cpu = kdray::Tracer::new(&subject.mesh, &subject.tree);
        let list = |ray: &Ray| {
            let mut hits = Vec::new();
            cpu.all_hits(ray, &mut hits);
            hits
        };
        let first: Vec<Vec<Hit>> = rays[..100].iter().map(list).collect();
        let expected: Vec<_> = (0..count).map(|index| first[index % 100].clone()).collect();
        let tracer = Tracer::new(lavapipe(), &subject.mesh, &subject.tree).expect("it fits");
        check_lists(&tracer, &subject.name, &rays, &expected);
    }
}

/// Rays that are on the device, whose answers stay there: the same bits.
#[test]
fn rays_on_the_device_get_what_rays_of_the_host_get() {
    let device = lavapipe();
    let subject = Subject::of_scene(scenes::ordinary().swap_remove(3));
    let (tracer, _) = Tracer::build(device, &subject.mesh, &BuildOptions::default()).expect("fits");
    let rays = subject.rays(700, 80);
    let (count, words) = (rays.len() as u32, rays.len() as u64);
    let uploaded = device.upload("rays", &rays).expect("it fits");
    let on_device = Rays { rays: uploaded, except: None, count, live: None };
    let buffer = |each: u64| device.buffer("answers", each * words).expect("it fits");
    let (triangles, hits, found) = (buffer(1), buffer(4), buffer(1));
    let mut recording = Recording::new(device);
    tracer.record_closest(&mut recording, &on_device, [&triangles, &hits]);
    tracer.record_any(&mut recording, &on_device, &found);
    recording.run().expect("it runs");
    let hits: Vec<Hit> = device.read(&hits).expect("it is read");
    let found: Vec<u32> = device.read(&found).expect("it is read");
    let mut lists = Vec::new();
    let taken = tracer.all_hits(&on_device, |part, found| {
        assert_eq!(part.start as usize, lists.len());
        let [starts, counts]: [Vec<u32>; 2] =
            [device.read(&found.starts)?, device.read(&found.counts)?];
        let hits: Vec<Hit> = device.read(&found.hits)?;
        for (start, count) in starts.into_iter().zip(counts) {
            lists.push(hits[start as usize..(start + count) as usize].to_vec());
        }
        Ok(())
    });
    taken.expect("it runs");
    for (index, ray) in rays.iter().enumerate() {
        let expected = oracle::all_hits(&subject.mesh, ray);
        let hit = (hits[index].triangle != u32::MAX).then_some(hits[index]);
        assert_eq!(bits(hit), bits(expected.first().copied()), "{ray:?}");
        assert_eq!(found[index] == 1, !expected.is_empty(), "{ray:?}");
        assert_eq!(lists[index], expected, "{ray:?}");
    }
}

/// Sets of rays such as users trace: through the pixels of a camera, from what these hit to
/// anywhere and to a light, between points of the box, and those of [`RayMaker`].
fn ray_sets(subject: &Subject, count: usize) -> Vec<(&'static str, Vec<Ray>)> {
    let bounds = subject.mesh.bounds();
    let (extent, mut random) = (bounds.extent(), Random::new(72));
    let place = |share: [f64; 3]| {
        [0, 1, 2].map(|axis| bounds.lower[axis] + extent[axis] * share[axis] as f32)
    };
    let between =
        |from: [f32; 3], to: [f32; 3]| Ray::new(from, [0, 1, 2].map(|axis| to[axis] - from[axis]));
    let side = (count as f64).sqrt().ceil() as usize;
    let pixel = |index: usize| {
        let along = |place: usize| (place as f64 + 0.5) / side as f64;
        let target = [along(index % side), along(index / side), 0.5];
        between(place([0.6, 0.7, 2.5]), place(target))
    };
    let primary: Vec<Ray> = (0..count).map(pixel).collect();
    let tracer = kdray::Tracer::new(&subject.mesh, &subject.tree);
    let hit = |ray: &Ray| tracer.closest_hit(ray).map(|hit| ray.at(hit.t));
    let surface: Vec<[f32; 3]> = primary.iter().filter_map(hit).collect();
    // As many as there are primary rays: points are left again and again.
    let surface = || surface.iter().cycle().take(count);
    let bounce = surface().map(|point| Ray::new(*point, random.point().map(|v| v as f32)));
    let bounce = bounce.collect();
    let mut unit = || [(); 3].map(|()| random.unit());
    let shadow = surface().map(|point| {
        let [x, _, z] = unit();
        let light = place([0.2 + 0.2 * x, 1.5, 0.7 + 0.2 * z]);
        Ray { t_max: 1.0, ..between(*point, light) }
    });
    let shadow = shadow.collect();
    let chord = (0..count).map(|_| between(place(unit()), place(unit()))).collect();
    let mut maker = RayMaker::new(&subject.mesh, &subject.tree, 73);
    // Some lie in planes full of triangles, and take as long as thousands of others.
    let hard = (0..count.div_ceil(16)).map(|_| maker.line()).collect();
    vec![
        ("primary", primary),
        ("bounce", bounce),
        ("shadow", shadow),
        ("chord", chord),
        ("hard", hard),
    ]
}

/// Answers are those of the tracer on the CPU. Says how fast both are.
fn check_beside_the_cpu(file: &str, count: usize) {
    let Some(mesh) = shared::mesh(file) else { return };
    let subject = Subject::new(file.to_owned(), mesh);
    let cpu = kdray::Tracer::new(&subject.mesh, &subject.tree);
    let tracer = Tracer::new(lavapipe(), &subject.mesh, &subject.tree).expect("it fits");
    tracer.prepare().expect("the kernels compile");
    let batch = tracer.batch(TraceOptions::default());
    for (set, rays) in ray_sets(&subject, count) {
        let none = || vec![None; rays.len()];
        let (mut hits, mut expected, mut counted) = (none(), none(), none());
        let start = Instant::now();
        batch.closest_hits(&rays, &mut hits).expect("the device answers");
        let gpu_seconds = start.elapsed().as_secs_f64();
        let start = Instant::now();
        cpu.closest_hits(&rays, &mut expected);
        let cpu_seconds = start.elapsed().as_secs_f64();
        let report = batch.closest_hits_reported(&rays, &mut counted).expect("the device answers");
        let (mut found, mut any) = (vec![false; rays.len()], vec![false; rays.len()]);
        batch.any_hits(&rays, &mut found).expect("the device answers");
        cpu.any_hits(&rays, &mut any);
        for (index, ray) in rays.iter().enumerate() {
            let (hit, expected) = (hits[index], expected[index]);
            assert_eq!(bits(hit), bits(expected), "{file}, {set}: {ray:?}: {hit:?}, {expected:?}");
            assert_eq!(bits(hit), bits(counted[index]), "{file}, {set}: {ray:?}");
            assert_eq!(found[index], any[index], "{file}, {set}: {ray:?}");
        }
        let mut lists = Vec::with_capacity(rays.len());
        let all = kdray::BatchOptions::default();
        let gathered = cpu.batch(all).and_then(|batch| {
            batch.all_hits(&rays, |found| {
                lists.extend(found.lists().map(<[Hit]>::to_vec));
                ControlFlow::Continue(())
            })
        });
        gathered.expect("nobody cancels");
        check_lists(&tracer, &format!("{file}, {set}"), &rays, &lists);
        let million = rays.len() as f64 / 1e6;
        let each = |count: u64| count as f64 / rays.len() as f64;
        println!(
            "{file}, {set}: {million:.2} M rays; {:.2} M/s on the device, {:.2} M/s on the CPU; a \
             ray visits {:.1} nodes, {:.1} leaves and tests {:.1} triangles; {:?}",
            million / gpu_seconds,
            million / cpu_seconds,
            each(report.steps),
            each(report.leaves),
            each(report.tests),
            report.profile.stages.iter().map(|it| (it.name, it.seconds)).collect::<Vec<_>>(),
        );
    }
}

#[test]
fn first_hits_of_real_meshes() {
    for file in ["bunny.ply", "sponza.ply", "conference.ply"] {
        check_beside_the_cpu(file, 10_000);
    }
}

/// Takes minutes on two cores.
#[test]
#[ignore = "long"]
fn a_million_rays_of_every_set() {
    for file in ["bunny.ply", "sponza.ply", "conference.ply"] {
        check_beside_the_cpu(file, 1 << 20);
    }
}

#[test]
fn rays_do_not_see_the_triangles_that_are_excepted() {
    let subject = Subject::of_scene(scenes::ordinary().swap_remove(3));
    let rays = subject.rays(1000, 74);
    let tracer = Tracer::new(lavapipe(), &subject.mesh, &subject.tree).expect("it fits");
    let mut hits = vec![None; rays.len()];
    tracer.batch(TraceOptions::default()).closest_hits(&rays, &mut hits).expect("it answers");
    let except: Vec<u32> =
        hits.iter().map(|hit| hit.map_or(u32::MAX, |hit| hit.triangle)).collect();
    let batch = tracer.batch(TraceOptions { except: Some(&except), ..TraceOptions::default() });
    let (mut second, mut found) = (vec![None; rays.len()], vec![false; rays.len()]);
    batch.closest_hits(&rays, &mut second).expect("it answers");
    batch.any_hits(&rays, &mut found).expect("it answers");
    let cpu = kdray::Tracer::new(&subject.mesh, &subject.tree);
    for (index, ray) in rays.iter().enumerate() {
        let expected = cpu.only(|triangle| triangle != except[index]).closest_hit(ray);
        assert_eq!(bits(second[index]), bits(expected), "{ray:?}");
        assert_eq!(found[index], expected.is_some(), "{ray:?}");
    }
    assert!(found.iter().filter(|found| **found).count() > 100);
}

#[test]
fn batches_can_be_empty_and_cancelled() {
    let subject = Subject::of_scene(scenes::ordinary().swap_remove(3));
    let tracer = Tracer::new(lavapipe(), &subject.mesh, &subject.tree).expect("it fits");
    tracer.batch(TraceOptions::default()).closest_hits(&[], &mut []).expect("nothing is asked");
    let (cancel, rays) = (AtomicBool::new(true), subject.rays(10, 75));
    let batch = tracer.batch(TraceOptions { cancel: Some(&cancel), ..TraceOptions::default() });
    let error = batch.any_hits(&rays, &mut [false; 10]).unwrap_err();
    assert_eq!(error, GpuError::Batch(BatchError::Cancelled));
}

/// Smaller scenes in the memory of a larger one, one without triangles, and a larger one at last.
#[test]
fn a_tracer_takes_other_meshes_in_the_memory_it_has() {
    let device = lavapipe();
    let soup = |count| Scene::open("soup", &scenes::soup_of_size(count, 77, 0.3));
    let subjects = [500, 40, 0, 450, 900].map(|count| Subject::of_scene(soup(count)));
    let [first, ..] = &subjects;
    let mut tracer = Tracer::new(device, &first.mesh, &first.tree).expect("it fits");
    let size = tracer.size_bytes();
    for (index, subject) in subjects.iter().enumerate() {
        tracer.replace(&subject.mesh, &subject.tree).expect("it fits");
        assert_eq!(tracer.size_bytes() == size, index < 4, "memory for scene {index}");
        let rays = subject.rays(500, 78);
        let mut hits = vec![None; rays.len()];
        tracer.batch(TraceOptions::default()).closest_hits(&rays, &mut hits).expect("it runs");
        for (ray, hit) in rays.iter().zip(hits) {
            assert_eq!(bits(hit), bits(oracle::closest_hit(&subject.mesh, ray)), "{ray:?}");
        }
    }
}
