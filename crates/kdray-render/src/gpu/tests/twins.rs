//! What kernels give, beside what the CPU gives.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use kdray::{BuildOptions, Mesh, Ray, Tree};
use kdray_gpu::device::Buffer;
use kdray_gpu::record::{Kernel, Moved, Recording, Work};
use kdray_mesh::generate;
use kdray_test::Random;

use super::lavapipe;
use crate::film::View;
use crate::gpu::film::Cell;
use crate::gpu::kernels::{ACCUMULATE, CAMERA, NONE, Params, SAMPLED, SURFACE};
use crate::gpu::looks::Looks;
use crate::gpu::room::{Length, Room};
use crate::pixel::{Sample, Sums, Surface};
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::{Camera, RenderOptions};

/// As in `picture.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Point {
    position: Vec3,
    error: f32,
    geometric: Vec3,
    haze: f32,
    shading: Vec3,
    kind: u32,
    albedo: Vec3,
    path: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Path {
    background: Vec3,
    haze: f32,
    position: Vec3,
    has_surface: u32,
    normal: Vec3,
    rays: u32,
    albedo: Vec3,
    hits: u32,
    light: Vec3,
    unused: u32,
    throughput: Vec3,
    unused_too: u32,
}

fn run(kernel: &'static Kernel, params: &Params, buffers: &[&Buffer]) {
    let mut recording = Recording::new(lavapipe());
    record(&mut recording, kernel, params, buffers);
    recording.run().expect("it runs");
}

fn record(
    recording: &mut Recording,
    kernel: &'static Kernel,
    params: &Params,
    buffers: &[&Buffer],
) {
    let work = Work::each(&params.bound.into());
    recording.dispatch(kernel, params, buffers, &work, |_| Moved::default());
}

/// Bit for bit: every dimension, odd and even bits, pixels beyond the curve, samples that repeat.
#[test]
fn random_numbers_are_those_of_the_cpu() {
    for samples in [1, 2, 3, 8, 16, 1000, 16_384, 20_000] {
        for first_pixel in [0, 70_000, 600 * 1300 + 500] {
            for bounce in [0, 1, 7] {
                let params = Params {
                    bound: 1000,
                    at: NONE,
                    width: 1300,
                    height: 1000,
                    samples,
                    sample_bits: Sampler::sample_bits(samples),
                    first_pixel,
                    first_sample: samples / 2,
                    samples_here: 2,
                    bounce,
                    ..Params::default()
                };
                check_samples(&params);
            }
        }
    }
}

fn check_samples(params: &Params) {
    let device = lavapipe();
    let squares = device.buffer("squares", 2 * u64::from(params.bound)).expect("it fits");
    run(&SAMPLED, params, &[&squares]);
    let found: Vec<[f32; 2]> = device.read(&squares).expect("it can be read");
    for (path, found) in (0..).zip(found) {
        let pixel = params.first_pixel + path / 2;
        let sample = params.first_sample + path % 2;
        let pixel = [pixel % params.width, pixel / params.width];
        let mut sampler = Sampler::new(pixel, sample, params.samples);
        let expected = (0..=params.bounce).map(|_| sampler.next()).last().expect("one at least");
        assert_eq!(found.map(f32::to_bits), expected.map(f32::to_bits), "{params:?} {path}");
    }
}

/// A scene with parts, a floor, and what is smooth and what is not.
fn showcase() -> (Mesh, Tree) {
    let mesh = generate::showcase(3000).mesh().expect("generated meshes are finite");
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
    (mesh, tree)
}

#[test]
fn rays_and_surfaces_are_those_of_the_cpu() {
    let (device, (mesh, tree)) = (lavapipe(), showcase());
    let options = RenderOptions { width: 90, height: 70, ..RenderOptions::default() };
    let framing = Camera::framing_mesh(&mesh, Camera::Y_UP, options.aspect());
    let camera = Camera { fov: 80.0, ..framing };
    let scene = Scene::new(&mesh, &camera, &options);
    let bound = options.width * options.height;
    let of_picture = Params::of(&scene, &camera, &options);
    let params = Params { bound, at: NONE, samples_here: 1, first_sample: 3, ..of_picture };
    let room = Room::new(device, bound).expect("it fits");
    let tracer = kdray_gpu::Tracer::new(device, &mesh, &tree).expect("it fits");
    let mut looks = Looks::of_nothing(device).expect("it fits");
    looks.replace(device, &scene).expect("it fits");
    let queue = &room.queues[0];
    let mut recording = Recording::new(device);
    record(&mut recording, &CAMERA, &params, &[&queue.rays, &queue.ids]);
    let rays = Length::known(bound).of(&queue.rays);
    tracer.record_closest(&mut recording, &rays, [&room.triangles, &room.hits]);
    let [positions, triangles] = tracer.mesh();
    let Looks { normals, palette } = &looks;
    let scene_of = [&room.hits, positions, triangles, normals, palette, &room.points];
    let buffers = [vec![&queue.rays, &queue.ids], scene_of.to_vec()].concat();
    record(&mut recording, &SURFACE, &params, &buffers);
    recording.run().expect("it runs");
    let rays: Vec<Ray> = device.read(&queue.rays).expect("it can be read");
    let points: Vec<Point> = device.read(&room.points).expect("it can be read");
    let tracer = kdray::Tracer::new(&mesh, &tree);
    let view = View::new(&camera, &options);
    let mut kinds = [0; 4];
    for (index, (ray, point)) in (0..).zip(rays.iter().zip(points)) {
        let (expected, _) = view.sample([index % options.width, index / options.width], 3);
        assert_eq!(ray.origin, expected.origin);
        let [found, expected] = [ray, &expected].map(|ray| Vec3::from(ray.direction));
        assert!(found.distance(expected) < 1e-6, "{index}: {found} {expected}");
        kinds[point.kind as usize] += 1;
        let hit = tracer.closest_hit(ray);
        check_point(&point, scene.point(ray, hit.as_ref()), hit.is_some(), scene.diagonal);
    }
    assert!(kinds[0] > 100 && kinds[1] > 100 && kinds[2] == 0 && kinds[3] > 100, "{kinds:?}");
}

