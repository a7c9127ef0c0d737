//! From the device back to the host.

use std::sync::mpsc;

use super::{Buffer, Device, lock};
use crate::error::GpuError;

/// Most bytes that are on their way at once.
const STAGING_BYTES: u64 = 16 << 20;

impl Device {
    /// Waits for everything submitted so far.
    ///
    /// # Errors
    ///
    /// If something went wrong on the way.
    pub fn wait(&self) -> Result<(), GpuError> {
        let waited = self.raw.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        waited.map(|_| ()).map_err(|error| GpuError::Lost { reason: error.to_string() })
    }

    /// What the words of `buffer` are when all work submitted so far is done.
    ///
    /// # Errors
    ///
    /// If something went wrong on the way, or the device has no memory for the transfer.
    ///
    /// # Panics
    ///
    /// If the buffer does not hold a whole number of `T`.
    pub fn read<T: bytemuck::Pod>(&self, buffer: &Buffer) -> Result<Vec<T>, GpuError> {
        let mut data = vec![T::zeroed(); buffer.size_bytes() as usize / size_of::<T>()];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut data);
        assert_eq!(bytes.len() as u64, buffer.size_bytes(), "a whole number of elements");
        self.traffic.bring_down(buffer.size_bytes());
        let mut staging = lock(&self.staging);
        for (index, chunk) in bytes.chunks_mut(STAGING_BYTES as usize).enumerate() {
            let size = chunk.len() as u64;
            let ready = staging.take().filter(|ready| ready.size() >= size);
            let ready = ready.map_or_else(|| self.staging(size), Ok)?;
            self.read_chunk(buffer, index as u64 * STAGING_BYTES, chunk, &ready)?;
            *staging = Some(ready);
        }
        Ok(data)
    }

    /// A buffer that the host can read, of at least `size` bytes.
    fn staging(&self, size: u64) -> Result<wgpu::Buffer, GpuError> {
        let size = size.next_power_of_two().clamp(4 << 10, STAGING_BYTES);
        let scope = self.raw.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let staging = self.raw.create_buffer(&wgpu::BufferDescriptor {
            label: Some("staging"),
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        match pollster::block_on(scope.pop()) {
            Some(_) => Err(GpuError::OutOfMemory { buffer: "staging", bytes: size }),
            None => Ok(staging),
        }
    }

    fn read_chunk(
        &self,
        buffer: &Buffer,
        start: u64,
        chunk: &mut [u8],
        staging: &wgpu::Buffer,
    ) -> Result<(), GpuError> {
        let size = chunk.len() as u64;
        let mut encoder = self.raw.create_command_encoder(&Default::default());
        let from = buffer.offset_bytes() + start;
        encoder.copy_buffer_to_buffer(buffer.raw(), from, staging, 0, size);
        self.queue.submit([encoder.finish()]);
        let (sender, receiver) = mpsc::channel();
        let slice = staging.slice(..size);
        // The receiver is gone only when waiting failed, which is an error already.
        slice.map_async(wgpu::MapMode::Read, move |result| drop(sender.send(result)));
        self.wait()?;
        let failed = |reason: String| GpuError::Driver { what: "a transfer".to_owned(), reason };
        // Another thread that waits for this device may have taken the answer on itself and not
        // have given it yet: so this waits for it.
        let mapped = receiver.recv().map_err(|error| failed(error.to_string()))?;
        mapped.map_err(|error| failed(error.to_string()))?;
        let view = slice.get_mapped_range().map_err(|error| failed(error.to_string()))?;
        chunk.copy_from_slice(&view);
        drop(view);
        staging.unmap();
        Ok(())
    }
}
