//! The ray sets: the same rays for every engine and on every machine.
//!
//! All arithmetic is in double and the results are stored as f32. `c` and `diag` are the centre
//! and the diagonal of the box of all triangles; +y is up; directions have unit length.
//!
//! | set | origin and direction |
//! |---|---|
//! | `primary` | eye `c + 1.5 diag normalize(1, 0.6, 1.2)`, looking at `c`, vertical field of view 45 degrees |
//! | `in_primary` | eye `c`, along `(1, 0, 0.3)`, or `(0.3, 0, 1)` where the box is longer in z; 75 degrees |
//! | `bounce` | from each primary hit: `hit + 1e-5 diag n`, cosine-weighted around the normal `n` on the viewer's side |
//! | `shadow` | from the same points to a uniform point of a box light, `t_max` 0.999 of the distance |
//! | `in_bounce` | as `bounce`, from the hits of `in_primary` |
//! | `chord` | between two uniform points of the bounding sphere (centre `c`, radius `diag / 2`), unbounded |
//!
//! Camera images are square and run in tiles of 4 x 4 pixels, row by row, rays through pixel
//! centres; there are as many chords as pixels. The light is a cube of side `0.2 diag` whose
//! centre is `diag` above `c`. Random numbers are PCG32, seed [`SEED`], one stream a set.

use std::f64::consts::TAU;

use glam::DVec3;
use kdray::{Mesh, Ray};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng as _;

use crate::definition::RaySet;
use crate::engine::Hit;

/// Side of the tiles of camera images in pixels.
pub(crate) const TILE: u32 = 4;

/// Seed of every random stream.
const SEED: u64 = 2011;

/// The lift of secondary origins off their surface, in diagonals.
const LIFT: f64 = 1e-5;

/// Makes ray sets over a mesh. `closest` answers the camera rays that others start from.
pub(crate) struct RayMaker<'a> {
    mesh: &'a Mesh,
    resolution: u32,
    closest: &'a dyn Fn(&[Ray]) -> Vec<Hit>,
    centre: DVec3,
    extent: DVec3,
    diagonal: f64,
}

impl<'a> RayMaker<'a> {
    /// For images of `resolution` x `resolution` pixels, a multiple of [`TILE`].
    pub(crate) fn new(
        mesh: &'a Mesh,
        resolution: u32,
        closest: &'a dyn Fn(&[Ray]) -> Vec<Hit>,
    ) -> Self {
        let bounds = mesh.bounds();
        let (lower, upper) = (point(bounds.lower), point(bounds.upper));
        let extent = upper - lower;
        let (centre, diagonal) = (0.5 * (lower + upper), extent.length());
        Self { mesh, resolution, closest, centre, extent, diagonal }
    }

    /// The rays of a set.
    pub(crate) fn rays(&self, set: RaySet) -> Vec<Ray> {
        match set {
            RaySet::Primary => self.primary(),
            RaySet::InPrimary => self.inside(),
            RaySet::Bounce => self.bounce(&self.primary(), 1),
            RaySet::Shadow => self.shadow(&self.primary(), 2),
            RaySet::InBounce => self.bounce(&self.inside(), 3),
            RaySet::Chord => self.chords(4),
        }
    }

    fn primary(&self) -> Vec<Ray> {
        let offset = DVec3::new(1.0, 0.6, 1.2).normalize();
        camera(self.centre + 1.5 * self.diagonal * offset, -offset, 45.0, self.resolution)
    }

    fn inside(&self) -> Vec<Ray> {
        let along_x = self.extent.x >= self.extent.z;
        let forward = if along_x { DVec3::new(1.0, 0.0, 0.3) } else { DVec3::new(0.3, 0.0, 1.0) };
        camera(self.centre, forward.normalize(), 75.0, self.resolution)
    }

    fn bounce(&self, camera: &[Ray], stream: u64) -> Vec<Ray> {
        let mut random = Pcg32::new(SEED, stream);
        let scatter = |(origin, normal)| {
            ray(origin, cosine_weighted(normal, uniform(&mut random), uniform(&mut random)))
        };
        self.surface(camera).into_iter().map(scatter).collect()
    }

