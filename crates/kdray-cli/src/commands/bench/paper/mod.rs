//! `kdray bench paper`: the paper's scenes, tables and figures, as kdray has them \[WZL11].

mod charts;
mod figures;
mod measure;
mod page;
mod picture;
mod published;
mod report;
mod scenes;
mod tables;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use kdray_gpu::Device;

use crate::commands::info::TreeFigures;
use crate::device::Choice;
use crate::progress::Progress;
use crate::{arguments, atomic, cancel, input, output};
use measure::Plan;
use report::{DeviceFigures, Machine, Measured, Outcome, Report, SceneReport};
use scenes::Scene;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Where trees are built beside the CPU: `cpu` for nowhere, `gpu` for the best GPU, `auto` for a
    /// real one if there is any, or the index or a part of the name of a device in `kdray devices`
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = Choice::parse)]
    device: Choice,
    /// The scenes [default: all eight]
    #[arg(long, value_name = "SCENE,…", value_enum, value_delimiter = ',')]
    scenes: Vec<Scene>,
    /// The folder of the meshes
    #[arg(long, value_name = "FOLDER", default_value = "../shared/meshes")]
    meshes: PathBuf,
    /// How often everything is measured; the best pass counts
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = arguments::at_least_one)]
    passes: usize,
    /// The report, one HTML file that needs no other
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    output: PathBuf,
    /// Print all figures as one JSON object on standard output, or write them to FILE
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
}

impl Arguments {
    /// Whether standard output is for JSON.
    pub(crate) fn prints_json(&self) -> bool {
        self.json.as_deref() == Some(Path::new("-"))
    }

    /// The file for JSON.
    fn json_file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|_| !self.prints_json())
    }
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let cancel = cancel::flag()?;
    for target in [Some(&*arguments.output), arguments.json_file()].into_iter().flatten() {
        atomic::check_writable(target)?;
    }
    let device = arguments.device.open()?;
    let plan = Plan { passes: arguments.passes, device: device.as_ref(), cancel };
    let machine = Machine::now();
    let asked = |scene: &Scene| arguments.scenes.is_empty() || arguments.scenes.contains(scene);
    let scenes = Scene::ALL.into_iter().filter(asked);
    let scenes = scenes.map(|scene| self::scene(scene, &arguments.meshes, &plan));
    let scenes = scenes.collect::<anyhow::Result<Vec<_>>>()?;
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        date: jiff::Zoned::now().date().to_string(),
        command: command(),
        machine,
        device: device.as_ref().map(DeviceFigures::of),
        passes: arguments.passes,
        meshes: arguments.meshes.display().to_string(),
        scenes,
    };
    let page = page::html(&report)?;
    atomic::write(&arguments.output, |file, _| Ok(file.write_all(page.as_bytes())?))?;
    if let Some(target) = arguments.json_file() {
        atomic::write(target, |file, _| Ok(serde_json::to_writer_pretty(file, &report)?))?;
    }
    let text = format!("{}{}\n", report.text(), arguments.output.display());
    output::print(arguments.prints_json(), &report, &text)?;
    Ok(ExitCode::SUCCESS)
}

/// The command line that makes this report again.
fn command() -> String {
    let arguments = std::env::args()
        .skip(1)
        .map(|word| if word.contains(char::is_whitespace) { format!("'{word}'") } else { word });
    std::iter::once("kdray".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

fn scene(scene: Scene, folder: &Path, plan: &Plan) -> anyhow::Result<SceneReport> {
    let outcome = match scenes::find(scene, folder) {
        Some((candidate, path)) => measured(scene, candidate, &path, plan).map(Box::new)?.into(),
        None => Outcome::Missing { wanted: scenes::wanted(scene) },
    };
    Ok(SceneReport { scene, title: scene.title(), paper: scene.published(), outcome })
}

fn measured(
    scene: Scene,
    candidate: &scenes::Candidate,
    path: &Path,
    plan: &Plan,
) -> anyhow::Result<Measured> {
    let progress = Progress::new(scene.title());
    let mesh = input::mesh(path, &arguments::Repair { drop_non_finite: false })?;
    let camera = picture::camera(&mesh, scene.view(), candidate.up);
    let (tree, cpu) = measure::cpu(&mesh, &camera, plan, &progress)?;
    let gpu = |device: &Device| measure::gpu((&mesh, &camera), device, &tree, plan, &progress);
    let gpu = plan.device.map(gpu).transpose()?;
    let png = picture::png(&mesh, &tree, &camera, scene.view(), &progress, plan.cancel)?;
    Ok(Measured {
        mesh: path.display().to_string(),
        likeness: candidate.likeness,
        what: candidate.what,
        tree: TreeFigures::of(&tree),
        cpu,
        gpu,
        png,
    })
}
