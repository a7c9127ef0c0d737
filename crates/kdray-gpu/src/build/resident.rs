//! Trees that stay on the device, where rays find them.

use kdray::{BuildOptions, Mesh};

use super::first::Start;
use super::spare::Spare;
use super::{BuildReport, Wanted, build_in};
use crate::device::Device;
use crate::error::GpuError;
use crate::trace::{Scene, Tracer};

/// What a build that stays on the device gives.
const STAYS: Wanted = Wanted { with_profile: false, keeps_mesh: true };

/// Builds in the memory that `spare` gives, and hands it on but for what the tracer has.
pub(super) fn build<'a>(
    spare: impl FnMut() -> Spare,
    device: &'a Device,
    mesh: &Mesh,
    options: &BuildOptions,
) -> Result<(Tracer<'a>, BuildReport, Spare), GpuError> {
    let start = Start::root(mesh, options)?;
    let (left, report, spare) = build_in(spare, device, &start, options, STAYS)?;
    device.wait()?;
    let on_device = left.mesh.expect("it was to stay");
    Ok((Tracer::over(device, Scene::new(mesh, on_device, left.tree)), report, spare))
}

impl<'a> Tracer<'a> {
    /// Builds the tree of `mesh` on the device, that of [`build`](super::build()), and leaves it there:
    /// neither tree nor mesh come back or are brought again.
    ///
    /// # Errors
    ///
    /// As [`build`](super::build()), and if the mesh or its tree is larger than what the device can bind.
    ///
    /// ```no_run
    /// use kdray::{BuildOptions, Mesh, Ray};
    /// use kdray_gpu::{Device, Limits, Selection, TraceOptions, Tracer};
    ///
    /// let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
    /// let device = Device::open(&Selection::Best, &Limits::PORTABLE)?;
    /// let (tracer, _) = Tracer::build(&device, &mesh, &BuildOptions::default())?;
    /// let mut found = [false];
    /// let ray = Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
    /// tracer.batch(TraceOptions::default()).any_hits(&[ray], &mut found)?;
    /// assert_eq!(found, [true]);
    /// assert_eq!(tracer.tree(&mesh)?.nodes().len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn build(
        device: &'a Device,
        mesh: &Mesh,
        options: &BuildOptions,
    ) -> Result<(Self, BuildReport), GpuError> {
        let (tracer, report, _) = build(Spare::default, device, mesh, options)?;
        Ok((tracer, report))
    }
}
