//! Where the work is done: on the CPU, or on a GPU of the machine.

use std::convert::Infallible;

use anyhow::Context;
use kdray::{Hit, Ray};
use kdray_gpu::{Device, Kind, Selection, TraceOptions, Tracer};
use kdray_render::{Caster, CasterError};

/// What `--device` says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    Cpu,
    /// A real GPU, or else the CPU.
    Auto,
    Gpu(Selection),
}

impl Choice {
    pub(crate) fn parse(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "cpu" => Self::Cpu,
            "auto" => Self::Auto,
            _ => Self::Gpu(text.parse()?),
        })
    }

    /// The device, or `None` for the CPU.
    pub(crate) fn open(&self) -> anyhow::Result<Option<Device>> {
        let selection = match self {
            Self::Cpu => return Ok(None),
            Self::Auto => {
                let real = |adapter: &kdray_gpu::Adapter| adapter.kind != Kind::Software;
                if !kdray_gpu::devices().iter().any(real) {
                    return Ok(None);
                }
                Selection::Best
            }
            Self::Gpu(selection) => selection.clone(),
        };
        let device = Device::open_with_large_buffers(&selection);
        device.context("cannot work on the GPU; --device cpu always can").map(Some)
    }
}

/// Traces the rays of pictures on a device.
pub(crate) struct OnDevice<'a>(pub(crate) Tracer<'a>);

impl Caster for OnDevice<'_> {
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<(), CasterError> {
        Ok(self.0.batch(TraceOptions::default()).closest_hits(rays, hits)?)
    }

    fn any_hits(&self, rays: &[Ray], found: &mut [bool]) -> Result<(), CasterError> {
        Ok(self.0.batch(TraceOptions::default()).any_hits(rays, found)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_are_read_from_words() {
        let read = |text| Choice::parse(text).expect("every word is a choice");
        assert_eq!([read("cpu"), read("auto")], [Choice::Cpu, Choice::Auto]);
        assert_eq!(read("gpu"), Choice::Gpu(Selection::Best));
        assert_eq!(read("2"), Choice::Gpu(Selection::Index(2)));
    }
}
