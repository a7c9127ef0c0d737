//! The kernels of pictures, and what they are told.

use bytemuck::{Pod, Zeroable};
use kdray_gpu::record::Binding::{Read, Uniform, Write};
use kdray_gpu::record::Kernel;

/// A kernel of the file `x.wgsl`, behind the parts that it uses.
macro_rules! kernel {
    ($name:literal, [$($part:literal),*], $bindings:expr) => {
        Kernel {
            name: $name,
            source: concat!(
                include_str!("picture.wgsl"),
                $(include_str!(concat!($part, ".wgsl")),)*
                include_str!(concat!($name, ".wgsl")),
            ),
            bindings: &$bindings,
        }
    };
}

pub(super) static CAMERA: Kernel =
    kernel!("camera", ["sampler", "warp", "leave"], [Uniform, Write, Write]);

pub(super) static SURFACE: Kernel = kernel!(
    "surface",
    ["warp", "ground"],
    [Uniform, Read, Read, Read, Read, Read, Read, Read, Write]
);

pub(super) static SHADE_NORMALS: Kernel =
    kernel!("shade_normals", ["seen"], [Uniform, Read, Write]);

pub(super) static SHADE_AO: Kernel = kernel!(
    "shade_ao",
    ["sampler", "warp", "ground", "leave", "seen", "queue"],
    [Uniform, Read, Write, Write, Write, Write]
);

pub(super) static SHADE_PATH: Kernel = kernel!(
    "shade_path",
    ["sampler", "warp", "sky", "ground", "leave", "seen", "queue"],
    [Uniform, Read, Read, Write, Write, Write, Write, Write, Write]
);

pub(super) static SUNLIGHT: Kernel =
    kernel!("sunlight", ["queue"], [Uniform, Read, Read, Write, Write]);

pub(super) static ESCAPE: Kernel =
    kernel!("escape", ["sky", "ground", "queue"], [Uniform, Read, Read, Read, Write, Write]);

pub(super) static ACCUMULATE: Kernel = kernel!("accumulate", [], [Uniform, Read, Write]);

#[cfg(test)]
pub(super) static SAMPLED: Kernel = kernel!("sampled", ["sampler"], [Uniform, Write]);

/// Every kernel that pictures need.
pub(super) const KERNELS: &[&Kernel] =
    &[&CAMERA, &SURFACE, &SHADE_NORMALS, &SHADE_AO, &SHADE_PATH, &SUNLIGHT, &ESCAPE, &ACCUMULATE];

/// No counter.
pub(super) const NONE: u32 = u32::MAX;

/// Words of a ray, and of the structs of `picture.wgsl`.
pub(super) const RAY: u64 = 8;
pub(super) const POINT: u64 = 16;
pub(super) const PATH: u64 = 24;

/// The uniform of every kernel; `picture.wgsl` says what is what.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(super) struct Params {
    pub(super) bound: u32,
    pub(super) at: u32,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) samples: u32,
    pub(super) sample_bits: u32,
    pub(super) first_pixel: u32,
    pub(super) first_sample: u32,
    pub(super) samples_here: u32,
    pub(super) film_pixel: u32,
    pub(super) bounce: u32,
    pub(super) bounces: u32,
    pub(super) counters: [u32; 4],
    pub(super) eye: [f32; 3],
    pub(super) reach: f32,
    pub(super) right: [f32; 3],
    pub(super) has_ground: u32,
    pub(super) up: [f32; 3],
    pub(super) ground_height: f32,
    pub(super) forward: [f32; 3],
    pub(super) ground_radius: f32,
    pub(super) ground_center: [f32; 3],
    pub(super) has_sun: u32,
    pub(super) ground_colour: [f32; 3],
    pub(super) has_parts: u32,
    pub(super) vertical: [f32; 3],
    pub(super) colours: u32,
    pub(super) zenith: [f32; 3],
    pub(super) sun_cos: f32,
    pub(super) horizon: [f32; 3],
    pub(super) unused: u32,
    pub(super) below: [f32; 3],
    pub(super) unused_too: u32,
    pub(super) sun: [f32; 3],
    pub(super) unused_either: u32,
    pub(super) strength: [f32; 3],
    pub(super) unused_at_last: u32,
}
