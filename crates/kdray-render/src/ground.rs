//! What the mesh stands on.

use glam::Vec3;
use kdray::{Mesh, Ray};

/// An endless horizontal plane, seen from above only.
pub(crate) struct Ground {
    pub(crate) up: Vec3,
    pub(crate) height: f32,
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
}

/// How far the ground lies below the mesh's own floor, in radii: the floor covers it.
const GAP: f32 = 2e-5;

/// What is lower than this part of a mesh's height can be its floor.
const FOOT: f32 = 0.03;

/// A level triangle of a floor has at least this area, in squares of the radius.
const FLOOR_AREA: f32 = 0.005;

impl Ground {
    /// The ground at the foot of `mesh`, or `None` if the mesh has no extent.
    pub(crate) fn under(mesh: &Mesh, up: Vec3) -> Option<Self> {
        let bounds = mesh.bounds();
        let (lower, upper) = (Vec3::from(bounds.lower), Vec3::from(bounds.upper));
        let center = 0.5 * (lower + upper);
        let radius = 0.5 * (upper - lower).length();
        let reach = 0.5 * (upper - lower).dot(up.abs());
        let foot = center.dot(up) - reach;
        let floor = floor_height(mesh, up, foot + FOOT * 2.0 * reach, FLOOR_AREA * radius * radius);
        let height = floor.unwrap_or(foot) - GAP * radius;
        (radius > 0.0).then_some(Self { up, height, center, radius })
    }

    /// Where the ray comes down on the ground.
    pub(crate) fn distance(&self, ray: &Ray) -> Option<f32> {
        let descent = -Vec3::from(ray.direction).dot(self.up);
        let above = Vec3::from(ray.origin).dot(self.up) - self.height;
        let t = above / descent;
        (descent > 0.0 && above >= 0.0 && t <= ray.t_max).then_some(t)
    }

    /// The point on the ground along the ray.
    pub(crate) fn position(&self, ray: &Ray, t: f32) -> Vec3 {
        let point = Vec3::from(ray.at(t));
        point + (self.height - point.dot(self.up)) * self.up
    }

    /// Up.
    pub(crate) fn normal(&self) -> Vec3 {
        self.up
    }

    /// How far a point has faded into the distance: 0 near the mesh, 1 at the horizon.
    pub(crate) fn haze(&self, point: Vec3) -> f32 {
        let away = (point - self.center).reject_from_normalized(self.up).length() / self.radius;
        let x = ((away - 1.5) / 8.5).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }
}

/// The height of the largest level triangle below `limit`, if it is large enough. Things may stick
/// into the floor they stand on.
fn floor_height(mesh: &Mesh, up: Vec3, limit: f32, least_area: f32) -> Option<f32> {
    let level = |triangle: usize| {
        let [a, b, c] = mesh.triangle(triangle).map(Vec3::from);
        let [low, mid, high] = [a, b, c].map(|corner| corner.dot(up));
        let normal = 0.5 * (b - a).cross(c - a);
        let area = normal.length();
        let is_floor = low.max(mid).max(high) <= limit && normal.dot(up).abs() > 0.9999 * area;
        (is_floor && area >= least_area).then_some((area, low.min(mid).min(high)))
    };
    let floors = (0..mesh.triangles().len()).filter_map(level);
    floors.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, height)| height)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ground() -> Ground {
        let corners = [[0.0, 1.0, 0.0], [9.0, 1.0, 0.0], [3.0, 5.0, 3.0]];
        let mesh = Mesh::new(&corners, &[[0, 1, 2]]).expect("finite");
        Ground::under(&mesh, Vec3::Y).expect("it has an extent")
    }

    #[test]
    fn the_ground_is_a_hair_below_the_mesh() {
        let ray = Ray::new([2.0, 4.0, 2.0], [0.0, -1.5, 0.0]);
        let t = ground().distance(&ray).expect("it is below");
        assert!((2.0..2.001).contains(&t), "{t}");
        assert!((ground().position(&ray, t).y - ray.at(t)[1]).abs() < 1e-6);
    }

    #[test]
    fn a_floor_is_level_with_the_ground_whatever_sticks_into_it() {
        let floor = [[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [0.0, 0.0, 9.0]];
        let post = [[0.0, -0.1, 0.0], [0.1, -0.1, 0.0], [0.0, 5.0, 0.0]];
        let positions = [floor, post].concat();
        let mesh = Mesh::new(&positions, &[[0, 1, 2], [3, 4, 5]]).expect("finite");
        let ground = Ground::under(&mesh, Vec3::Y).expect("it has an extent");
        assert!(ground.height < 0.0 && ground.height > -0.001, "{}", ground.height);
    }

    #[test]
    fn it_is_seen_from_above_only() {
        let upward = Ray::new([2.0, 4.0, 2.0], [0.0, 1.0, 0.0]);
        let below = Ray::new([2.0, 0.5, 2.0], [0.0, -1.0, 0.0]);
        assert_eq!([upward, below].map(|ray| ground().distance(&ray)), [None, None]);
    }

    #[test]
    fn it_fades_far_away() {
        assert_eq!(ground().haze(Vec3::new(3.0, 1.0, 3.0)), 0.0);
        assert_eq!(ground().haze(Vec3::new(3000.0, 1.0, 3.0)), 1.0);
    }
}
