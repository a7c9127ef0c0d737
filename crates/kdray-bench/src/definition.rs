//! What to measure, read from a TOML file in `bench/definitions`.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};

/// Scenes, engines and passes of one benchmark.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Definition {
    /// Side of the square camera images in pixels: a multiple of the tile side.
    pub(crate) resolution: u32,
    /// Timed builds of each engine.
    pub(crate) build_passes: usize,
    /// Timed traces of each ray set by each engine.
    pub(crate) trace_passes: usize,
    /// The engine that ratios refer to, and whose hits the others are checked against.
    pub(crate) baseline: String,
    /// What is traced, in order.
    #[serde(rename = "scene")]
    pub(crate) scenes: Vec<SceneDefinition>,
    /// Who traces it, in order.
    #[serde(rename = "engine")]
    pub(crate) engines: Vec<EngineDefinition>,
}

/// A mesh and the rays sent into it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SceneDefinition {
    pub(crate) name: String,
    pub(crate) source: Source,
    pub(crate) rays: Vec<RaySet>,
    /// Engines that sit this scene out.
    #[serde(default)]
    pub(crate) exclude: Vec<String>,
}

/// Where a scene's triangles come from.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Source {
    /// A mesh file, relative to the folder given by `--meshes`.
    File(PathBuf),
    /// The generated showcase scene, of about so many triangles.
    Showcase(usize),
}

/// An engine under the name it has in records, with its options.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EngineDefinition {
    pub(crate) name: String,
    pub(crate) library: Library,
    /// How rays are handed over; every mode is timed over the same build.
    #[serde(default = "single")]
    pub(crate) modes: Vec<Mode>,
    /// Upper bound on both kinds of passes, for engines that take minutes.
    #[serde(default)]
    pub(crate) passes: Option<usize>,
}

/// The code behind an engine.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Library {
    Embree(EmbreeOptions),
    Obvhs(ObvhsTree),
    KdtreeRay,
    Kdray(KdrayOptions),
}

/// Scene and query flags of Embree.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EmbreeOptions {
    pub(crate) quality: EmbreeQuality,
    /// Watertight traversal, at some cost in speed.
    #[serde(default)]
    pub(crate) robust: bool,
    /// Promises similar rays within a packet.
    #[serde(default)]
    pub(crate) coherent: bool,
}

/// Embree's build qualities; `High` adds spatial splits.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum EmbreeQuality {
    Medium,
    High,
}

/// The trees of obvhs, each with the preset of its `medium_build`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ObvhsTree {
    Bvh2Medium,
    CwbvhMedium,
}

/// Departures from kdray's default build options.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct KdrayOptions {
    /// Cost of an inner step.
    pub(crate) traversal: Option<f32>,
    /// Cost of a triangle test.
    pub(crate) intersect: Option<f32>,
    /// Share of the cost taken off for cutting empty space away.
    pub(crate) empty_bonus: Option<f32>,
}

/// How many rays an engine is given at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Mode {
    Single,
    Packet8,
    Packet16,
    /// As many as a thread takes at a time, for the engine to arrange as it likes.
    Batch,
}

/// A set of rays; `rays.rs` says exactly which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RaySet {
    Primary,
    InPrimary,
    Bounce,
    Shadow,
    InBounce,
    Chord,
}

/// What is asked of each ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Query {
    Closest,
    Any,
}

impl RaySet {
    /// The question these rays are for.
    pub(crate) fn query(self) -> Query {
        match self {
            RaySet::Shadow => Query::Any,
            _ => Query::Closest,
        }
    }

    /// The name used in definitions, records and tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            RaySet::Primary => "primary",
            RaySet::InPrimary => "in_primary",
            RaySet::Bounce => "bounce",
            RaySet::Shadow => "shadow",
            RaySet::InBounce => "in_bounce",
            RaySet::Chord => "chord",
        }
    }
}

