//! Tree after tree, for scenes that move.

use kdray::{BuildOptions, Mesh};

use super::spare::Spare;
use super::{BuildReport, prepare, resident};
use crate::device::Device;
use crate::error::GpuError;
use crate::trace::Tracer;

/// Builds one tree after the other on a device, each in the memory of the one before.
///
/// Every tree is that of [`build`](super::build()), and stays on the device. After the first no kernel
/// is compiled, and no memory allocated unless a mesh or its tree is larger, or a tracer of an earlier
/// one is still there; in between, the memory stays allocated.
///
/// ```no_run
/// use kdray::{BuildOptions, Mesh, Ray};
/// use kdray_gpu::{Device, Limits, Rebuilder, Selection, TraceOptions};
///
/// let device = Device::open(&Selection::Best, &Limits::PORTABLE)?;
/// let mut rebuilder = Rebuilder::new(&device)?;
/// for height in [1.0, 2.0, 3.0] {
///     let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, height, 0.0]];
///     let mesh = Mesh::new(&positions, &[[0, 1, 2]])?;
///     let (tracer, _) = rebuilder.build(&mesh, &BuildOptions::default())?;
///     let (ray, mut hits) = (Ray::new([0.0, height, 1.0], [0.0, 0.0, -1.0]), [None]);
///     tracer.batch(TraceOptions::default()).closest_hits(&[ray], &mut hits)?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Rebuilder<'a> {
    device: &'a Device,
    spare: Spare,
}

impl<'a> Rebuilder<'a> {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// As [`prepare`].
    pub fn new(device: &'a Device) -> Result<Self, GpuError> {
        prepare(device)?;
        Ok(Self { device, spare: Spare::kept() })
    }

    /// Builds the tree of `mesh`, gives what answers rays over it, and says what it took.
    ///
    /// # Errors
    ///
    /// As [`Tracer::build`]; the next build starts without memory then.
    pub fn build(
        &mut self,
        mesh: &Mesh,
        options: &BuildOptions,
    ) -> Result<(Tracer<'a>, BuildReport), GpuError> {
        let spare = || std::mem::replace(&mut self.spare, Spare::kept());
        let (tracer, report, spare) = resident::build(spare, self.device, mesh, options)?;
        self.spare = spare;
        Ok((tracer, report))
    }
}
