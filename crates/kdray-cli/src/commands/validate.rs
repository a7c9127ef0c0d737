//! `kdray validate`: proves a tree file.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use serde::Serialize;

use crate::{arguments, input, output};

#[derive(Args)]
pub(crate) struct Arguments {
    /// The tree file
    #[arg(value_name = "FILE")]
    tree: PathBuf,
    #[command(flatten)]
    mesh: arguments::Mesh,
    #[command(flatten)]
    pub(crate) json: arguments::Json,
}

#[derive(Serialize)]
struct Report {
    file: String,
    mesh: String,
    valid: bool,
    /// The first thing that is wrong.
    violation: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let tree = input::tree(&arguments.tree)?;
    let mesh = input::mesh(&arguments.mesh.path, &arguments.mesh.repair)?;
    let violation = tree.validate(&mesh).err().map(|violation| violation.to_string());
    let report = Report {
        file: arguments.tree.display().to_string(),
        mesh: arguments.mesh.path.display().to_string(),
        valid: violation.is_none(),
        violation,
    };
    output::print(arguments.json.json, &report, &report.text())?;
    Ok(if report.valid { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

impl Report {
    fn text(&self) -> String {
        match &self.violation {
            None => format!("{}: a kd-tree of {}", self.file, self.mesh),
            Some(violation) => format!("{}: violation: {violation}", self.file),
        }
    }
}
