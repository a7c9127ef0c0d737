//! Kernels: a WGSL entry point each, compiled once a device.

use super::count::Work;
use super::recording::{Moved, Recording};
use crate::device::{Device, lock};
use crate::error::GpuError;
use crate::float::Floats;
use crate::wgsl;

/// Invocations of a workgroup.
pub const WORKGROUP: u32 = 256;

/// Invocations of a workgroup that works on one element.
///
/// As wide as the vectors of processors: on lavapipe 32 took 1.3 times as long. GPUs run 32 and more
/// in step, and may want as many.
pub const TEAM: u32 = 8;

/// A WGSL entry point.
#[derive(Debug)]
pub struct Kernel {
    /// Name of its entry point and of its file.
    pub name: &'static str,
    /// Its text, in which a line `//#import x` stands for a part that [`wgsl`] names.
    pub source: &'static str,
    /// What it binds, in order, in group 0.
    pub bindings: &'static [Binding],
}

/// What a kernel may do to a binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// Read the parameters of the dispatch.
    Uniform,
    /// Read a buffer.
    Read,
    /// Read and write a buffer.
    Write,
}

impl Kernel {
    /// Kernels of different crates may share a name, but not a text. A kernel that is a constant has its
    /// text in several places.
    fn key(&self) -> [&'static str; 2] {
        [self.name, self.source]
    }
}

impl Binding {
    pub(crate) fn layout(self) -> wgpu::BindingType {
        let ty = match self {
            Self::Uniform => wgpu::BufferBindingType::Uniform,
            Self::Read => wgpu::BufferBindingType::Storage { read_only: true },
            Self::Write => wgpu::BufferBindingType::Storage { read_only: false },
        };
        wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
    }
}

/// Words that stand for whatever a kernel binds while nothing is done.
const NOTHING: usize = 256;

/// The most that a kernel binds.
const BINDINGS: u64 = 9;

impl Device {
    /// Compiles `kernels`, which would otherwise happen when they first run.
    ///
    /// Some drivers leave most of it to the first dispatch, so each gets one, of no workgroups.
    ///
    /// # Errors
    ///
    /// If a kernel is refused, or the device fails.
    pub fn compile(&self, kernels: &[&'static Kernel]) -> Result<(), GpuError> {
        let is_new = |kernel: &&&Kernel| !lock(&self.pipelines).contains_key(&kernel.key());
        let kernels: Vec<_> = kernels.iter().filter(is_new).collect();
        if kernels.is_empty() {
            return Ok(());
        }
        let words = NOTHING as u64;
        let read = self.buffer("nothing to read", words)?;
        let written = self.buffer("nothing to write", words * BINDINGS)?;
        let mut recording = Recording::new(self);
        for kernel in kernels {
            let buffer = |(index, binding)| match binding {
                &Binding::Uniform => None,
                Binding::Read => Some(read.clone()),
                Binding::Write => Some(written.words(words * index, words)),
            };
            let buffers: Vec<_> = (0..).zip(kernel.bindings).filter_map(buffer).collect();
            let buffers: Vec<_> = buffers.iter().collect();
            let work = Work::groups(0);
            recording.dispatch(kernel, &[0_u32; NOTHING], &buffers, &work, |_| Moved::default());
        }
        recording.run()?;
        self.wait()
    }

    /// The kernel, compiled for this device the first time that it is asked for.
    pub(crate) fn pipeline(&self, kernel: &Kernel) -> Result<wgpu::ComputePipeline, GpuError> {
        let key = kernel.key();
        if let Some(pipeline) = lock(&self.pipelines).get(&key) {
            return Ok(pipeline.clone());
        }
        // The probes that find out the form of floats have none.
        let has_floats = wgsl::has_floats(kernel.source);
        let floats = if has_floats { self.floats()? } else { Floats::Soft };
        let source = wgsl::compose(kernel.source, floats);
        let pipeline = self.compile_source(kernel, &source)?;
        lock(&self.pipelines).insert(key, pipeline.clone());
        Ok(pipeline)
    }

    /// Compiles `source`, which has its imports, as `kernel`.
    fn compile_source(
        &self,
        kernel: &Kernel,
        source: &str,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let scope = self.raw.push_error_scope(wgpu::ErrorFilter::Validation);
        let pipeline = self.create_pipeline(kernel, source);
        match pollster::block_on(scope.pop()) {
            Some(error) => {
                let what = format!("the kernel {}", kernel.name);
                Err(GpuError::Driver { what, reason: error.to_string() })
            }
            None => self.check().map(|()| pipeline),
        }
    }

    fn create_pipeline(&self, kernel: &Kernel, source: &str) -> wgpu::ComputePipeline {
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(kernel.name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        };
        let checks = wgpu::ShaderRuntimeChecks { force_loop_bounding: false, ..Default::default() };
        // SAFETY: the check that is left out bounds loops that do not end. Every loop of our
        // kernels counts to a bound. Indices stay checked.
        let module = unsafe { self.raw.create_shader_module_trusted(descriptor, checks) };
        let groups = [Some(&self.layout(kernel.bindings)), Some(&self.zero.layout)];
        let layout = self.raw.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(kernel.name),
            bind_group_layouts: &groups,
            ..Default::default()
        });
        self.raw.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(kernel.name),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(kernel.name),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        })
    }

    fn layout(&self, bindings: &[Binding]) -> wgpu::BindGroupLayout {
        let entry = |(index, binding): (usize, &Binding)| wgpu::BindGroupLayoutEntry {
            binding: index as u32,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: binding.layout(),
            count: None,
        };
        let entries: Vec<_> = bindings.iter().enumerate().map(entry).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        self.raw.create_bind_group_layout(&descriptor)
    }
}
