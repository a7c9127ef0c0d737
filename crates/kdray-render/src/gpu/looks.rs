//! How a scene looks, in the memory of a device and in the parameters of kernels.

use glam::Vec3;
use kdray_gpu::device::Buffer;
use kdray_gpu::{Device, GpuError};

use super::kernels::Params;
use crate::camera::Lens;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::sky::Dome;
use crate::{Camera, RenderOptions};

/// What is known of each triangle besides its corners.
pub(super) struct Looks {
    /// Nine components of 16 bits a triangle, the normals of its corners.
    pub(super) normals: Buffer,
    /// The part that each triangle is of, unless there is one only, and then the colours of parts.
    pub(super) palette: Buffer,
}

/// Words of a buffer that nothing is in: kernels bind no empty ones.
const LEAST: u64 = 4;

impl Looks {
    /// Of a mesh without triangles.
    pub(super) fn of_nothing(device: &Device) -> Result<Self, GpuError> {
        let normals = device.buffer("corner normals", LEAST)?;
        Ok(Self { normals, palette: device.buffer("palette", LEAST)? })
    }

    /// Those of another scene, in the same memory if there is room.
    pub(super) fn replace(&mut self, device: &Device, scene: &Scene) -> Result<(), GpuError> {
        let normals = scene.corners.0.as_flattened().as_flattened();
        device.refill(&mut self.normals, "corner normals", normals)?;
        let colours = scene.palette.colours.iter().flat_map(Vec3::to_array).map(f32::to_bits);
        let palette: Vec<u32> = scene.palette.of_triangle.iter().copied().chain(colours).collect();
        device.refill(&mut self.palette, "palette", &palette)
    }
}

impl Params {
    /// What all kernels of a picture are told.
    pub(super) fn of(scene: &Scene, camera: &Camera, options: &RenderOptions) -> Self {
        let lens = Lens::new(camera, options.aspect());
        let dome = Dome::over(camera, options);
        let params = Self {
            width: options.width,
            height: options.height,
            samples: options.samples(),
            sample_bits: Sampler::sample_bits(options.samples()),
            bounces: options.bounces,
            eye: camera.eye,
            reach: options.reach * scene.diagonal,
            right: lens.right.to_array(),
            up: lens.up.to_array(),
            forward: lens.forward.to_array(),
            vertical: dome.up.to_array(),
            zenith: dome.sky.zenith,
            horizon: dome.sky.horizon,
            below: dome.sky.below,
            has_parts: u32::from(!scene.palette.of_triangle.is_empty()),
            colours: scene.palette.of_triangle.len() as u32,
            ground_colour: scene.palette.ground().to_array(),
            ..Self::default()
        };
        params.with_sun(&dome).with_ground(scene)
    }

    fn with_sun(self, dome: &Dome) -> Self {
        let Some((direction, cosine, strength)) = dome.sun else { return self };
        let (sun, strength) = (direction.to_array(), strength.to_array());
        Self { has_sun: 1, sun, sun_cos: cosine, strength, ..self }
    }

    fn with_ground(self, scene: &Scene) -> Self {
        let Some(ground) = &scene.ground else { return self };
        Self {
            has_ground: 1,
            ground_height: ground.height,
            ground_radius: ground.radius,
            ground_center: ground.center.to_array(),
            ..self
        }
    }
}