    fn shadow(&self, camera: &[Ray], stream: u64) -> Vec<Ray> {
        let mut random = Pcg32::new(SEED, stream);
        let corner = self.centre + self.diagonal * DVec3::new(-0.1, 0.9, -0.1);
        let aim = |(origin, _): (DVec3, DVec3)| {
            let [x, y, z] = std::array::from_fn(|_| uniform(&mut random));
            let way = corner + 0.2 * self.diagonal * DVec3::new(x, y, z) - origin;
            let t_max = (0.999 * way.length()) as f32;
            Ray { t_max, ..ray(origin, way.normalize()) }
        };
        self.surface(camera).into_iter().map(aim).collect()
    }

    fn chords(&self, stream: u64) -> Vec<Ray> {
        let mut random = Pcg32::new(SEED, stream);
        let mut on_sphere = || {
            let direction = uniform_direction(uniform(&mut random), uniform(&mut random));
            self.centre + 0.5 * self.diagonal * direction
        };
        let mut chord = || {
            let (from, to) = (on_sphere(), on_sphere());
            ray(from, (to - from).normalize_or(DVec3::Y))
        };
        (0..self.resolution * self.resolution).map(|_| chord()).collect()
    }

    /// Lifted hit points of camera rays, with the normal on the viewer's side.
    fn surface(&self, camera: &[Ray]) -> Vec<(DVec3, DVec3)> {
        let hits = (self.closest)(camera);
        let lifted = |(ray, hit): (&Ray, &Hit)| {
            let normal = self.normal(*hit, point(ray.direction))?;
            let position = point(ray.origin) + f64::from(hit.t) * point(ray.direction);
            Some((position + LIFT * self.diagonal * normal, normal))
        };
        camera.iter().zip(&hits).filter_map(lifted).collect()
    }

    /// None for a miss, and for a triangle without an area.
    fn normal(&self, hit: Hit, direction: DVec3) -> Option<DVec3> {
        let [a, b, c] = hit.is_hit().then(|| self.mesh.triangle(hit.triangle as usize))?.map(point);
        let normal = (b - a).cross(c - a).try_normalize()?;
        Some(if normal.dot(direction) > 0.0 { -normal } else { normal })
    }
}

/// Rays of a square pinhole image in tiles. `forward` has unit length and is not vertical.
fn camera(eye: DVec3, forward: DVec3, degrees: f64, resolution: u32) -> Vec<Ray> {
    let half = (0.5 * degrees.to_radians()).tan();
    let right = half * forward.cross(DVec3::Y).normalize();
    let up = half * right.cross(forward).normalize();
    let centre = |pixel: u32| 2.0 * (f64::from(pixel) + 0.5) / f64::from(resolution) - 1.0;
    tiled(resolution)
        .map(|[x, y]| ray(eye, (forward + centre(x) * right - centre(y) * up).normalize()))
        .collect()
}

/// Pixels of a square image, tile by tile, each tile row by row.
fn tiled(resolution: u32) -> impl Iterator<Item = [u32; 2]> {
    let (tiles, area) = (resolution / TILE, TILE * TILE);
    (0..resolution * resolution).map(move |index| {
        let (tile, pixel) = (index / area, index % area);
        [tile % tiles * TILE + pixel % TILE, tile / tiles * TILE + pixel / TILE]
    })
}

/// A direction around `normal` with density proportional to the cosine.
fn cosine_weighted(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let (sin, cos) = (TAU * v).sin_cos();
    let direction = u.sqrt() * (cos * tangent + sin * bitangent) + (1.0 - u).sqrt() * normal;
    direction.normalize()
}

