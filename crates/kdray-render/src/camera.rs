//! The pinhole camera.

use glam::Vec3;
use kdray::{Aabb, Mesh, Ray};

/// A pinhole camera in the mesh's coordinates
/// ([`Frame::local_point`](kdray::Frame::local_point) makes them from world coordinates).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the pinhole is.
    pub eye: [f32; 3],
    /// What is in the middle of the picture.
    pub target: [f32; 3],
    /// Which way is up in the world: where the sky is and the ground is not.
    pub up: [f32; 3],
    /// Vertical field of view in degrees.
    pub fov: f32,
}

/// Room around what is framed, as a factor of its size on the picture.
const MARGIN: f32 = 1.12;

/// What is lower than this part of a mesh's height is its floor.
const FOOT: f32 = 0.02;

impl Camera {
    /// The y axis is up, as in most files.
    pub const Y_UP: [f32; 3] = [0.0, 1.0, 0.0];
    /// The z axis is up, as in maps and machine parts.
    pub const Z_UP: [f32; 3] = [0.0, 0.0, 1.0];
    /// Vertical field of view of [`Camera::framing`] in degrees.
    pub const FOV: f32 = 35.0;

    /// A view from the front right and above, from where all of `bounds` is just in a picture that
    /// is `aspect` times as wide as high.
    #[must_use]
    pub fn framing(bounds: &Aabb, up: [f32; 3], aspect: f32) -> Self {
        Self::framing_points(&corners(bounds), up, aspect)
    }

    /// [`Camera::framing`], but closer: what must be in view are the triangles themselves, without
    /// those that only make the floor.
    #[must_use]
    pub fn framing_mesh(mesh: &Mesh, up: [f32; 3], aspect: f32) -> Self {
        let upward = vertical(up);
        let heights = corners(&mesh.bounds()).map(|corner| corner.dot(upward));
        let [low, high] = heights
            .iter()
            .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], y| [y.min(low), y.max(high)]);
        let foot = low + FOOT * (high - low);
        let corners = (0..mesh.triangles().len()).map(|index| mesh.triangle(index).map(Vec3::from));
        let stands = |triangle: &[Vec3; 3]| triangle.iter().any(|corner| corner.dot(upward) > foot);
        let points: Vec<Vec3> = corners.filter(stands).flatten().collect();
        if points.is_empty() {
            return Self::framing(&mesh.bounds(), up, aspect);
        }
        Self::framing_points(&points, up, aspect)
    }

    /// The view in which the points reach from edge to edge.
    fn framing_points(points: &[Vec3], up: [f32; 3], aspect: f32) -> Self {
        let upward = vertical(up);
        let right = rightward(upward);
        let toward_eye = 0.65 * right + 0.45 * upward + 1.2 * right.cross(upward);
        let camera = Self { eye: toward_eye.to_array(), target: [0.0; 3], up, fov: Self::FOV };
        let lens = Lens::new(&camera, aspect);
        let eye = lens.place_for(points);
        let depths = points.iter().map(|point| (*point - eye).dot(lens.forward));
        let middle = depths.sum::<f32>() / points.len() as f32;
        Self { eye: eye.to_array(), target: (eye + middle * lens.forward).to_array(), ..camera }
    }

    /// The ray through a point of the picture, both coordinates in -1..=1, to the right and up.
    /// Its direction has unit length.
    #[must_use]
    pub fn ray(&self, x: f32, y: f32, aspect: f32) -> Ray {
        let lens = Lens::new(self, aspect);
        Ray::new(self.eye, lens.direction(x, y).to_array())
    }

    /// Where a point is on the picture, both coordinates in -1..=1 if it is in view, and its distance
    /// along the way the camera looks; `None` if it is not in front of the camera.
    #[must_use]
    pub fn project(&self, point: [f32; 3], aspect: f32) -> Option<([f32; 2], f32)> {
        let lens = Lens::new(self, aspect);
        let offset = Vec3::from(point) - Vec3::from(self.eye);
        let depth = offset.dot(lens.forward);
        let place = |axis: Vec3| offset.dot(axis) / axis.length_squared() / depth;
        (depth > 0.0).then(|| ([lens.right, lens.up].map(place), depth))
    }

    /// Up, of unit length.
    pub(crate) fn vertical(&self) -> Vec3 {
        vertical(self.up)
    }
}

/// The axes of a camera, those across scaled to the edges of the picture.
pub(crate) struct Lens {
    pub(crate) right: Vec3,
    pub(crate) up: Vec3,
    pub(crate) forward: Vec3,
}

impl Lens {
    pub(crate) fn new(camera: &Camera, aspect: f32) -> Self {
        let eye = Vec3::from(camera.eye);
        let forward = (Vec3::from(camera.target) - eye).try_normalize().unwrap_or(Vec3::NEG_Z);
        let sideways = forward.cross(camera.vertical()).try_normalize();
        let right = sideways.unwrap_or_else(|| forward.any_orthonormal_vector());
        let half = (0.5 * camera.fov.clamp(1.0, 170.0)).to_radians().tan();
        Self { right: half * aspect * right, up: half * right.cross(forward), forward }
    }

    pub(crate) fn direction(&self, x: f32, y: f32) -> Vec3 {
        (self.forward + x * self.right + y * self.up).normalize()
    }

