//! What went between the host and the device.

use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes that went to a device and came back since it was opened, parameters of kernels included.
#[derive(Debug, Default)]
pub struct Traffic {
    up: AtomicU64,
    down: AtomicU64,
}

impl Traffic {
    /// Bytes that the host brought to the device.
    #[must_use]
    pub fn up_bytes(&self) -> u64 {
        self.up.load(Ordering::Relaxed)
    }

    /// Bytes that the host read.
    #[must_use]
    pub fn down_bytes(&self) -> u64 {
        self.down.load(Ordering::Relaxed)
    }

    pub(super) fn bring_down(&self, bytes: u64) {
        self.down.fetch_add(bytes, Ordering::Relaxed);
    }
}

impl super::Device {
    /// Writes bytes into a buffer, after all work submitted so far.
    pub(crate) fn bring(&self, buffer: &wgpu::Buffer, offset_bytes: u64, bytes: &[u8]) {
        self.traffic.up.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        self.queue.write_buffer(buffer, offset_bytes, bytes);
    }
}
