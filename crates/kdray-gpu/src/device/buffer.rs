//! Memory of the device, counted.

use std::num::NonZeroU64;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Weak};

use super::Device;
use crate::error::GpuError;

/// Sizes of buffers that are used again and again: what grows a little finds room more often with
/// fewer of them, and all take more memory.
const SIZES_AN_OCTAVE: u64 = 2;

/// How many words to allocate where `words` are needed now, and perhaps a few more later.
pub(crate) fn generous(words: u64) -> u64 {
    words.next_multiple_of((words.next_power_of_two() / SIZES_AN_OCTAVE / 2).max(1))
}

/// Bytes that the buffers of a device take.
#[derive(Debug, Default)]
pub struct MemoryUse {
    bytes: AtomicU64,
    peak_bytes: AtomicU64,
    allocations: AtomicU64,
}

impl MemoryUse {
    /// Bytes of all buffers that there are now.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// The most bytes that there were since the device was opened or the peak was reset.
    #[must_use]
    pub fn peak_bytes(&self) -> u64 {
        self.peak_bytes.load(Ordering::Relaxed)
    }

    /// Forgets the peak.
    pub fn reset_peak(&self) {
        self.peak_bytes.store(self.bytes(), Ordering::Relaxed);
    }

    /// How many buffers were allocated since the device was opened.
    #[must_use]
    pub fn allocations(&self) -> u64 {
        self.allocations.load(Ordering::Relaxed)
    }

    fn book(&self, bytes: u64) {
        self.allocations.fetch_add(1, Ordering::Relaxed);
        let now = self.bytes.fetch_add(bytes, Ordering::Relaxed) + bytes;
        self.peak_bytes.fetch_max(now, Ordering::Relaxed);
    }

    fn release(&self, bytes: u64) {
        self.bytes.fetch_sub(bytes, Ordering::Relaxed);
    }
}

/// Words in the memory of a device, or a range of them. Clones and parts share the memory, which is
/// freed with the last of them.
#[derive(Clone, Debug)]
pub struct Buffer {
    owned: Arc<Owned>,
    offset_bytes: u64,
    size_bytes: u64,
}

#[derive(Debug)]
struct Owned {
    raw: wgpu::Buffer,
    memory: Arc<MemoryUse>,
}

impl Drop for Owned {
    fn drop(&mut self) {
        self.memory.release(self.raw.size());
    }
}

/// A buffer that kernels can use in every way.
pub(super) fn create(device: &wgpu::Device, label: &'static str, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE
        | wgpu::BufferUsages::COPY_SRC
        | wgpu::BufferUsages::COPY_DST
        | wgpu::BufferUsages::INDIRECT;
    let label = Some(label);
    let descriptor = wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false };
    device.create_buffer(&descriptor)
}

/// Sees whether a buffer's memory is still there.
#[derive(Debug)]
pub(crate) struct Watch(Weak<Owned>);

impl Watch {
    /// Bytes of the memory; zero when it is freed.
    pub(crate) fn size_bytes(&self) -> u64 {
        self.0.upgrade().map_or(0, |owned| owned.raw.size())
    }
}

impl Buffer {
    pub(crate) fn watch(&self) -> Watch {
        Watch(Arc::downgrade(&self.owned))
    }

    pub(super) fn own(raw: wgpu::Buffer, memory: &Arc<MemoryUse>) -> Self {
        let size_bytes = raw.size();
        memory.book(size_bytes);
        Self { owned: Arc::new(Owned { raw, memory: memory.clone() }), offset_bytes: 0, size_bytes }
    }

    /// Size in bytes.
    #[must_use]
    pub fn size_bytes(&self) -> u64 {
        self.size_bytes
    }

    /// The `count` words from `start` on. Kernels can bind those that start at a multiple of 64
    /// words in the whole.
    ///
    /// # Panics
    ///
    /// If the buffer ends before.
    #[must_use]
    pub fn words(&self, start: u64, count: u64) -> Self {
        assert!(start + count <= self.size_bytes / 4, "{start} + {count} words of {self:?}");
        let offset_bytes = self.offset_bytes + 4 * start;
        Self { owned: self.owned.clone(), offset_bytes, size_bytes: 4 * count }
    }

