//! Where the work is done: on the CPU, or on a GPU of the machine.

use std::convert::Infallible;

use anyhow::Context;
use kdray::Tree;
use kdray_gpu::{Device, Kind, Selection, Tracer};
use kdray_render::gpu::RenderError;

/// What `--device` says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    Cpu,
    /// A real GPU, or else the CPU.
    Auto,
    Gpu(Selection),
}

/// Where a tree is: it stays where it was built.
pub(crate) enum Place<'a> {
    Cpu(Tree),
    Gpu(Tracer<'a>),
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

/// What is said of a picture that a device did not make.
pub(crate) fn no_picture(error: RenderError) -> anyhow::Error {
    match error {
        RenderError::Cancelled(cancelled) => cancelled.into(),
        RenderError::Gpu(error) => error.into(),
        RenderError::Cost => anyhow::anyhow!("{error}"),
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
