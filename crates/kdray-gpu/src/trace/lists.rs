//! All hits of rays, and how many they are.
//!
//! A ray meets a triangle in every leaf that both pass through. So the triangles are met twice, once
//! to count them and once to write them down; then they are located, put in order, and those that
//! came again are left out.

use std::ops::{ControlFlow, Range};

use kdray::{Hit, Lists, Ray};

use super::batch::Batch;
use super::kernels::{LOCATE_MET, MEET, ORDER, Rays};
use super::tracer::Tracer;
use crate::device::Buffer;
use crate::error::GpuError;
use crate::primitives::scan::Scan;
use crate::record::{Count, Recording};

/// Bytes of a hit.
const HIT: u64 = size_of::<Hit>() as u64;

/// All hits of consecutive rays, in the memory of the device.
#[derive(Debug)]
pub struct HitLists {
    /// By ray, where its hits begin.
    pub starts: Buffer,
    /// By ray, how many there are from there on.
    pub counts: Buffer,
    /// Four words each, a [`kdray::Hit`]. What is between lists means nothing.
    pub hits: Buffer,
}

impl Batch<'_> {
    /// Writes to `counts[i]` [how many triangles](kdray::Tracer::count_hits) `rays[i]` hits.
    pub fn count_hits(&self, rays: &[Ray], counts: &mut [u32]) -> Result<(), GpuError> {
        let device = self.tracer.device();
        self.in_chunks(rays, counts, |rays, counts| {
            self.tracer.all_hits(rays, |part, found| {
                let read = device.read::<u32>(&found.counts.words(0, part.len() as u64))?;
                counts[part.start as usize..part.end as usize].copy_from_slice(&read);
                Ok(())
            })
        })
    }

    /// Gives `sink` [all hits](kdray::Tracer::all_hits) of each ray, in the order of the rays, some
    /// rays at a time, until it breaks. It fails if 64 rays meet more triangles than there may be
    /// hits in a binding of the device, which is 8 million at least.
    pub fn all_hits(
        &self,
        rays: &[Ray],
        mut sink: impl FnMut(Lists<Hit>) -> ControlFlow<()>,
    ) -> Result<(), GpuError> {
        let device = self.tracer.device();
        let (mut done, mut is_over) = (0, false);
        let mut unit = vec![(); rays.len()];
        self.in_chunks(rays, &mut unit, |rays, _| {
            self.tracer.all_hits(rays, |part, found| {
                let (first, count) = (done, part.len());
                done += count;
                if is_over {
                    return Ok(());
                }
                let starts = device.read::<u32>(&found.starts.words(0, count as u64))?;
                let counts = device.read::<u32>(&found.counts.words(0, count as u64))?;
                let hits = device.read::<Hit>(&found.hits)?;
                let (mut offsets, mut items) = (vec![0], Vec::new());
                for (start, count) in starts.into_iter().zip(counts) {
                    items.extend_from_slice(&hits[start as usize..(start + count) as usize]);
                    offsets.push(items.len());
                }
                let lists = Lists { first, offsets: &offsets, items: &items };
                is_over = sink(lists).is_break();
                Ok(())
            })
        })
    }
}

impl Tracer<'_> {
    /// Finds [all hits](kdray::Tracer::all_hits) of rays that are on the device, which stay there, and
    /// how many they are. `take` gets them with the range of their rays, as many at a time as the
    /// device may bind hits.
    ///
    /// # Errors
    ///
    /// As [`Batch::all_hits`], and those of `take`.
    ///
    /// # Panics
    ///
    /// If only the device knows how many rays there are.
    pub fn all_hits(
        &self,
        rays: &Rays,
        mut take: impl FnMut(Range<u32>, &HitLists) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        assert!(rays.live.is_none(), "the host makes room for the hits, so it has to know");
        let mut waiting: Vec<_> = std::iter::once(0..rays.count).collect();
        while let Some(part) = waiting.pop() {
            let some = rays.part(&part);
            let starts = self.count_met(&some)?;
            let count = u64::from(some.count);
            let total = self.device.read::<u32>(&starts.words(count, 1))?[0];
            if HIT * u64::from(total) > self.device.limits().binding_bytes {
                waiting.extend(self.halves(part, total)?);
                continue;
            }
            let found = self.find(&some, starts, total)?;
            take(part, &found)?;
        }
        Ok(())
    }

    /// By ray, how many triangles come before those that it meets, and, last, how many all meet.
    fn count_met(&self, rays: &Rays) -> Result<Buffer, GpuError> {
        let device = self.device;
        let starts = device.buffer("starts", u64::from(rays.count) + 1)?;
        let nothing = device.buffer("triangles met", 2)?;
        let scan = Scan::new(device, rays.count + 1)?;
        let mut recording = Recording::new(device);
        recording.clear(&starts);
        let answers = [&starts, &nothing];
        rays.query(&mut recording, (&MEET, true), &self.scene, &answers);
        scan.record(&mut recording, &starts, &Count::from(rays.count + 1), None);
        recording.run()?;
        Ok(starts)
    }

    /// The hits of rays that meet `total` triangles.
    fn find(&self, rays: &Rays, starts: Buffer, total: u32) -> Result<HitLists, GpuError> {
        let (device, scene) = (self.device, &self.scene);
        let met = device.buffer("triangles met", 2 * u64::from(total).max(1))?;
        let hits = device.buffer("hits", 4 * u64::from(total).max(1))?;
        let counts = device.buffer("counts of hits", rays.count.into())?;
        let mut recording = Recording::new(device);
        rays.query(&mut recording, (&MEET, false), scene, &[&starts, &met]);
        let [positions, triangles] = [&scene.positions, &scene.triangles];
        let located = [positions, triangles, &met, &hits];
        rays.run(&mut recording, (&LOCATE_MET, total.into()), scene, &located);
        rays.run(&mut recording, (&ORDER, rays.count.into()), scene, &[&starts, &hits, &counts]);
        recording.run()?;
        Ok(HitLists { starts, counts, hits })
    }

    /// Halves of rays that meet `total` triangles, which are too many; the first one last.
    fn halves(&self, part: Range<u32>, total: u32) -> Result<[Range<u32>; 2], GpuError> {
        let half = (part.len() as u32 / 2).next_multiple_of(Rays::ALIGNMENT);
        if half >= part.len() as u32 {
            let device = self.device;
            return Err(GpuError::Limit {
                adapter: device.adapter().name.clone(),
                limit: "binding_bytes",
                asked: HIT * u64::from(total),
                offered: device.limits().binding_bytes,
            });
        }
        Ok([part.start + half..part.end, part.start..part.start + half])
    }
}