fn check_point(found: &Point, expected: Option<crate::point::Point>, is_hit: bool, size: f32) {
    assert_eq!(found.kind, u32::from(expected.is_some()) + 2 * u32::from(is_hit), "{found:?}");
    let Some(expected) = expected else { return };
    let is_near = found.position.distance(expected.position) < 1e-6 * size
        && found.geometric.distance(expected.geometric) < 1e-5
        && found.shading.distance(expected.shading) < 1e-5
        && (found.haze - expected.haze).abs() < 1e-4
        && (found.error / expected.error - 1.0).abs() < 1e-5
        && found.albedo == expected.albedo;
    assert!(is_near, "{found:?} {expected:?}");
}

#[test]
fn samples_add_up_to_what_they_do_on_the_cpu() {
    const SAMPLES: u32 = 6;
    let (device, pixels) = (lavapipe(), 700);
    let mut random = Random::new(5);
    let mut vector = || Vec3::from([0, 1, 2].map(|_| random.unit() as f32));
    let path = |index: u32| {
        let normal = (vector() + 2.0 * Vec3::Z).normalize();
        Path {
            background: vector(),
            haze: if index.is_multiple_of(3) { vector().x } else { 0.0 },
            position: vector()
                * Vec3::new(1.0, 1.0, if index.is_multiple_of(5) { 3.0 } else { 0.1 }),
            has_surface: u32::from(index % 7 > 1),
            normal: if index.is_multiple_of(11) { Vec3::X } else { normal },
            rays: index % 9,
            albedo: vector(),
            hits: index % 4,
            light: 3.0 * vector(),
            ..Path::zeroed()
        }
    };
    let paths: Vec<Path> = (0..pixels * SAMPLES).map(path).collect();
    let film = device.buffer("film", 25 * u64::from(pixels)).expect("it fits");
    for first in [0, SAMPLES / 2] {
        // Half of each pixel's samples at a time.
        let half = paths.chunks(SAMPLES as usize).flat_map(|of_pixel| {
            of_pixel[first as usize..(first + SAMPLES / 2) as usize].iter().copied()
        });
        let half = device.upload("paths", &half.collect::<Vec<Path>>()).expect("it fits");
        let (bound, samples_here) = (pixels, SAMPLES / 2);
        let params =
            Params { bound, at: NONE, samples: SAMPLES, samples_here, ..Params::default() };
        run(&ACCUMULATE, &params, &[&half, &film]);
    }
    let cells: Vec<Cell> = device.read(&film).expect("it can be read");
    for (cell, paths) in cells.iter().zip(paths.chunks(SAMPLES as usize)) {
        let mut expected = Sums::default();
        paths.iter().for_each(|path| expected.add(&path.sample(), SAMPLES as f32));
        let [found, expected]: [[f32; 23]; 2] = [cell.sums, expected].map(bytemuck::cast);
        for (found, expected) in found.into_iter().zip(expected) {
            let error = (found - expected).abs();
            assert!(error <= 1e-5 * expected.abs().max(1.0), "{found} {expected}");
        }
        assert_eq!(cell.rays, paths.iter().map(|path| path.rays).sum::<u32>());
        assert_eq!(cell.hits, paths.iter().map(|path| path.hits).sum::<u32>());
    }
}

impl Path {
    fn sample(&self) -> Sample {
        if self.has_surface == 0 {
            return Sample { light: self.background, surface: None };
        }
        let light = (self.albedo * self.light).lerp(self.background, self.haze);
        let Self { position, normal, albedo, .. } = *self;
        Sample { light, surface: Some(Surface { position, normal, albedo }) }
    }
}
