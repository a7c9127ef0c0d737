//! Recordings are encoded, submitted and measured.

use std::num::NonZeroU64;

use super::clock::Clock;
use super::count::Grid;
use super::kernel::Binding;
use super::profile::Profile;
use super::recording::{Dispatch, Recording, Step};
use crate::device::{Buffer, lock};
use crate::error::GpuError;

/// Bytes that parameters are given at least.
const LEAST_PARAMETERS: usize = 1 << 14;

impl Recording<'_> {
    /// Submits the work, all dispatches in as few passes as there can be, and does not wait for it.
    ///
    /// # Errors
    ///
    /// If a kernel does not compile, or the device failed before.
    pub fn run(&self) -> Result<(), GpuError> {
        let params = self.parameters();
        let ready = self.prepare(&params)?;
        let mut encoder = self.device.raw.create_command_encoder(&Default::default());
        let mut steps = ready.iter().peekable();
        while let Some((step, _)) = steps.peek() {
            if let Step::Dispatch(_) = step {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                pass.set_bind_group(1, &self.device.zero.group, &[]);
                let in_pass = |(step, _): &&(&Step, _)| matches!(step, Step::Dispatch(_));
                while let Some((Step::Dispatch(dispatch), Some(program))) = steps.next_if(in_pass) {
                    program.encode(dispatch, &mut pass);
                }
            } else if let Some((step, _)) = steps.next() {
                encode_transfer(step, &mut encoder);
            }
        }
        self.device.queue.submit([encoder.finish()]);
        // Whoever writes to it next does so after this work.
        *lock(&self.device.parameters) = Some(params);
        self.device.check()
    }

    /// Does the work, a pass a dispatch, and says what it cost.
    ///
    /// Passes of their own, and the copies of counts between them, make this slower than
    /// [`Recording::run`]; the times are those of the dispatches alone.
    ///
    /// # Errors
    ///
    /// As [`Recording::run`], and if the device has no memory for the measurements.
    pub fn profile(&self) -> Result<Profile, GpuError> {
        let ready = self.prepare(&self.parameters())?;
        let dispatches = self.dispatches().count() as u32;
        let counts = self.device.buffer("counts", dispatches.into())?;
        let clock = Clock::new(self.device, dispatches)?;
        let mut encoder = self.device.raw.create_command_encoder(&Default::default());
        let mut index = 0;
        for (step, program) in &ready {
            let (Step::Dispatch(dispatch), Some(program)) = (step, program) else {
                encode_transfer(step, &mut encoder);
                continue;
            };
            if let Some(word) = dispatch.count.word() {
                copy(&word, &counts.words(u64::from(index), 1), &mut encoder);
            }
            let timestamp_writes = clock.as_ref().map(|clock| clock.around(index));
            let label = Some(dispatch.kernel.name);
            let descriptor = wgpu::ComputePassDescriptor { label, timestamp_writes };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            pass.set_bind_group(1, &self.device.zero.group, &[]);
            program.encode(dispatch, &mut pass);
            index += 1;
        }
        if let Some(clock) = &clock {
            clock.resolve(&mut encoder);
        }
        self.device.queue.submit([encoder.finish()]);
        self.summarize(&self.device.read(&counts)?, clock.as_ref())
    }

    fn summarize(&self, counts: &[u32], clock: Option<&Clock>) -> Result<Profile, GpuError> {
        let seconds = clock.map(Clock::seconds).transpose()?;
        let mut profile = Profile::default();
        for (index, dispatch) in self.dispatches().enumerate() {
            let is_live = dispatch.count.word().is_some();
            let word = if is_live { counts[index] } else { u32::MAX };
            let count = dispatch.count.elements(word);
            let seconds = seconds.as_ref().map_or(0.0, |seconds| seconds[index]);
            profile.add(dispatch.stage, (dispatch.moved)(count.into()), seconds);
        }
        Ok(profile)
    }

    fn dispatches(&self) -> impl Iterator<Item = &Dispatch> {
        self.steps.iter().filter_map(|step| match step {
            Step::Dispatch(dispatch) => Some(dispatch),
            _ => None,
        })
    }

    /// The parameters, in the memory of an earlier recording's if that is large enough.
    fn parameters(&self) -> wgpu::Buffer {
        let size = self.params.len().next_power_of_two().max(LEAST_PARAMETERS) as u64;
        let kept = lock(&self.device.parameters).take().filter(|kept| kept.size() >= size);
        let params = kept.unwrap_or_else(|| {
            self.device.raw.create_buffer(&wgpu::BufferDescriptor {
                label: Some("parameters"),
                size,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        });
        self.device.bring(&params, 0, &self.params);
        params
    }

    /// Compiles and binds every dispatch.
    fn prepare(&self, params: &wgpu::Buffer) -> Result<Vec<(&Step, Option<Program>)>, GpuError> {
        let mut ready = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let program = match step {
                Step::Dispatch(dispatch) => Some(Program::new(self, dispatch, params)?),
                _ => None,
            };
            ready.push((step, program));
        }
        Ok(ready)
    }
}

/// A dispatch, compiled and bound.
struct Program {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

impl Program {
    fn new(
        recording: &Recording,
        dispatch: &Dispatch,
        params: &wgpu::Buffer,
    ) -> Result<Self, GpuError> {
        let Dispatch { kernel, buffers, params: (offset, size), .. } = dispatch;
        let pipeline = recording.device.pipeline(kernel)?;
        let size = NonZeroU64::new(*size);
        let params = wgpu::BufferBinding { buffer: params, offset: *offset, size };
        let mut buffers = buffers.iter();
        let resource = |binding: &Binding| match binding {
            Binding::Uniform => Some(wgpu::BindingResource::Buffer(params.clone())),
            _ => buffers.next().map(Buffer::binding),
        };
        let resources = kernel.bindings.iter().filter_map(resource).enumerate();
        let entry = |(index, resource)| wgpu::BindGroupEntry { binding: index as u32, resource };
        let entries: Vec<_> = resources.map(entry).collect();
        let group = recording.device.raw.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(kernel.name),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Ok(Self { pipeline, group })
    }

    fn encode(&self, dispatch: &Dispatch, pass: &mut wgpu::ComputePass) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        match &dispatch.grid {
            Grid::Known([x, y, z]) => pass.dispatch_workgroups(*x, *y, *z),
            Grid::Live(words) => {
                pass.dispatch_workgroups_indirect(words.raw(), words.offset_bytes());
            }
        }
    }
}

fn encode_transfer(step: &Step, encoder: &mut wgpu::CommandEncoder) {
    match step {
        Step::Dispatch(_) => {}
        Step::Clear(buffer) => {
            let size = Some(buffer.size_bytes());
            encoder.clear_buffer(buffer.raw(), buffer.offset_bytes(), size);
        }
        Step::Copy { from, to } => copy(from, to, encoder),
    }
}

fn copy(from: &Buffer, to: &Buffer, encoder: &mut wgpu::CommandEncoder) {
    let [start, end] = [from.offset_bytes(), to.offset_bytes()];
    encoder.copy_buffer_to_buffer(from.raw(), start, to.raw(), end, from.size_bytes());
}
