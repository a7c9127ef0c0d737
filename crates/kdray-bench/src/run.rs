//! A whole definition: what is missing, then one scene after another.

use std::path::Path;

use anyhow::{Result, bail};
use indicatif::{ProgressBar, ProgressStyle};
use kdray::Mesh;

use crate::definition::{Definition, SceneDefinition};
use crate::engines::Engines;
use crate::record::Comparison;
use crate::scene::{self, Bench, Present};

/// What a run needs besides its definition.
pub(crate) struct Setting<'a> {
    /// Where mesh files are.
    pub(crate) meshes: Option<&'a Path>,
    /// Embree's shared library.
    pub(crate) embree: Option<&'a Path>,
    /// Numbers of threads to build and trace with, ascending.
    pub(crate) threads: &'a [usize],
    /// Goes on without engines and scenes that are not there.
    pub(crate) allow_missing: bool,
}

/// Measures everything the definition names.
///
/// Missing engines and meshes are an error that lists them all, before anything is measured,
/// unless they are allowed to be missing; then the record lists them.
pub(crate) fn run(definition: &Definition, setting: &Setting) -> Result<Comparison> {
    let (engines, mut missing) = engines(definition, setting);
    let scenes = scenes(definition, setting, &mut missing);
    if !missing.is_empty() && !setting.allow_missing {
        bail!("{}\n(--allow-missing goes on without)", missing.join("\n"));
    }
    let progress = progress(definition, setting, &scenes, &engines);
    let bench = Bench { definition, threads: setting.threads, progress: &progress };
    let mut records = Vec::new();
    for (scene, mesh) in &scenes {
        progress.set_prefix(scene.name.clone());
        records.push(bench.measure(scene, mesh, &engines)?);
    }
    progress.finish_and_clear();
    Ok(Comparison {
        baseline: definition.baseline.clone(),
        resolution: definition.resolution,
        hits_from: "kdray, default options".to_owned(),
        scenes: records,
        missing,
    })
}

fn engines<'a>(definition: &'a Definition, setting: &Setting) -> (Vec<Present<'a>>, Vec<String>) {
    let engines = Engines::new(setting.embree);
    let (mut present, mut missing) = (Vec::new(), Vec::new());
    for engine in &definition.engines {
        match engines.make(engine) {
            Ok(made) => present.push((engine, made)),
            Err(error) => missing.push(format!("{error:#}")),
        }
    }
    (present, missing)
}

fn scenes<'a>(
    definition: &'a Definition,
    setting: &Setting,
    missing: &mut Vec<String>,
) -> Vec<(&'a SceneDefinition, Mesh)> {
    let mut present = Vec::new();
    for scene in &definition.scenes {
        match scene::load(&scene.source, setting.meshes) {
            Ok(mesh) => present.push((scene, mesh)),
            Err(error) => missing.push(format!("scene {} is missing: {error:#}", scene.name)),
        }
    }
    present
}

fn progress(
    definition: &Definition,
    setting: &Setting,
    scenes: &[(&SceneDefinition, Mesh)],
    engines: &[Present],
) -> ProgressBar {
    let steps: usize = scenes.iter().map(|(scene, _)| steps(definition, scene, engines)).sum();
    let style = ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len} {msg} {elapsed}");
    let style = style.expect("the template is well formed");
    ProgressBar::new((steps * setting.threads.len()) as u64).with_style(style)
}

/// Builds and traces on one number of threads.
fn steps(definition: &Definition, scene: &SceneDefinition, engines: &[Present]) -> usize {
    let taking_part = engines.iter().filter(|(engine, _)| !scene.exclude.contains(&engine.name));
    let traces = definition.trace_passes * scene.rays.len();
    taking_part.map(|(engine, _)| definition.build_passes + 1 + traces * engine.modes.len()).sum()
}
