//! How long dispatches take.

use crate::device::{Buffer, Device};
use crate::error::GpuError;

/// Dispatches of which a query set has both timestamps.
const PER_SET: u32 = wgpu::QUERY_SET_MAX_QUERIES / 2;

const BYTES: u64 = 2 * wgpu::QUERY_SIZE as u64;

/// Timestamps before and after every dispatch of a recording.
pub(super) struct Clock<'a> {
    device: &'a Device,
    dispatches: u32,
    sets: Vec<wgpu::QuerySet>,
    resolved: wgpu::Buffer,
    readable: Buffer,
}

impl<'a> Clock<'a> {
    /// `None` on a device without timestamps.
    pub(super) fn new(device: &'a Device, dispatches: u32) -> Result<Option<Self>, GpuError> {
        if !device.has_timestamps() || dispatches == 0 {
            return Ok(None);
        }
        let set = |index: u32| {
            device.raw.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * (dispatches - index * PER_SET).min(PER_SET),
            })
        };
        let sets = (0..dispatches.div_ceil(PER_SET)).map(set).collect();
        let resolved = device.raw.create_buffer(&wgpu::BufferDescriptor {
            label: Some("timestamps"),
            size: BYTES * u64::from(dispatches),
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let readable = device.buffer("timestamps", BYTES / 4 * u64::from(dispatches))?;
        Ok(Some(Self { device, dispatches, sets, resolved, readable }))
    }

    /// Where the pass of the dispatch `index` writes when it starts and when it ends.
    pub(super) fn around(&self, index: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        let query = 2 * (index % PER_SET);
        wgpu::ComputePassTimestampWrites {
            query_set: &self.sets[(index / PER_SET) as usize],
            beginning_of_pass_write_index: Some(query),
            end_of_pass_write_index: Some(query + 1),
        }
    }

    /// Collects the timestamps, after all passes.
    pub(super) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        for (index, set) in (0..).zip(&self.sets) {
            let queries = 2 * (self.dispatches - index * PER_SET).min(PER_SET);
            let start = BYTES * u64::from(index * PER_SET);
            encoder.resolve_query_set(set, 0..queries, &self.resolved, start);
        }
        let (to, size) = (self.readable.raw(), self.readable.size_bytes());
        encoder.copy_buffer_to_buffer(&self.resolved, 0, to, 0, size);
    }

    /// Seconds of every dispatch.
    pub(super) fn seconds(&self) -> Result<Vec<f64>, GpuError> {
        let tick = f64::from(self.device.queue.get_timestamp_period()) * 1e-9;
        let stamps: Vec<[u64; 2]> = self.device.read(&self.readable)?;
        Ok(stamps.iter().map(|[start, end]| end.saturating_sub(*start) as f64 * tick).collect())
    }
}
