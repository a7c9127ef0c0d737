//! The memory that paths need on their way.

use kdray_gpu::device::Buffer;
use kdray_gpu::record::Count;
use kdray_gpu::{Device, GpuError, Rays};

use super::kernels::{NONE, PATH, POINT, RAY};

/// Reflections between two looks at how many paths are left. More of them are fewer waits for the
/// device; fewer end a picture sooner when all paths have ended or it is cancelled.
pub(super) const SEGMENT: u32 = 8;

/// Buffers for so many paths.
pub(super) struct Room {
    pub(super) capacity: u32,
    /// Rays to be traced, and those that come next.
    pub(super) queues: [Queue; 2],
    pub(super) shadow_rays: Buffer,
    /// By shadow ray, its light and its path.
    pub(super) shadows: Buffer,
    pub(super) triangles: Buffer,
    pub(super) hits: Buffer,
    pub(super) points: Buffer,
    pub(super) found: Buffer,
    pub(super) paths: Buffer,
    /// By reflection, how many paths go on, and how many shadow rays there are.
    pub(super) counters: Buffer,
    pub(super) lengths: Vec<[Length; 2]>,
}

/// Rays, and the paths that they are of.
pub(super) struct Queue {
    pub(super) rays: Buffer,
    pub(super) ids: Buffer,
}

/// How many rays a queue has.
#[derive(Clone)]
pub(super) struct Length {
    pub(super) count: Count,
    /// The most there can be.
    pub(super) bound: u32,
    /// Which counter says how many, or [`NONE`].
    pub(super) at: u32,
}

impl Room {
    pub(super) fn new(device: &Device, capacity: u32) -> Result<Self, GpuError> {
        let buffer = |label, words: u64| device.buffer(label, words * u64::from(capacity));
        let queue = || -> Result<_, GpuError> {
            Ok(Queue { rays: buffer("rays", RAY)?, ids: buffer("ids", 1)? })
        };
        let counters = device.buffer("lengths of queues", 2 * u64::from(SEGMENT))?;
        let length = |at| -> Result<_, GpuError> {
            let count = Count::live(device, &counters, at, capacity)?;
            Ok(Length { count, bound: capacity, at })
        };
        let lengths = (0..SEGMENT).map(|turn| Ok([length(2 * turn)?, length(2 * turn + 1)?]));
        Ok(Self {
            capacity,
            queues: [queue()?, queue()?],
            shadow_rays: buffer("shadow rays", RAY)?,
            shadows: buffer("light of shadow rays", 4)?,
            triangles: buffer("triangles that are hit", 1)?,
            hits: buffer("hits", 4)?,
            points: buffer("points", POINT)?,
            found: buffer("whether rays hit", 1)?,
            paths: buffer("paths", PATH)?,
            lengths: lengths.collect::<Result<_, GpuError>>()?,
            counters,
        })
    }
}

impl Length {
    pub(super) fn known(length: u32) -> Self {
        Self { count: length.into(), bound: length, at: NONE }
    }

    /// As many of `rays`.
    pub(super) fn of(&self, rays: &Buffer) -> Rays {
        let live = (self.at != NONE).then(|| self.count.clone());
        Rays { rays: rays.clone(), except: None, count: self.bound, live }
    }
}
