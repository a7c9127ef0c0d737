//! What a picture can be told.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::Sky;

/// How surfaces are shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// Surface directions as colours.
    Normals,
    /// Ambient occlusion: how much of the surroundings a point sees.
    Ao,
    /// Sun and sky, reflected several times by matt surfaces.
    #[default]
    Path,
    /// What the camera rays cost in the tree, as a heat map with a legend.
    Cost,
}

/// Options of a picture; change the fields you care about.
#[derive(Clone)]
pub struct RenderOptions<'a> {
    /// Pixels in a row.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
    /// How surfaces are shaded.
    pub shading: Shading,
    /// Samples a pixel; `None` for what suits the shading.
    pub samples: Option<u32>,
    /// [`Shading::Path`]: reflections that a path makes at most.
    pub bounces: u32,
    /// [`Shading::Ao`]: how far a surface is looked for, as a fraction of the scene's diagonal.
    pub reach: f32,
    /// [`Shading::Path`]: where the light comes from.
    pub sky: Sky,
    /// [`Shading::Path`]: factor on all light, or `None` to lighten dark pictures.
    pub exposure: Option<f32>,
    /// The colour of all surfaces (linear, in 0..=1), or `None` for one a part of the mesh.
    pub albedo: Option<[f32; 3]>,
    /// [`Shading::Ao`], [`Shading::Path`]: whether the mesh stands on an endless ground.
    pub ground: bool,
    /// Whether the noise of few samples is smoothed away within surfaces.
    pub denoise: bool,
    /// Called now and then, from any of the threads, with the fraction that is done.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
    /// When this becomes true the picture ends soon with [`Cancelled`].
    pub cancel: Option<&'a AtomicBool>,
}

impl Default for RenderOptions<'_> {
    fn default() -> Self {
        Self {
            width: 960,
            height: 640,
            shading: Shading::default(),
            samples: None,
            bounces: 4,
            reach: 0.2,
            sky: Sky::default(),
            exposure: None,
            albedo: None,
            ground: true,
            denoise: true,
            progress: None,
            cancel: None,
        }
    }
}

impl RenderOptions<'_> {
    /// Width over height, for [`Camera::framing`](crate::Camera::framing).
    #[must_use]
    pub fn aspect(&self) -> f32 {
        self.width as f32 / self.height.max(1) as f32
    }

    /// Samples a pixel, at least one.
    #[must_use]
    pub fn samples(&self) -> u32 {
        let suitable = match self.shading {
            Shading::Normals | Shading::Cost => 4,
            Shading::Path => 8,
            Shading::Ao => 16,
        };
        self.samples.unwrap_or(suitable).max(1)
    }

    /// Ends the work if the caller wants it to end.
    pub(crate) fn check_cancelled(&self) -> Result<(), Cancelled> {
        match self.cancel {
            Some(cancel) if cancel.load(Ordering::Relaxed) => Err(Cancelled),
            _ => Ok(()),
        }
    }
}

/// The caller asked the picture to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the picture was cancelled")]
pub struct Cancelled;
