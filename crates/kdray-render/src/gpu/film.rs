//! The film on a device.

use bytemuck::{Pod, Zeroable};
use kdray_gpu::device::Buffer;
use kdray_gpu::record::Recording;
use kdray_gpu::{Device, GpuError};

use crate::film::Film;
use crate::pixel::Sums;

/// Pixels of a part: what every device can bind, and then some.
pub(super) const PART: u32 = 1 << 20;

/// A pixel on the device; `accumulate.wgsl` has the places.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(super) struct Cell {
    pub(super) sums: Sums,
    pub(super) rays: u32,
    pub(super) hits: u32,
}

/// Words of a [`Cell`].
pub(super) const CELL: u64 = size_of::<Cell>() as u64 / 4;

/// Parts of a film; the last one may have room for more.
#[derive(Default)]
pub(super) struct Parts(Vec<Buffer>);

impl Parts {
    /// Makes a dark film of so many pixels, in the memory of the one before if there is room.
    pub(super) fn darken(&mut self, device: &Device, pixels: u64) -> Result<(), GpuError> {
        if pixels > u64::from(u32::MAX) {
            return Err(GpuError::OutOfMemory { buffer: "film", bytes: 4 * CELL * pixels });
        }
        let pixels = pixels as u32;
        let count = pixels.div_ceil(PART) as usize;
        self.0.truncate(count);
        let mut recording = Recording::new(device);
        for part in 0..count {
            let pixels = PART.min(pixels - part as u32 * PART);
            let words = CELL * u64::from(pixels);
            if self.0.get(part).is_none_or(|buffer| buffer.size_bytes() < 4 * words) {
                self.0.truncate(part);
                self.0.push(device.buffer("film", words)?);
            }
            recording.clear(&self.0[part]);
        }
        recording.run()
    }

    pub(super) fn part(&self, index: u32) -> &Buffer {
        &self.0[index as usize]
    }

    /// What is on the film when `done` of `samples` samples are.
    pub(super) fn read(
        &self,
        device: &Device,
        [width, height]: [u32; 2],
        [done, samples]: [u32; 2],
    ) -> Result<Film, GpuError> {
        let mut left = width as usize * height as usize;
        let mut film = Film { width, height, pixels: Vec::with_capacity(left), rays: 0, hits: 0 };
        for part in &self.0 {
            let pixels = left.min(PART as usize);
            for mut cell in device.read::<Cell>(&part.words(0, CELL * pixels as u64))? {
                cell.sums.brighten(samples as f32 / done as f32);
                film.pixels.push(cell.sums.mean(done as f32));
                film.rays += u64::from(cell.rays);
                film.hits += u64::from(cell.hits);
            }
            left -= pixels;
        }
        Ok(film)
    }
}
