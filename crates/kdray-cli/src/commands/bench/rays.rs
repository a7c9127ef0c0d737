//! Three kinds of rays over any mesh.

use std::f64::consts::TAU;

use glam::DVec3;
use kdray::{Hit, Mesh, Ray};
use kdray_render::Camera;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng as _;

/// Pixels along a side of the square picture; rays run in tiles of 4 x 4.
const SIDE: u32 = 512;

/// The lift of secondary rays off their surface, in diagonals.
const LIFT: f64 = 1e-5;

/// A point on the surface and its normal toward the viewer.
pub(super) struct Start {
    position: DVec3,
    normal: DVec3,
}

/// Camera rays that have all of the mesh in view.
pub(super) fn primary(mesh: &Mesh) -> Vec<Ray> {
    through(&Camera::framing(&mesh.bounds(), Camera::Y_UP, 1.0), SIDE)
}

/// Camera rays through a square picture with `side` pixels along a side, a multiple of 4.
pub(super) fn through(camera: &Camera, side: u32) -> Vec<Ray> {
    let ray = |index: u32| {
        let (tile, pixel) = (index / 16, index % 16);
        let x = tile % (side / 4) * 4 + pixel % 4;
        let y = tile / (side / 4) * 4 + pixel / 4;
        let place = |pixel: u32| 2.0 * (pixel as f32 + 0.5) / side as f32 - 1.0;
        camera.ray(place(x), -place(y), 1.0)
    };
    (0..side * side).map(ray).collect()
}

/// Where the rays hit, lifted a little.
pub(super) fn starts(mesh: &Mesh, rays: &[Ray], hits: &[Option<Hit>]) -> Vec<Start> {
    let lift = LIFT * point(mesh.bounds().extent()).length();
    let start = |(ray, hit): (&Ray, &Option<Hit>)| {
        let [a, b, c] = mesh.triangle((*hit)?.triangle as usize).map(point);
        let normal = (b - a).cross(c - a).try_normalize()?;
        let normal = if normal.dot(point(ray.direction)) > 0.0 { -normal } else { normal };
        Some(Start { position: point(ray.at((*hit)?.t)) + lift * normal, normal })
    };
    rays.iter().zip(hits).filter_map(start).collect()
}

/// Cosine-weighted reflections.
pub(super) fn bounce(starts: &[Start]) -> Vec<Ray> {
    let mut random = Pcg32::new(2011, 1);
    let reflect = |start: &Start| {
        let [u, v] = [(); 2].map(|()| uniform(&mut random));
        let (tangent, bitangent) = start.normal.any_orthonormal_pair();
        let (sin, cos) = (TAU * v).sin_cos();
        let across = u.sqrt() * (cos * tangent + sin * bitangent);
        ray(start.position, (across + (1.0 - u).sqrt() * start.normal).normalize())
    };
    starts.iter().map(reflect).collect()
}

/// Rays to points of a cube of light above the mesh.
pub(super) fn shadow(mesh: &Mesh, starts: &[Start]) -> Vec<Ray> {
    let mut random = Pcg32::new(2011, 2);
    let bounds = mesh.bounds();
    let diagonal = point(bounds.extent()).length();
    let corner =
        0.5 * (point(bounds.lower) + point(bounds.upper)) + diagonal * DVec3::new(-0.1, 0.9, -0.1);
    let aim = |start: &Start| {
        let light = corner + 0.2 * diagonal * DVec3::from([(); 3].map(|()| uniform(&mut random)));
        let way = light - start.position;
        let t_max = (0.999 * way.length()) as f32;
        Ray { t_max, ..ray(start.position, way.normalize_or(DVec3::Y)) }
    };
    starts.iter().map(aim).collect()
}

/// Uniform in 0..1.
fn uniform(random: &mut Pcg32) -> f64 {
    f64::from(random.next_u32()) / 4_294_967_296.0
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray::new(origin.as_vec3().to_array(), direction.as_vec3().to_array())
}

fn point(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn secondary_rays_leave_on_the_viewers_side() {
        let positions = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
        let mesh = Mesh::new(&positions, &[[0, 1, 2]]).expect("finite");
        let rays = primary(&mesh);
        let hit = |t| Some(Hit { t, triangle: 0, u: 0.2, v: 0.2 });
        let hits: Vec<_> = rays.iter().map(|ray| hit(-ray.origin[1] / ray.direction[1])).collect();
        let starts = starts(&mesh, &rays, &hits);
        assert_eq!(starts.len(), (SIDE * SIDE) as usize);
        let above = |ray: &Ray| ray.origin[1] > 0.0 && ray.direction[1] >= 0.0;
        assert!(bounce(&starts).iter().all(above) && shadow(&mesh, &starts).iter().all(above));
    }
}
