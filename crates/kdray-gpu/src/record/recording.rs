//! A list of work, made before the device sees any of it.

use std::fmt;

use super::count::{Count, Grid, Work};
use super::kernel::{Binding, Kernel};
use crate::device::{Buffer, Device};

/// Where the parameters of a dispatch may start.
const PARAMS_ALIGNMENT: usize = 256;

/// Work for a device, in order. Each step sees what the steps before it wrote.
#[derive(Debug)]
pub struct Recording<'a> {
    pub(super) device: &'a Device,
    pub(super) steps: Vec<Step>,
    /// Parameters of all dispatches.
    pub(super) params: Vec<u8>,
    stage: (&'static str, u32),
}

/// Bytes that a dispatch reads and writes in buffers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moved {
    /// Bytes that it reads.
    pub read: u64,
    /// Bytes that it writes.
    pub written: u64,
}

#[derive(Debug)]
pub(super) enum Step {
    Dispatch(Dispatch),
    Clear(Buffer),
    Copy { from: Buffer, to: Buffer },
}

pub(super) struct Dispatch {
    pub(super) stage: (&'static str, u32),
    pub(super) kernel: &'static Kernel,
    /// Place and size of its parameters among those of all.
    pub(super) params: (u64, u64),
    pub(super) buffers: Vec<Buffer>,
    pub(super) count: Count,
    pub(super) grid: Grid,
    pub(super) moved: Box<dyn Fn(u64) -> Moved>,
}

impl fmt::Debug for Dispatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {:?} over {:?}", self.kernel.name, self.stage, self.grid)
    }
}

impl<'a> Recording<'a> {
    /// Nothing to do yet, in a stage without a name.
    #[must_use]
    pub fn new(device: &'a Device) -> Self {
        Self { device, steps: Vec::new(), params: Vec::new(), stage: ("", 0) }
    }

    /// The device that it is for.
    #[must_use]
    pub fn device(&self) -> &'a Device {
        self.device
    }

    /// What follows belongs to this stage and level of the tree.
    pub fn stage(&mut self, name: &'static str, level: u32) {
        self.stage = (name, level);
    }

    /// Runs `kernel` over `work`. `params` are its uniform, if it has one, and `buffers` its other
    /// bindings in order. `moved` says what it moves for a number of elements.
    ///
    /// # Panics
    ///
    /// If `buffers` are more or fewer than the kernel's bindings.
    pub fn dispatch(
        &mut self,
        kernel: &'static Kernel,
        params: &impl bytemuck::NoUninit,
        buffers: &[&Buffer],
        work: &Work,
        moved: impl Fn(u64) -> Moved + 'static,
    ) {
        let storage = kernel.bindings.iter().filter(|&&binding| binding != Binding::Uniform);
        assert_eq!(storage.count(), buffers.len(), "bindings of {}", kernel.name);
        let params = self.keep(bytemuck::bytes_of(params));
        self.steps.push(Step::Dispatch(Dispatch {
            stage: self.stage,
            kernel,
            params,
            buffers: buffers.iter().map(|&buffer| buffer.clone()).collect(),
            count: work.count.clone(),
            grid: work.grid(),
            moved: Box::new(moved),
        }));
    }

    /// Fills `buffer` with zeros.
    pub fn clear(&mut self, buffer: &Buffer) {
        self.steps.push(Step::Clear(buffer.clone()));
    }

    /// Copies all of `from` to the start of `to`, which is another buffer.
    pub fn copy(&mut self, from: &Buffer, to: &Buffer) {
        self.steps.push(Step::Copy { from: from.clone(), to: to.clone() });
    }

    fn keep(&mut self, params: &[u8]) -> (u64, u64) {
        let start = self.params.len().next_multiple_of(PARAMS_ALIGNMENT);
        self.params.resize(start, 0);
        self.params.extend_from_slice(params);
        (start as u64, params.len() as u64)
    }
}
