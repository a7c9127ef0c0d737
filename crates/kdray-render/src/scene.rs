//! The mesh made ready to be looked at.

use glam::Vec3;
use kdray::{Hit, Mesh, Ray};

use crate::components::Components;
use crate::corners::{Corners, flat_normal};
use crate::ground::Ground;
use crate::palette::Palette;
use crate::point::{Point, rounding_error, smooth_position};
use crate::weld::weld;
use crate::{Camera, RenderOptions, Shading};

/// What rays can meet, and how it looks.
pub(crate) struct Scene<'a> {
    mesh: &'a Mesh,
    pub(crate) corners: Corners,
    pub(crate) palette: Palette,
    pub(crate) ground: Option<Ground>,
    /// Diagonal of the mesh's box.
    pub(crate) diagonal: f32,
}

impl<'a> Scene<'a> {
    pub(crate) fn new(mesh: &'a Mesh, camera: &Camera, options: &RenderOptions) -> Self {
        let up = camera.vertical();
        let is_lit = matches!(options.shading, Shading::Ao | Shading::Path);
        let diagonal = Vec3::from(mesh.bounds().extent()).length();
        let albedo = options.albedo.map_or(Vec3::ONE, Vec3::from);
        let (mut corners, mut palette) = (Corners::none(), Palette::uniform(albedo));
        if options.shading != Shading::Cost {
            let welded = weld(mesh);
            corners = Corners::new(mesh, &welded);
            if options.shading == Shading::Path && options.albedo.is_none() {
                palette = Palette::new(mesh, Components::new(mesh, &welded), up);
            }
        }
        let ground = if options.ground && is_lit { Ground::under(mesh, up) } else { None };
        Self { mesh, corners, palette, ground, diagonal }
    }

    /// Where a ray whose closest hit is known first meets a surface.
    pub(crate) fn point(&self, ray: &Ray, hit: Option<&Hit>) -> Option<Point> {
        let t_max = hit.map_or(ray.t_max, |hit| hit.t);
        let ground = self.ground_point(&Ray { t_max, ..*ray });
        ground.or_else(|| Some(self.mesh_point(ray, hit?)))
    }

    /// Where the ray meets the ground.
    pub(crate) fn ground_point(&self, ray: &Ray) -> Option<Point> {
        let ground = self.ground.as_ref()?;
        let position = ground.position(ray, ground.distance(ray)?);
        Some(Point {
            position,
            error: rounding_error(&[position; 3]),
            geometric: ground.normal(),
            shading: ground.normal(),
            albedo: self.palette.ground(),
            haze: ground.haze(position),
        })
    }

    /// Where the ray hits the mesh.
    fn mesh_point(&self, ray: &Ray, hit: &Hit) -> Point {
        let triangle = hit.triangle as usize;
        let direction = Vec3::from(ray.direction);
        let flat = flat_normal(self.mesh, triangle);
        let side = if flat.dot(direction) > 0.0 { -1.0 } else { 1.0 };
        let corners = self.mesh.triangle(triangle).map(Vec3::from);
        let normals = self.corners.normals(triangle).map(|normal| side * normal);
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let mean = |of: &[Vec3; 3]| weights[0] * of[0] + weights[1] * of[1] + weights[2] * of[2];
        let geometric = if flat == Vec3::ZERO { -direction.normalize() } else { side * flat };
        Point {
            position: smooth_position(mean(&corners), weights, &corners, &normals),
            error: rounding_error(&corners),
            geometric,
            shading: mean(&normals).try_normalize().unwrap_or(geometric),
            albedo: self.palette.of(triangle),
            haze: 0.0,
        }
    }
}
