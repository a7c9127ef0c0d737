//! `kdray devices`: what this machine can build and trace on.

use std::process::ExitCode;

use clap::Args;
use kdray_gpu::Adapter;
use serde::Serialize;

use crate::sizes::{bytes, count};
use crate::{arguments, output};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) json: arguments::Json,
}

#[derive(Serialize)]
struct Report {
    cpu: Cpu,
    gpus: Vec<Gpu>,
}

#[derive(Serialize)]
struct Cpu {
    threads: usize,
}

/// An adapter, with the limits that decide how large a mesh can be.
#[derive(Serialize)]
struct Gpu {
    index: usize,
    name: String,
    backend: String,
    driver: String,
    kind: String,
    buffer_bytes: u64,
    binding_bytes: u64,
    storage_buffers: u32,
    workgroup_bytes: u32,
    invocations: u32,
    workgroups: u32,
}

impl From<Adapter> for Gpu {
    fn from(adapter: Adapter) -> Self {
        let Adapter { index, name, backend, driver, kind, limits } = adapter;
        Self {
            index,
            name,
            backend,
            driver,
            kind: kind.to_string(),
            buffer_bytes: limits.buffer_bytes,
            binding_bytes: limits.binding_bytes,
            storage_buffers: limits.storage_buffers,
            workgroup_bytes: limits.workgroup_bytes,
            invocations: limits.invocations,
            workgroups: limits.workgroups,
        }
    }
}

impl Gpu {
    fn text(&self) -> String {
        let rows = [
            ("  driver", format!("{}, through {}", self.driver, self.backend)),
            ("  kind", self.kind.clone()),
            (
                "  buffers",
                format!(
                    "{}, {} of them bound, {} a kernel",
                    bytes(self.buffer_bytes),
                    bytes(self.binding_bytes),
                    self.storage_buffers
                ),
            ),
            (
                "  workgroups",
                format!(
                    "{} in a row, {} invocations, {} shared",
                    count(self.workgroups as usize),
                    self.invocations,
                    bytes(self.workgroup_bytes.into())
                ),
            ),
        ];
        format!("gpu {}: {}\n{}", self.index, self.name, output::table(&rows))
    }
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let report = Report {
        cpu: Cpu { threads: arguments::resolved_threads(0) },
        gpus: kdray_gpu::devices().into_iter().map(Gpu::from).collect(),
    };
    let mut text = format!("cpu: {} threads\n", report.cpu.threads);
    if report.gpus.is_empty() {
        text += "no gpu\n";
    }
    text.extend(report.gpus.iter().map(Gpu::text));
    output::print(arguments.json.json, &report, &text)?;
    Ok(ExitCode::SUCCESS)
}
