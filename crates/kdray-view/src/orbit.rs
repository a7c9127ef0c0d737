//! A camera that goes around what it looks at.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec3;
use kdray_render::Camera;

/// How close to the poles the camera goes, in radians: there left and right would change places.
const POLE: f32 = 0.02;

/// A camera by its distance and angles around a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    target: Vec3,
    up: Vec3,
    distance: f32,
    /// Around `up`, in radians.
    azimuth: f32,
    /// Above the horizon, in radians.
    elevation: f32,
    fov: f32,
}

impl Orbit {
    /// The orbit that `camera` is on.
    #[must_use]
    pub fn new(camera: &Camera) -> Self {
        let up = Vec3::from(camera.up).try_normalize().unwrap_or(Vec3::Y);
        let target = Vec3::from(camera.target);
        let away = Vec3::from(camera.eye) - target;
        let [right, front] = horizon(up);
        let height = away.normalize_or(front).dot(up);
        Self {
            target,
            up,
            distance: away.length(),
            azimuth: away.dot(right).atan2(away.dot(front)),
            elevation: height.clamp(-1.0, 1.0).asin(),
            fov: camera.fov,
        }
    }

    #[must_use]
    /// The camera.
    pub fn camera(&self) -> Camera {
        Camera {
            eye: (self.target + self.distance * self.outward()).to_array(),
            target: self.target.to_array(),
            up: self.up.to_array(),
            fov: self.fov,
        }
    }

    /// Goes around by these angles, in radians: to the right, and up as far as the pole.
    pub fn turn(&mut self, right: f32, up: f32) {
        self.azimuth = (self.azimuth + right + PI).rem_euclid(2.0 * PI) - PI;
        let most = FRAC_PI_2 - POLE;
        self.elevation = (self.elevation + up).clamp(-most, most);
    }

    /// Goes so many times nearer.
    pub fn approach(&mut self, factor: f32) {
        if factor > 0.0 && (self.distance / factor).is_normal() {
            self.distance /= factor;
        }
    }

    /// Moves sideways and up, in heights of the picture at the target.
    pub fn shift(&mut self, right: f32, up: f32) {
        let height = 2.0 * self.distance * (0.5 * self.fov).to_radians().tan();
        let sideways = self.up.cross(self.outward()).normalize_or(Vec3::X);
        let upward = self.outward().cross(sideways);
        self.target += height * (right * sideways + up * upward);
    }

    /// From the target to the eye.
    fn outward(&self) -> Vec3 {
        let [right, front] = horizon(self.up);
        let level = self.azimuth.sin() * right + self.azimuth.cos() * front;
        self.elevation.cos() * level + self.elevation.sin() * self.up
    }
}

/// Two directions level with the ground, at right angles.
fn horizon(up: Vec3) -> [Vec3; 2] {
    let axis = if up.x.abs() < 0.9 { Vec3::X } else { Vec3::Y };
    let right = axis.reject_from_normalized(up).normalize();
    [right, right.cross(up)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Camera =
        Camera { eye: [3.0, 4.0, 5.0], target: [1.0, 1.0, 1.0], up: Camera::Y_UP, fov: 40.0 };

    fn assert_close(found: [f32; 3], expected: [f32; 3]) {
        assert!(Vec3::from(found).distance(expected.into()) < 1e-5, "{found:?} {expected:?}");
    }

    #[test]
    fn an_orbit_starts_at_its_camera() {
        for up in [Camera::Y_UP, Camera::Z_UP] {
            let camera = Orbit::new(&Camera { up, ..CAMERA }).camera();
            assert_close(camera.eye, CAMERA.eye);
            assert_eq!((camera.target, camera.fov, camera.up), (CAMERA.target, CAMERA.fov, up));
        }
    }

    #[test]
    fn a_full_turn_comes_back_and_poles_are_not_crossed() {
        let mut orbit = Orbit::new(&CAMERA);
        for _step in 0..8 {
            orbit.turn(PI / 4.0, 0.0);
        }
        assert_close(orbit.camera().eye, CAMERA.eye);
        orbit.turn(0.0, 99.0);
        let above = orbit.camera();
        assert!(above.eye[1] > 6.0 && above.eye != above.target);
        orbit.turn(0.0, -99.0);
        assert!(orbit.camera().eye[1] < -4.0);
    }

    #[test]
    fn distances_are_divided_and_never_end() {
        let mut orbit = Orbit::new(&CAMERA);
        orbit.approach(2.0);
        assert_close(orbit.camera().eye, [2.0, 2.5, 3.0]);
        for _step in 0..1000 {
            orbit.approach(10.0);
        }
        assert!(orbit.camera().eye.iter().all(|x| x.is_finite()));
        orbit.approach(f32::NAN);
        assert!(orbit.camera().eye.iter().all(|x| x.is_finite()));
    }

    #[test]
    fn a_shift_of_one_is_a_picture() {
        let from_front =
            Camera { eye: [0.0, 0.0, 2.0], target: [0.0; 3], up: Camera::Y_UP, fov: 90.0 };
        let mut orbit = Orbit::new(&from_front);
        orbit.shift(1.0, 0.5);
        assert_close(orbit.camera().target, [4.0, 2.0, 0.0]);
        assert_close(orbit.camera().eye, [4.0, 2.0, 2.0]);
    }
}
