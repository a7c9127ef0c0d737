//! What GPUs there are.

use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

use super::limits::Limits;
use crate::error::GpuError;

/// A GPU, or a program that stands in for one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// Its place in the list.
    pub index: usize,
    /// Its name, as the driver gives it.
    pub name: String,
    /// Vulkan, Metal or Direct3D 12.
    pub backend: String,
    /// Name and version of the driver.
    pub driver: String,
    /// What it is made of.
    pub kind: Kind,
    /// The most that a device on it may be asked for.
    pub limits: Limits,
}

/// What an adapter is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A card with memory of its own.
    Discrete,
    /// A part of the processor.
    Integrated,
    /// A share of a card, in a virtual machine.
    Virtual,
    /// The driver does not say.
    Other,
    /// A program on the processor.
    Software,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Discrete => "discrete",
            Self::Integrated => "integrated",
            Self::Virtual => "virtual",
            Self::Other => "other",
            Self::Software => "software",
        })
    }
}

/// Which adapter to take.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// The first of the best kind: discrete, integrated, virtual, other, software.
    #[default]
    Best,
    /// By its place in the list.
    Index(usize),
    /// By a part of its name, in letters of either case. Only one may have it.
    Name(String),
}

impl FromStr for Selection {
    type Err = Infallible;

    /// `gpu` is the best, a number an index, and everything else a name.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.parse() {
            Ok(index) => Self::Index(index),
            Err(_) if text == "gpu" => Self::Best,
            Err(_) => Self::Name(text.to_owned()),
        })
    }
}

/// All adapters of the machine, in the order of the drivers. There may be none.
#[must_use]
pub fn devices() -> Vec<Adapter> {
    all().into_iter().map(|(adapter, _)| adapter).collect()
}

/// The adapter that `selection` means.
pub(super) fn select(selection: &Selection) -> Result<(Adapter, wgpu::Adapter), GpuError> {
    let adapters = all();
    if adapters.is_empty() {
        let backends = format!("{:?}", wgpu::Instance::enabled_backend_features());
        return Err(GpuError::NoAdapter { backends });
    }
    let unknown = |name: String| {
        let known =
            adapters.iter().map(|(adapter, _)| format!("{} {}", adapter.index, adapter.name));
        GpuError::UnknownAdapter { name, known: known.collect::<Vec<_>>().join(", ") }
    };
    let index = match selection {
        Selection::Best => {
            adapters.iter().min_by_key(|(adapter, _)| adapter.kind).map(|a| a.0.index)
        }
        Selection::Index(index) => Some(*index),
        Selection::Name(name) => only_with_name(&adapters, name),
    };
    let found = index.and_then(|index| adapters.get(index).cloned());
    found.ok_or_else(|| match selection {
        Selection::Best => unknown("gpu".to_owned()),
        Selection::Index(index) => unknown(index.to_string()),
        Selection::Name(name) => unknown(name.clone()),
    })
}

/// Index of the adapter whose name has `part` in it, if there is just one.
fn only_with_name(adapters: &[(Adapter, wgpu::Adapter)], part: &str) -> Option<usize> {
    let part = part.to_lowercase();
    let has_part = |adapter: &Adapter| adapter.name.to_lowercase().contains(&part);
    let mut found = adapters.iter().map(|(adapter, _)| adapter).filter(|adapter| has_part(adapter));
    match (found.next(), found.next()) {
        (Some(adapter), None) => Some(adapter.index),
        _ => None,
    }
}

fn all() -> Vec<(Adapter, wgpu::Adapter)> {
    let mut options = wgpu::InstanceDescriptor::new_without_display_handle();
    // Kernels of our own write the arguments of indirect dispatches, within the limits; checking
    // them again costs a dispatch each.
    options.flags.remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
    let backends = wgpu::Instance::enabled_backend_features();
    let instance = wgpu::Instance::new(options);
    let adapters = pollster::block_on(instance.enumerate_adapters(backends));
    let described = |(index, adapter)| (describe(index, &adapter), adapter);
    adapters.into_iter().enumerate().map(described).collect()
}

fn describe(index: usize, adapter: &wgpu::Adapter) -> Adapter {
    let info = adapter.get_info();
    Adapter {
        index,
        name: info.name,
        backend: info.backend.to_string(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => Kind::Discrete,
            wgpu::DeviceType::IntegratedGpu => Kind::Integrated,
            wgpu::DeviceType::VirtualGpu => Kind::Virtual,
            wgpu::DeviceType::Other => Kind::Other,
            wgpu::DeviceType::Cpu => Kind::Software,
        },
        limits: Limits::of(&adapter.limits()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selections_are_read_from_words() {
        let read = |text: &str| text.parse::<Selection>().unwrap();
        assert_eq!(read("gpu"), Selection::Best);
        assert_eq!(read("1"), Selection::Index(1));
        assert_eq!(read("llvmpipe"), Selection::Name("llvmpipe".to_owned()));
    }

    #[test]
    fn a_real_gpu_is_better_than_a_program() {
        assert!(Kind::Discrete < Kind::Integrated && Kind::Other < Kind::Software);
    }
}
