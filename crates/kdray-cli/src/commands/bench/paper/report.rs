//! Everything that the report says, as JSON has it.

use std::fmt::Write as _;

use kdray_gpu::Device;
use serde::Serialize;
use sysinfo::System;

use super::measure::{self, CpuFigures, GpuFigures};
use super::published::Published;
use super::scenes::{Likeness, Scene};
use crate::arguments;
use crate::commands::info::TreeFigures;

#[derive(Serialize)]
pub(super) struct Report {
    pub(super) version: &'static str,
    pub(super) date: String,
    pub(super) command: String,
    pub(super) machine: Machine,
    pub(super) device: Option<DeviceFigures>,
    pub(super) passes: usize,
    /// The folder of the meshes.
    pub(super) meshes: String,
    pub(super) scenes: Vec<SceneReport>,
}

#[derive(Serialize)]
pub(super) struct Machine {
    pub(super) cpu: String,
    pub(super) threads: usize,
    pub(super) system: String,
}

#[derive(Serialize)]
pub(super) struct DeviceFigures {
    pub(super) adapter: String,
    pub(super) driver: String,
    /// Whether it is a program on the CPU, whose times say nothing of a GPU's.
    pub(super) is_software: bool,
}

#[derive(Serialize)]
pub(super) struct SceneReport {
    pub(super) scene: Scene,
    #[serde(skip)]
    pub(super) title: &'static str,
    pub(super) paper: Published,
    #[serde(flatten)]
    pub(super) outcome: Outcome,
}

#[derive(Serialize)]
#[serde(tag = "status", rename_all = "lowercase")]
pub(super) enum Outcome {
    /// None of the files that would do is there.
    Missing {
        wanted: String,
    },
    Measured(Box<Measured>),
}

#[derive(Serialize)]
pub(super) struct Measured {
    pub(super) mesh: String,
    pub(super) likeness: Likeness,
    /// What the mesh is, if it is not the paper's.
    pub(super) what: &'static str,
    pub(super) tree: TreeFigures,
    pub(super) cpu: CpuFigures,
    pub(super) gpu: Option<GpuFigures>,
    #[serde(skip)]
    pub(super) png: Vec<u8>,
}

impl From<Box<Measured>> for Outcome {
    fn from(measured: Box<Measured>) -> Self {
        Self::Measured(measured)
    }
}

impl Machine {
    /// This machine.
    pub(super) fn now() -> Self {
        let mut system = System::new();
        system.refresh_cpu_all();
        let brand = system.cpus().first().map_or("", |cpu| cpu.brand().trim());
        Self {
            cpu: if brand.is_empty() { "a CPU without a name".into() } else { brand.to_owned() },
            threads: arguments::resolved_threads(0),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

impl DeviceFigures {
    pub(super) fn of(device: &Device) -> Self {
        let adapter = device.adapter();
        Self {
            adapter: adapter.name.clone(),
            driver: adapter.driver.clone(),
            is_software: measure::is_software(device),
        }
    }
}

impl SceneReport {
    pub(super) fn measured(&self) -> Option<&Measured> {
        match &self.outcome {
            Outcome::Measured(measured) => Some(measured),
            Outcome::Missing { .. } => None,
        }
    }
}

impl Report {
    /// The scenes that there are figures of.
    pub(super) fn measured(&self) -> impl Iterator<Item = (&SceneReport, &Measured)> {
        self.scenes.iter().filter_map(|scene| Some((scene, scene.measured()?)))
    }

    /// The scenes that were built on the device.
    pub(super) fn on_gpu(&self) -> impl Iterator<Item = (&SceneReport, &GpuFigures)> {
        self.measured().filter_map(|(scene, measured)| Some((scene, measured.gpu.as_ref()?)))
    }

    /// The scenes by line, for the terminal.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        for scene in &self.scenes {
            let title = scene.title;
            let line = match &scene.outcome {
                Outcome::Missing { wanted } => format!("missing: no {wanted} in {}", self.meshes),
                Outcome::Measured(measured) => {
                    let CpuFigures { build_s, trace_s, .. } = measured.cpu;
                    let on_cpu = format!("built in {build_s:.3} s, traced in {trace_s:.3} s");
                    let on_gpu = measured.gpu.as_ref().map_or_else(String::new, |gpu| {
                        format!("; on the GPU {:.3} s, {:.3} s", gpu.build_s, gpu.trace_s)
                    });
                    on_cpu + &on_gpu
                }
            };
            let _ = writeln!(text, "{title:12}{line}");
        }
        text
    }
}
