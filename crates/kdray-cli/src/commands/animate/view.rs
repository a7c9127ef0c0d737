//! One camera for all frames.

use anyhow::Context;
use kdray::Mesh;
use kdray_mesh::Sequence;
use kdray_render::Camera;

use super::Arguments;
use crate::commands::render::View;

/// Where all frames have their place.
pub(super) struct Stage<'a> {
    view: &'a View,
    /// The corners of a box around all frames, as a mesh.
    room: Mesh,
    aspect: f32,
}

impl<'a> Stage<'a> {
    /// Reads all frames once.
    pub(super) fn of(sequence: &Sequence, arguments: &'a Arguments) -> anyhow::Result<Self> {
        let mut ends = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for index in 0..sequence.frames() {
            let mesh = mesh(sequence, index)?;
            let bounds = mesh.bounds();
            let [lower, upper] = [bounds.lower, bounds.upper].map(|p| mesh.frame().world_point(p));
            for axis in 0..3 {
                ends[0][axis] = ends[0][axis].min(lower[axis]);
                ends[1][axis] = ends[1][axis].max(upper[axis]);
            }
        }
        let corner = |corner: usize| [0, 1, 2].map(|axis| ends[corner >> axis & 1][axis]);
        let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
        let room = Mesh::from_f64(&corners, &[[0, 3, 5], [2, 4, 7], [1, 6, 0]])?;
        let aspect = arguments.size.width as f32 / arguments.size.height as f32;
        Ok(Self { view: &arguments.view, room, aspect })
    }

    /// The camera in the coordinates of a frame's mesh.
    pub(super) fn camera(&self, mesh: &Mesh) -> Camera {
        let camera = self
            .view
            .camera_over(&self.room, |up| Camera::framing(&self.room.bounds(), up, self.aspect));
        let moved = |point| mesh.frame().local_point(self.room.frame().world_point(point));
        Camera { eye: moved(camera.eye), target: moved(camera.target), ..camera }
    }
}

/// The mesh of a frame.
pub(super) fn mesh(sequence: &Sequence, index: usize) -> anyhow::Result<Mesh> {
    sequence.frame(index)?.mesh().with_context(|| format!("frame {index}"))
}