    /// The place nearest to some points from which all are in view.
    ///
    /// A point is left of the right edge if `x - slope z`, in the axes of the camera, is no greater
    /// than that of the eye. So the eye is where the tightest such plane meets its counterpart.
    fn place_for(&self, points: &[Vec3]) -> Vec3 {
        let z = |point: Vec3| point.dot(self.forward);
        let most =
            |of: &dyn Fn(Vec3) -> f32| points.iter().map(|p| of(*p)).fold(f32::MIN, f32::max);
        let nearest = -most(&|point| -z(point));
        let size = points.iter().map(|point| point.distance(points[0])).fold(0.0, f32::max);
        let mut depth = nearest - if size > 0.0 { 0.05 * size } else { 1.0 };
        let mut across = Vec3::ZERO;
        for axis in [self.right, self.up] {
            let (unit, slope) = (axis.normalize(), axis.length() / MARGIN);
            let right = most(&|point| point.dot(unit) - slope * z(point));
            let left = most(&|point| -point.dot(unit) - slope * z(point));
            depth = depth.min(-0.5 * (right + left) / slope);
            across += 0.5 * (right - left) * unit;
        }
        across + depth * self.forward
    }
}

/// The x axis as seen by someone who stands upright, or y where x is up.
fn rightward(vertical: Vec3) -> Vec3 {
    let axis = if vertical.x.abs() < 0.9 { Vec3::X } else { Vec3::Y };
    axis.reject_from_normalized(vertical).normalize()
}

/// Up, of unit length.
fn vertical(up: [f32; 3]) -> Vec3 {
    Vec3::from(up).try_normalize().unwrap_or(Vec3::Y)
}

fn corners(bounds: &Aabb) -> [Vec3; 8] {
    let ends = [bounds.lower, bounds.upper];
    [0, 1, 2, 3, 4, 5, 6, 7]
        .map(|corner: usize| Vec3::from([0, 1, 2].map(|axis| ends[corner >> axis & 1][axis])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a point is on the picture of a square camera.
    fn projected(camera: &Camera, point: Vec3) -> [f32; 2] {
        camera.project(point.to_array(), 1.5).expect("before the eye").0
    }

    #[test]
    fn all_corners_of_a_framed_box_are_in_the_picture_and_fill_it() {
        let boxes = [[1.0, 1.0, 1.0], [1e-4, 2e-4, 30.0], [9e5, 2.0, 3.0], [1.0, 0.0, 0.0]];
        for (upper, up) in boxes.into_iter().flat_map(|b| [(b, Camera::Y_UP), (b, Camera::Z_UP)]) {
            let bounds = Aabb { lower: upper.map(|x: f32| -0.5 * x), upper };
            let camera = Camera::framing(&bounds, up, 1.5);
            let seen = corners(&bounds).map(|corner| projected(&camera, corner));
            for axis in 0..2 {
                let reach = |sign: f32| seen.iter().map(|p| sign * p[axis]).fold(-1.0, f32::max);
                assert!(reach(1.0) <= 1.0 && reach(-1.0) <= 1.0, "{upper:?} {up:?}: {seen:?}");
            }
            let widest = seen.as_flattened().iter().fold(0.0_f32, |most, x| most.max(x.abs()));
            assert!(widest > 0.85, "{upper:?} {up:?}: {widest}");
        }
    }

    #[test]
    fn a_wide_floor_does_not_make_a_mesh_small() {
        let floor = [[-99.0, 0.0, -99.0], [99.0, 0.0, -99.0], [0.0, 0.0, 99.0]];
        let thing = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let positions = [floor, thing].concat();
        let both = Mesh::new(&positions, &[[0, 1, 2], [3, 4, 5]]).expect("finite");
        let one = Mesh::new(&positions, &[[3, 4, 5]]).expect("finite");
        let frame = |mesh| Camera::framing_mesh(mesh, Camera::Y_UP, 1.5);
        assert_eq!(frame(&both), frame(&one));
        let flat = Mesh::new(&positions, &[[0, 1, 2]]).expect("finite");
        assert_eq!(frame(&flat), Camera::framing(&flat.bounds(), Camera::Y_UP, 1.5));
    }

    #[test]
    fn a_point_can_be_framed() {
        let bounds = Aabb { lower: [3.0; 3], upper: [3.0; 3] };
        let camera = Camera::framing(&bounds, Camera::Y_UP, 1.0);
        assert!(camera.eye != camera.target && camera.eye.iter().all(|x| x.is_finite()));
    }

    #[test]
    fn rays_run_through_what_is_seen_there() {
        let bounds = Aabb { lower: [0.0; 3], upper: [1.0, 2.0, 3.0] };
        let camera = Camera::framing(&bounds, Camera::Y_UP, 1.5);
        for corner in corners(&bounds) {
            let [x, y] = projected(&camera, corner);
            let ray = camera.ray(x, y, 1.5);
            let toward = (corner - Vec3::from(camera.eye)).normalize();
            assert!(Vec3::from(ray.direction).distance(toward) < 1e-5);
        }
        assert_eq!(camera.project(camera.eye, 1.5), None);
        let behind = [0, 1, 2].map(|axis| 2.0 * camera.eye[axis] - camera.target[axis]);
        assert_eq!(camera.project(behind, 1.5), None);
        assert!(camera.ray(0.0, 1.0, 1.5).direction[1] > camera.ray(0.0, -1.0, 1.5).direction[1]);
    }
}