fn uniform_direction(u: f64, v: f64) -> DVec3 {
    let z = 1.0 - 2.0 * u;
    let (sin, cos) = (TAU * v).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

/// Uniform in 0..1, in steps of 2^-32.
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

    const ALL: [RaySet; 6] = [
        RaySet::Primary,
        RaySet::InPrimary,
        RaySet::Bounce,
        RaySet::Shadow,
        RaySet::InBounce,
        RaySet::Chord,
    ];

    /// A square in the plane y = 0, seen from above by `primary`.
    fn square() -> Mesh {
        let positions = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
        Mesh::new(&positions, &[[0, 1, 2], [0, 2, 3]]).expect("valid")
    }

    /// Hits of the square's plane, whatever the square's extent.
    fn plane_hits(rays: &[Ray]) -> Vec<Hit> {
        let hit = |ray: &Ray| match -ray.origin[1] / ray.direction[1] {
            t if t > 0.0 && t.is_finite() => Hit { t, triangle: 0 },
            _ => Hit::MISS,
        };
        rays.iter().map(hit).collect()
    }

    fn make(set: RaySet) -> Vec<Ray> {
        RayMaker::new(&square(), 32, &plane_hits).rays(set)
    }

    #[test]
    fn counts_follow_the_image_and_its_hits() {
        let hits = plane_hits(&make(RaySet::Primary)).iter().filter(|hit| hit.is_hit()).count();
        assert!(hits > 0);
        for set in [RaySet::Primary, RaySet::InPrimary, RaySet::Chord] {
            assert_eq!(make(set).len(), 32 * 32);
        }
        for set in [RaySet::Bounce, RaySet::Shadow] {
            assert_eq!(make(set).len(), hits);
        }
    }

    #[test]
    fn directions_have_unit_length() {
        for ray in ALL.into_iter().flat_map(make) {
            assert!((point(ray.direction).length() - 1.0).abs() < 1e-6, "{ray:?}");
        }
    }

    #[test]
    fn sets_are_the_same_every_time_and_differ_from_each_other() {
        for set in ALL {
            assert_eq!(make(set), make(set));
        }
        assert_ne!(make(RaySet::Bounce), make(RaySet::Shadow));
    }

    #[test]
    fn tiles_cover_every_pixel_once_in_blocks() {
        let pixels: Vec<_> = tiled(8).collect();
        assert_eq!(pixels[..5], [[0, 0], [1, 0], [2, 0], [3, 0], [0, 1]]);
        assert_eq!(pixels[16], [4, 0]);
        let mut sorted = pixels.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), 64);
    }

    #[test]
    fn the_camera_looks_down_the_middle_and_up_is_up() {
        let rays = camera(DVec3::ZERO, DVec3::X, 90.0, 4);
        let sum: DVec3 = rays.iter().map(|ray| point(ray.direction)).sum();
        assert!(sum.normalize().distance(DVec3::X) < 1e-6);
        let (first, last) = (rays[0].direction, rays[15].direction);
        assert!(first[1] > 0.0 && last[1] < 0.0, "rows run from top to bottom");
        assert!(
            (f64::from(first[1] / first[0]) - 0.75).abs() < 1e-6,
            "pixel centres at 45 degrees"
        );
    }

    #[test]
    fn bounces_leave_on_the_viewers_side_with_a_cosine() {
        let rays = make(RaySet::Bounce);
        assert!(rays.iter().all(|ray| ray.direction[1] >= 0.0 && ray.origin[1] > 0.0));
        let mean =
            rays.iter().map(|ray| f64::from(ray.direction[1])).sum::<f64>() / rays.len() as f64;
        assert!((mean - 2.0 / 3.0).abs() < 0.05, "the mean cosine is 2/3, got {mean}");
    }

    #[test]
    fn shadow_rays_end_before_the_light() {
        let diagonal = 8_f64.sqrt();
        for ray in make(RaySet::Shadow) {
            let end = f64::from(ray.origin[1]) + f64::from(ray.t_max) * f64::from(ray.direction[1]);
            assert!((0.89 * diagonal..1.1 * diagonal).contains(&end), "{ray:?}");
        }
    }

    #[test]
    fn chords_start_on_the_sphere_and_point_inwards() {
        for ray in make(RaySet::Chord) {
            let origin = point(ray.origin);
            assert!((origin.length() - 2_f64.sqrt()).abs() < 1e-6);
            assert!(origin.dot(point(ray.direction)) <= 1e-6);
        }
    }
}
