//! Samples that are on their way at the same time.

use kdray_gpu::device::Buffer;
use kdray_gpu::record::{Kernel, Moved, Recording, Work};
use kdray_gpu::{Device, Tracer};

use super::RenderError;
use super::kernels::{
    ACCUMULATE, CAMERA, ESCAPE, Params, SHADE_AO, SHADE_NORMALS, SHADE_PATH, SUNLIGHT, SURFACE,
};
use super::looks::Looks;
use super::room::{Length, Room, SEGMENT};
use crate::{RenderOptions, Shading};

/// A wave, and what it works with.
pub(super) struct Wave<'a> {
    pub(super) tracer: &'a Tracer<'a>,
    pub(super) looks: &'a Looks,
    pub(super) room: &'a Room,
    /// With the pixels and samples of the wave.
    pub(super) params: Params,
    pub(super) pixels: u32,
}

/// Bytes of a ray's and of a path's data that kernels read or write for an element.
const fn moved(read: u64, written: u64) -> Moved {
    Moved { read, written }
}

impl Wave<'_> {
    /// Shades all samples and adds them to a part of the film. Returns when the device is done.
    pub(super) fn expose(&self, film: &Buffer, options: &RenderOptions) -> Result<(), RenderError> {
        match options.shading {
            Shading::Normals => self.shade_normals()?,
            Shading::Ao => self.shade_ao()?,
            Shading::Path => self.follow_paths(options)?,
            Shading::Cost => return Err(RenderError::Cost),
        }
        let mut recording = Recording::new(self.device());
        let pixels = Length::known(self.pixels);
        let buffers = [&self.room.paths, film];
        self.run(&mut recording, (&ACCUMULATE, &pixels, 0), &buffers, moved(196, 100));
        recording.run()?;
        Ok(self.device().wait()?)
    }

    fn shade_normals(&self) -> Result<(), RenderError> {
        let (room, all) = (self.room, self.all());
        let mut recording = self.with_camera_rays();
        self.find_surfaces(&mut recording, 0, &all);
        let buffers = [&room.points, &room.paths];
        self.run(&mut recording, (&SHADE_NORMALS, &all, 0), &buffers, moved(64, 96));
        Ok(recording.run()?)
    }

    fn shade_ao(&self) -> Result<(), RenderError> {
        let (room, all) = (self.room, self.all());
        let mut recording = self.with_camera_rays();
        self.find_surfaces(&mut recording, 0, &all);
        recording.clear(&room.counters);
        let buffers = [&room.points, &room.paths, &room.counters, &room.shadow_rays, &room.shadows];
        self.run(&mut recording, (&SHADE_AO, &all, 0), &buffers, moved(64, 144));
        self.add_sunlight(&mut recording, 0);
        Ok(recording.run()?)
    }

    /// Reflects paths until all have ended or may go no further.
    fn follow_paths(&self, options: &RenderOptions) -> Result<(), RenderError> {
        let bounces = options.bounces.saturating_add(1);
        let mut recording = self.with_camera_rays();
        let (mut done, mut length) = (0, self.all());
        loop {
            let end = bounces.min(done + SEGMENT);
            recording.clear(&self.room.counters);
            for bounce in done..end {
                length = self.reflect(&mut recording, bounce, &length);
            }
            if end == bounces {
                self.let_escape(&mut recording, end, &length);
                return Ok(recording.run()?);
            }
            recording.run()?;
            options.check_cancelled()?;
            let left = self.room.counters.words(length.at.into(), 1);
            length = Length::known(self.device().read::<u32>(&left)?[0]);
            if length.bound == 0 {
                return Ok(());
            }
            recording = Recording::new(self.device());
            done = end;
        }
    }

    /// Takes paths from their rays to the next ones. Gives how many these are.
    fn reflect(&self, recording: &mut Recording, bounce: u32, length: &Length) -> Length {
        let room = self.room;
        self.find_surfaces(recording, bounce, length);
        let [from, to] = [0, 1].map(|turn| &room.queues[(bounce + turn) as usize % 2]);
        let buffers = [
            &from.rays,
            &room.points,
            &room.paths,
            &room.counters,
            &room.shadow_rays,
            &room.shadows,
            &to.rays,
            &to.ids,
        ];
        self.run(recording, (&SHADE_PATH, length, bounce), &buffers, moved(128, 148));
        self.add_sunlight(recording, bounce % SEGMENT);
        let next = &room.lengths[(bounce % SEGMENT) as usize][0];
        recording.measure(&next.count);
        next.clone()
    }

    /// Finds where rays meet surfaces.
    fn find_surfaces(&self, recording: &mut Recording, bounce: u32, length: &Length) {
        let room = self.room;
        let queue = &room.queues[bounce as usize % 2];
        let rays = length.of(&queue.rays);
        self.tracer.record_closest(recording, &rays, [&room.triangles, &room.hits]);
        let [positions, triangles] = self.tracer.mesh();
        let Looks { normals, palette } = self.looks;
        let buffers = [
            &queue.rays,
            &queue.ids,
            &room.hits,
            positions,
            triangles,
            normals,
            palette,
            &room.points,
        ];
        self.run(recording, (&SURFACE, length, bounce), &buffers, moved(134, 64));
    }

    /// Traces shadow rays and adds their light.
    fn add_sunlight(&self, recording: &mut Recording, turn: u32) {
        let room = self.room;
        let length = &room.lengths[turn as usize][1];
        recording.measure(&length.count);
        self.tracer.record_any(recording, &length.of(&room.shadow_rays), &room.found);
        let buffers = [&room.found, &room.shadows, &room.paths, &room.counters];
        self.run(recording, (&SUNLIGHT, length, 0), &buffers, moved(40, 20));
    }

    /// Adds the light of the sky to paths that nothing is in the way of.
    fn let_escape(&self, recording: &mut Recording, bounce: u32, length: &Length) {
        let room = self.room;
        let queue = &room.queues[bounce as usize % 2];
        self.tracer.record_any(recording, &length.of(&queue.rays), &room.found);
        let buffers = [&room.found, &queue.rays, &queue.ids, &room.paths, &room.counters];
        self.run(recording, (&ESCAPE, length, bounce), &buffers, moved(72, 20));
    }

    /// A recording that begins with the camera rays of all samples.
    fn with_camera_rays(&self) -> Recording<'_> {
        let mut recording = Recording::new(self.device());
        let queue = &self.room.queues[0];
        let buffers = [&queue.rays, &queue.ids];
        self.run(&mut recording, (&CAMERA, &self.all(), 0), &buffers, moved(0, 36));
        recording
    }

    /// Runs a kernel over the elements of a queue, each of which moves so many bytes.
    fn run(
        &self,
        recording: &mut Recording,
        (kernel, length, bounce): (&'static Kernel, &Length, u32),
        buffers: &[&Buffer],
        each: Moved,
    ) {
        let turn = 2 * (bounce % SEGMENT);
        let Length { bound, at, .. } = *length;
        let counters = [turn, turn + 1, 0, 0];
        let params = Params { bound, at, bounce, counters, ..self.params };
        let work = Work::each(&length.count);
        recording.dispatch(kernel, &params, buffers, &work, move |count| Moved {
            read: each.read * count,
            written: each.written * count,
        });
    }

    fn all(&self) -> Length {
        Length::known(self.pixels * self.params.samples_here)
    }

    fn device(&self) -> &Device {
        self.tracer.device()
    }
}