impl Definition {
    /// Reads and checks a definition; errors name the file and what is wrong with it.
    pub(crate) fn load(path: &Path) -> Result<Definition> {
        let text =
            fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))?;
        Definition::parse(&text).with_context(|| format!("in {}", path.display()))
    }

    fn parse(text: &str) -> Result<Definition> {
        let definition: Definition = toml::from_str(text)?;
        definition.check()?;
        Ok(definition)
    }

    /// Keeps only the named scenes and engines; an empty list keeps all.
    pub(crate) fn select(&mut self, scenes: &[String], engines: &[String]) -> Result<()> {
        for name in scenes {
            ensure!(self.scenes.iter().any(|s| s.name == *name), "no scene is called {name}");
        }
        for name in engines {
            self.engine(name)?;
        }
        self.scenes.retain(|s| scenes.is_empty() || scenes.contains(&s.name));
        self.engines.retain(|e| engines.is_empty() || engines.contains(&e.name));
        Ok(())
    }

    fn engine(&self, name: &str) -> Result<&EngineDefinition> {
        let found = self.engines.iter().find(|engine| engine.name == name);
        found.with_context(|| format!("no engine is called {name}"))
    }

    fn check(&self) -> Result<()> {
        let tile = crate::rays::TILE;
        ensure!(
            self.resolution > 0 && self.resolution.is_multiple_of(tile),
            "resolution must be a positive multiple of {tile}"
        );
        ensure!(self.build_passes > 0 && self.trace_passes > 0, "passes must be at least 1");
        self.engine(&self.baseline).context("baseline")?;
        unique(self.scenes.iter().map(|scene| &scene.name))?;
        unique(self.engines.iter().map(|engine| &engine.name))?;
        for name in self.scenes.iter().flat_map(|scene| &scene.exclude) {
            self.engine(name).context("exclude")?;
        }
        self.engines.iter().try_for_each(EngineDefinition::check)
    }
}

impl EngineDefinition {
    fn check(&self) -> Result<()> {
        for mode in &self.modes {
            match (mode, &self.library) {
                (Mode::Single, _) | (Mode::Batch, Library::Kdray(_)) => {}
                (Mode::Packet8 | Mode::Packet16, Library::Embree(_)) => {}
                (Mode::Batch, _) => bail!("engine {}: only kdray takes batches", self.name),
                _ => bail!("engine {}: only Embree takes packets", self.name),
            }
        }
        ensure!(!self.modes.is_empty(), "engine {}: no mode", self.name);
        ensure!(self.passes != Some(0), "engine {}: passes must be at least 1", self.name);
        Ok(())
    }
}

fn single() -> Vec<Mode> {
    vec![Mode::Single]
}

fn unique<'a>(names: impl Iterator<Item = &'a String>) -> Result<()> {
    let mut seen = HashSet::new();
    for name in names {
        ensure!(seen.insert(name), "the name {name} is used twice");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = r#"
        resolution = 64
        build_passes = 1
        trace_passes = 1
        baseline = "a"
        [[scene]]
        name = "s"
        source = { showcase = 100 }
        rays = ["primary", "shadow"]
        [[engine]]
        name = "a"
        library = { kdray = { traversal = 15, intersect = 20 } }
        [[engine]]
        name = "b"
        library = "kdtree-ray"
    "#;

    #[test]
    fn every_shipped_definition_is_valid() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../bench/definitions");
        let files: Vec<_> = fs::read_dir(folder).expect("definitions are shipped").collect();
        assert!(!files.is_empty());
        for file in files {
            let path = file.expect("the folder can be listed").path();
            Definition::load(&path).expect("shipped definitions are valid");
        }
    }

    #[test]
    fn mistakes_are_named() {
        let cases = [
            (SMALL.replace("resolution = 64", "resolution = 63"), "multiple of 4"),
            (SMALL.replace("baseline = \"a\"", "baseline = \"z\""), "no engine is called z"),
            (SMALL.replace("name = \"b\"", "name = \"a\""), "used twice"),
            (SMALL.replace("name = \"b\"", "name = \"b\"\nmodes = [\"packet8\"]"), "packets"),
            (SMALL.replace("trace_passes = 1", "trace_passes = 0"), "at least 1"),
            (SMALL.replace("traversal = 15", "speed = 15"), "unknown field"),
        ];
        for (text, reason) in cases {
            let error = Definition::parse(&text).expect_err(reason);
            assert!(format!("{error:#}").contains(reason), "{error:#} should say {reason}");
        }
    }

    #[test]
    fn selecting_keeps_what_is_named() {
        let mut definition = Definition::parse(SMALL).expect("valid");
        definition.select(&[], &["b".to_owned()]).expect("b exists");
        assert_eq!(definition.engines.len(), 1);
        assert_eq!(definition.scenes.len(), 1);
        assert!(definition.select(&["z".to_owned()], &[]).is_err());
    }
}
