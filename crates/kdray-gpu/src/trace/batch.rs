//! Queries for rays in the memory of the host, some of them at a time.

use std::sync::atomic::{AtomicBool, Ordering};

use kdray::{BatchError, Hit, Ray};

use super::kernels::{CLOSEST, PRIVATE_BYTES, Rays};
use super::tracer::Tracer;
use crate::device::Buffer;
use crate::error::GpuError;
use crate::record::{Profile, Recording};

/// Options of a batch; change the fields you care about.
#[derive(Clone, Copy, Default)]
pub struct TraceOptions<'a> {
    /// By ray, a triangle that it does not see, such as the one that it starts on; `u32::MAX` for
    /// none.
    pub except: Option<&'a [u32]>,
    /// Called now and then with the fraction that is done.
    pub progress: Option<&'a dyn Fn(f32)>,
    /// When this becomes true the batch ends soon with [`BatchError::Cancelled`].
    pub cancel: Option<&'a AtomicBool>,
}

/// Asks a [`Tracer`] many things at once; made by [`Tracer::batch`].
///
/// Queries panic if there are not as many answers, or triangles in [`TraceOptions::except`], as
/// rays. They fail if the device does, has no memory for the rays, or the batch is cancelled.
pub struct Batch<'a> {
    pub(super) tracer: &'a Tracer<'a>,
    pub(super) options: TraceOptions<'a>,
}

/// What the closest hits of a batch took.
#[derive(Clone, Debug, Default)]
pub struct TraceReport {
    /// Nodes that were visited.
    pub steps: u64,
    /// Leaves that have references.
    pub leaves: u64,
    /// Triangles.
    pub tests: u64,
    /// Bytes of memory that a ray has for itself while it is followed, and while it is worked out where
    /// it hits. Less of it lets a GPU keep more rays in flight.
    pub private_bytes: [u32; 2],
    /// By kernel, what it moved of rays and answers, and how long it took.
    pub profile: Profile,
}

/// Rays that are on the device at one time. More of them hide what a batch costs besides; fewer take
/// less memory, 64 bytes a ray, and let it be cancelled sooner.
pub(super) const CHUNK: usize = 1 << 18;

impl Batch<'_> {
    /// Writes to `hits[i]` the [closest hit](kdray::Tracer::closest_hit) of `rays[i]`.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<(), GpuError> {
        let [triangles, found] = [self.answers(rays, 1)?, self.answers(rays, 4)?];
        self.in_chunks(rays, hits, |rays, hits| {
            let mut recording = Recording::new(self.tracer.device());
            self.tracer.record_closest(&mut recording, rays, [&triangles, &found]);
            recording.run()?;
            self.read_hits(&found, hits)
        })
    }

    /// [`Batch::closest_hits`], and what it took; counting makes it slower.
    pub fn closest_hits_reported(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
    ) -> Result<TraceReport, GpuError> {
        let [triangles, found] = [self.answers(rays, 1)?, self.answers(rays, 4)?];
        let counts = self.answers(rays, 4)?;
        let mut report = TraceReport { private_bytes: PRIVATE_BYTES, ..TraceReport::default() };
        self.in_chunks(rays, hits, |rays, hits| {
            let scene = &self.tracer.scene;
            let mut recording = Recording::new(self.tracer.device());
            recording.stage("closest", 0);
            rays.query(&mut recording, (&CLOSEST, true), scene, &[&triangles, &counts]);
            recording.stage("locate", 0);
            rays.locate(&mut recording, scene, [&triangles, &found]);
            report.profile.append(recording.profile()?);
            let counts = counts.words(0, 4 * hits.len() as u64);
            for [steps, leaves, tests, _] in self.tracer.device().read::<[u32; 4]>(&counts)? {
                report.steps += u64::from(steps);
                report.leaves += u64::from(leaves);
                report.tests += u64::from(tests);
            }
            self.read_hits(&found, hits)
        })?;
        Ok(report)
    }

    /// Writes to `found[i]` whether `rays[i]` [hits anything](kdray::Tracer::any_hit).
    pub fn any_hits(&self, rays: &[Ray], found: &mut [bool]) -> Result<(), GpuError> {
        let words = self.answers(rays, 1)?;
        self.in_chunks(rays, found, |rays, found| {
            let mut recording = Recording::new(self.tracer.device());
            self.tracer.record_any(&mut recording, rays, &words);
            recording.run()?;
            let words = words.words(0, found.len() as u64);
            let read = self.tracer.device().read::<u32>(&words)?;
            found.iter_mut().zip(read).for_each(|(found, word)| *found = word == 1);
            Ok(())
        })
    }

    /// Room for answers of so many words to the rays of a chunk.
    pub(super) fn answers(&self, rays: &[Ray], words: usize) -> Result<Buffer, GpuError> {
        let count = rays.len().min(CHUNK) * words;
        self.tracer.device().buffer("answers", count as u64)
    }

    fn read_hits(&self, found: &Buffer, hits: &mut [Option<Hit>]) -> Result<(), GpuError> {
        let found = found.words(0, 4 * hits.len() as u64);
        let read = self.tracer.device().read::<Hit>(&found)?;
        for (hit, read) in hits.iter_mut().zip(read) {
            *hit = (read.triangle != u32::MAX).then_some(read);
        }
        Ok(())
    }

    /// Brings the rays to the device, some at a time, and lets `ask` bring back the answers.
    pub(super) fn in_chunks<A>(
        &self,
        rays: &[Ray],
        answers: &mut [A],
        mut ask: impl FnMut(&Rays, &mut [A]) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        assert_eq!(rays.len(), answers.len(), "one answer a ray");
        let except = self.options.except;
        assert!(except.is_none_or(|except| except.len() == rays.len()), "one triangle a ray");
        let device = self.tracer.device();
        let of_rays = self.answers(rays, 8)?;
        let of_except = except.map(|_| self.answers(rays, 1)).transpose()?;
        let mut done = 0;
        for (chunk, answers) in rays.chunks(CHUNK).zip(answers.chunks_mut(CHUNK)) {
            if self.options.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                return Err(BatchError::Cancelled.into());
            }
            device.write(&of_rays, chunk);
            if let Some((buffer, except)) = of_except.as_ref().zip(except) {
                device.write(buffer, &except[done..done + chunk.len()]);
            }
            let (count, except) = (chunk.len() as u32, of_except.clone());
            ask(&Rays { rays: of_rays.clone(), except, count, live: None }, answers)?;
            done += chunk.len();
            if let Some(report) = self.options.progress {
                report(done as f32 / rays.len() as f32);
            }
        }
        Ok(())
    }
}
