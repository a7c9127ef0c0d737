//! Pictures of the scenes.

use std::sync::atomic::AtomicBool;

use kdray::{Mesh, Tracer, Tree};
use kdray_render::{Camera, RenderOptions, Shading};

use super::scenes::View;
use crate::progress::Progress;

/// Pixels along a side.
const SIDE: u32 = 480;

/// The angle of view inside of buildings, in degrees.
const WIDE: f32 = 75.0;

/// A camera that looks at the mesh as `view` says; from inside, along the longer side.
pub(super) fn camera(mesh: &Mesh, view: View, up: [f32; 3]) -> Camera {
    match view {
        View::Outside { nearness } => {
            let whole = Camera::framing_mesh(mesh, up, 1.0);
            let nearer = |axis: usize| {
                whole.target[axis] + (whole.eye[axis] - whole.target[axis]) / nearness
            };
            Camera { eye: [0, 1, 2].map(nearer), ..whole }
        }
        View::Inside => {
            let bounds = mesh.bounds();
            let [dx, _, dz] = bounds.extent();
            let [x, y, z] = [0, 1, 2].map(|axis| 0.5 * (bounds.lower[axis] + bounds.upper[axis]));
            let target =
                if dx >= dz { [x + dx, y, z + 0.3 * dx] } else { [x + 0.3 * dz, y, z + dz] };
            Camera { eye: [x, y, z], target, up, fov: WIDE }
        }
    }
}

/// A PNG file of the mesh.
pub(super) fn png(
    mesh: &Mesh,
    tree: &Tree,
    camera: &Camera,
    view: View,
    progress: &Progress,
    cancel: &AtomicBool,
) -> anyhow::Result<Vec<u8>> {
    let is_interior = view == View::Inside;
    let show = |fraction: f32| progress.set(0.5 + 0.5 * fraction);
    let options = RenderOptions {
        width: SIDE,
        height: SIDE,
        // No sun shines into a closed room.
        shading: if is_interior { Shading::Ao } else { Shading::Path },
        ground: !is_interior,
        progress: Some(&show),
        cancel: Some(cancel),
        ..RenderOptions::default()
    };
    Ok(kdray_render::render(&Tracer::new(mesh, tree), mesh, camera, &options)?.to_png()?)
}