    /// Whether anybody else has it, or a part of it.
    pub(crate) fn is_shared(&self) -> bool {
        Arc::strong_count(&self.owned) > 1
    }

    pub(crate) fn raw(&self) -> &wgpu::Buffer {
        &self.owned.raw
    }

    /// Where it starts in [`Buffer::raw`].
    pub(crate) fn offset_bytes(&self) -> u64 {
        self.offset_bytes
    }

    pub(crate) fn binding(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.raw(),
            offset: self.offset_bytes,
            size: NonZeroU64::new(self.size_bytes),
        })
    }
}

impl Device {
    /// A buffer of `words` zeros, at least one. Its use is up to the kernels: it can be bound, be
    /// copied from and to, and hold the arguments of indirect dispatches.
    ///
    /// # Errors
    ///
    /// If it is larger than the limits allow, or the device has no memory for it.
    pub fn buffer(&self, label: &'static str, words: u64) -> Result<Buffer, GpuError> {
        let size = 4 * words.max(1);
        if size > self.limits.buffer_bytes {
            return Err(GpuError::Limit {
                adapter: self.adapter.name.clone(),
                limit: "buffer_bytes",
                asked: size,
                offered: self.limits.buffer_bytes,
            });
        }
        let scope = self.raw.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let raw = create(&self.raw, label, size);
        if pollster::block_on(scope.pop()).is_some() {
            return Err(GpuError::OutOfMemory { buffer: label, bytes: size });
        }
        self.check()?;
        Ok(Buffer::own(raw, &self.memory))
    }

    /// A buffer that holds `data`, filled up to whole words with zeros.
    ///
    /// # Errors
    ///
    /// As [`Device::buffer`].
    pub fn upload<T: bytemuck::NoUninit>(
        &self,
        label: &'static str,
        data: &[T],
    ) -> Result<Buffer, GpuError> {
        let buffer = self.buffer(label, size_of_val(data).div_ceil(4) as u64)?;
        self.fill(&buffer, bytemuck::cast_slice(data));
        Ok(buffer)
    }

    /// Makes `buffer` one that starts with `data` and that kernels can bind: itself if it is large
    /// enough, or else a new one with some room for more.
    ///
    /// # Errors
    ///
    /// As [`Device::buffer`], and if kernels may not bind as much at once.
    pub fn refill<T: bytemuck::NoUninit>(
        &self,
        buffer: &mut Buffer,
        label: &'static str,
        data: &[T],
    ) -> Result<(), GpuError> {
        let (asked, offered) = (size_of_val(data) as u64, self.limits.binding_bytes);
        if asked > offered {
            let (adapter, limit) = (self.adapter.name.clone(), "binding_bytes");
            return Err(GpuError::Limit { adapter, limit, asked, offered });
        }
        if asked > buffer.size_bytes() {
            let words = asked.div_ceil(4);
            let most = (offered / 4).min(self.limits.buffer_bytes / 4).max(words);
            *buffer = self.buffer(label, generous(words).min(most))?;
        }
        self.fill(buffer, bytemuck::cast_slice(data));
        Ok(())
    }

    /// Writes bytes to the start of a buffer, filled up to whole words with zeros.
    fn fill(&self, buffer: &Buffer, bytes: &[u8]) {
        let (whole, rest) = bytes.split_at(bytes.len() / 4 * 4);
        self.bring(buffer.raw(), buffer.offset_bytes(), whole);
        if !rest.is_empty() {
            let mut word = [0; 4];
            word[..rest.len()].copy_from_slice(rest);
            let end = buffer.offset_bytes() + whole.len() as u64;
            self.bring(buffer.raw(), end, &word);
        }
    }

    /// Writes `data`, whole words, to the start of `buffer`, after all work submitted so far.
    ///
    /// # Panics
    ///
    /// If the buffer is smaller.
    pub fn write<T: bytemuck::NoUninit>(&self, buffer: &Buffer, data: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        assert!(bytes.len() as u64 <= buffer.size_bytes(), "{} bytes in {buffer:?}", bytes.len());
        self.bring(buffer.raw(), buffer.offset_bytes(), bytes);
    }
}
