//! The GPU: what there is, how it is opened, and what becomes of its errors.

mod adapter;
mod buffer;
mod limits;
mod read;
#[cfg(test)]
mod tests;
mod traffic;

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

pub use adapter::{Adapter, Kind, Selection, devices};
pub use buffer::{Buffer, MemoryUse};
pub(crate) use buffer::{Watch, generous};
pub use limits::Limits;
pub use traffic::Traffic;

use crate::error::GpuError;
use crate::float::Floats;
use crate::record::Binding;

/// An adapter that was opened.
///
/// Nothing here panics. What a driver complains of is kept, and the next call that waits for the
/// device gives it back as an error.
#[derive(Debug)]
pub struct Device {
    adapter: Adapter,
    limits: Limits,
    pub(crate) raw: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    failure: Failure,
    memory: Arc<MemoryUse>,
    traffic: Traffic,
    /// By name and text.
    pub(crate) pipelines: Mutex<HashMap<[&'static str; 2], wgpu::ComputePipeline>>,
    /// What the host reads through, kept for the next time.
    staging: Mutex<Option<wgpu::Buffer>>,
    /// The parameters of the recording before, kept for the next one.
    pub(crate) parameters: Mutex<Option<wgpu::Buffer>>,
    pub(crate) floats: OnceLock<Floats>,
    /// Zeros that the drivers take for anything, for the part `float`.
    pub(crate) zero: Zero,
    /// A word greater than all counts.
    pub(crate) unlimited: Buffer,
}

/// A uniform of zeros, which every kernel may bind as group 1.
#[derive(Debug)]
pub(crate) struct Zero {
    pub(crate) layout: wgpu::BindGroupLayout,
    pub(crate) group: wgpu::BindGroup,
}

impl Zero {
    fn new(device: &wgpu::Device) -> Self {
        let zeros = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("zeros"),
            size: 16,
            usage: wgpu::BufferUsages::UNIFORM,
            mapped_at_creation: false,
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("zeros"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: Binding::Uniform.layout(),
                count: None,
            }],
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("zeros"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: zeros.as_entire_binding() }],
        });
        Self { layout, group }
    }
}

/// The content of `mutex`, also after a panic: nothing here is left half done.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The first thing that went wrong.
#[derive(Clone, Debug, Default)]
struct Failure(Arc<Mutex<Option<GpuError>>>);

impl Failure {
    fn record(&self, error: GpuError) {
        lock(&self.0).get_or_insert(error);
    }

    fn get(&self) -> Option<GpuError> {
        lock(&self.0).clone()
    }
}

impl Device {
    /// Opens the selected adapter within `limits`.
    ///
    /// Timestamps are asked for where the adapter has them, and nothing else beyond WebGPU.
    ///
    /// # Errors
    ///
    /// If there is no such adapter, it offers less than `limits`, or its driver does not open it.
    ///
    /// ```no_run
    /// use kdray_gpu::{Device, Limits, Selection};
    ///
    /// let device = Device::open(&Selection::Best, &Limits::PORTABLE)?;
    /// println!("{}", device.adapter().name);
    /// # Ok::<(), kdray_gpu::GpuError>(())
    /// ```
    pub fn open(selection: &Selection, limits: &Limits) -> Result<Self, GpuError> {
        let (adapter, handle) = adapter::select(selection)?;
        limits.check(&adapter.limits, &adapter.name)?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("kdray"),
            required_features: handle.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: limits.within(&handle.limits()),
            ..Default::default()
        };
        let opened = pollster::block_on(handle.request_device(&descriptor));
        let refused = |reason: wgpu::RequestDeviceError| {
            let (adapter, reason) = (adapter.name.clone(), reason.to_string());
            GpuError::Refused { adapter, reason }
        };
        let (raw, queue) = opened.map_err(refused)?;
        let failure = Failure::default();
        listen(&raw, &failure);
        let memory = Arc::default();
        let unlimited = buffer::create(&raw, "unlimited", 4);
        queue.write_buffer(&unlimited, 0, &u32::MAX.to_le_bytes());
        let device = Self {
            adapter,
            limits: *limits,
            zero: Zero::new(&raw),
            unlimited: Buffer::own(unlimited, &memory),
            raw,
            queue,
            failure,
            memory,
            traffic: Traffic::default(),
            pipelines: Mutex::default(),
            staging: Mutex::default(),
            parameters: Mutex::default(),
            floats: OnceLock::new(),
        };
        device.check()?;
        Ok(device)
    }

    /// Opens the selected adapter within the portable limits, but for buffers as large as it has them.
    ///
    /// # Errors
    ///
    /// As [`Device::open`].
    pub fn open_with_large_buffers(selection: &Selection) -> Result<Self, GpuError> {
        let (adapter, _) = adapter::select(selection)?;
        Self::open(selection, &adapter.limits.portable_with_large_buffers())
    }

    /// What was opened.
    #[must_use]
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// What was asked for.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Whether the device can say how long its work took.
    #[must_use]
    pub fn has_timestamps(&self) -> bool {
        self.raw.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// How many kernels were compiled since the device was opened.
    #[must_use]
    pub fn compiled(&self) -> usize {
        lock(&self.pipelines).len()
    }

    /// The memory that the device's buffers take.
    #[must_use]
    pub fn memory(&self) -> &MemoryUse {
        &self.memory
    }

    /// What went between the host and the device.
    #[must_use]
    pub fn traffic(&self) -> &Traffic {
        &self.traffic
    }

    /// Fails if anything went wrong since the device was opened.
    ///
    /// # Errors
    ///
    /// The first of all errors; they stay.
    pub fn check(&self) -> Result<(), GpuError> {
        self.failure.get().map_or(Ok(()), Err)
    }
}

/// Keeps what the driver complains of.
fn listen(device: &wgpu::Device, failure: &Failure) {
    let uncaptured = failure.clone();
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        let what = "a command".to_owned();
        uncaptured.record(GpuError::Driver { what, reason: error.to_string() });
    }));
    let lost = failure.clone();
    device.set_device_lost_callback(move |reason, message| {
        if reason != wgpu::DeviceLostReason::Destroyed {
            lost.record(GpuError::Lost { reason: message });
        }
    });
}
