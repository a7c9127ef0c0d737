//! One scene: engines build it and trace it in turns.
//!
//! Passes are interleaved: each engine gets one build or one trace, then the next engine, and
//! only then the next pass. A noisy moment of the machine falls on everybody alike.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use cpu_time::ProcessTime;
use indicatif::ProgressBar;
use kdray::{BuildOptions, Mesh, Ray, Tracer, Tree};

use crate::definition::{Definition, EngineDefinition, Mode, RaySet, SceneDefinition, Source};
use crate::engine::{Builder, Engine, Hit, Index};
use crate::memory::{self, Memory};
use crate::rays::RayMaker;
use crate::record::{BuildRecord, SceneRecord, SetRecord, Spread, TraceRecord};
use crate::trace::{Answers, trace};

/// An engine that is there, with its definition.
pub(crate) type Present<'a> = (&'a EngineDefinition, Box<dyn Engine>);

/// The mesh of a scene; files are looked for in the folder `meshes`.
pub(crate) fn load(source: &Source, meshes: Option<&Path>) -> Result<Mesh> {
    match source {
        Source::Showcase(triangles) => {
            kdray_mesh::generate::showcase(*triangles).mesh().context("the generated scene")
        }
        Source::File(file) => {
            let folder = meshes.with_context(|| format!("{} needs --meshes", file.display()))?;
            let path = folder.join(file);
            let loaded = kdray_mesh::load(&path).context("loading")?;
            loaded.mesh().with_context(|| path.display().to_string())
        }
    }
}

/// Measures one scene after another under one plan.
pub(crate) struct Bench<'a> {
    pub(crate) definition: &'a Definition,
    /// Ascending.
    pub(crate) threads: &'a [usize],
    pub(crate) progress: &'a ProgressBar,
}

/// An engine's builders, one per thread count, its last index and its times.
struct Contestant<'a> {
    definition: &'a EngineDefinition,
    engine: &'a dyn Engine,
    builders: Vec<Box<dyn Builder>>,
    memory: Vec<Memory>,
    /// Wall and CPU seconds, by builder and pass.
    builds: Vec<Vec<(f64, f64)>>,
    index: Option<Box<dyn Index>>,
}

/// The rays of a set with the baseline's answers.
struct Rays {
    set: RaySet,
    rays: Vec<Ray>,
    truth: Option<Answers>,
}

/// One engine in one mode on some threads, on one ray set.
struct Heat {
    contestant: usize,
    mode: Mode,
    threads: usize,
    seconds: Vec<f64>,
    cpu_seconds: Vec<f64>,
    differ: Option<f64>,
}

impl Bench<'_> {
    /// Builds and traces `mesh` with all engines that the scene does not exclude.
    pub(crate) fn measure(
        &self,
        scene: &SceneDefinition,
        mesh: &Mesh,
        engines: &[Present],
    ) -> Result<SceneRecord> {
        let mut contestants = self.contestants(scene, engines)?;
        self.build_all(&mut contestants, mesh)?;
        let mut record = SceneRecord {
            name: scene.name.clone(),
            triangles: mesh.triangles().len(),
            sets: Vec::new(),
            builds: self.build_records(&contestants),
            traces: Vec::new(),
        };
        let reference = reference(mesh)?;
        let maker = RayMaker::new(mesh, self.definition.resolution, &reference);
        for set in &scene.rays {
            let rays = self.rays(*set, &maker, &contestants);
            let hits = rays.truth.as_ref().map(Answers::hits);
            record.sets.push(SetRecord { set: *set, rays: rays.rays.len(), hits });
            record.traces.extend(self.trace_all(&contestants, &rays));
        }
        Ok(record)
    }

    /// Builders are made for all engines with few threads before any with more: Embree gives a
    /// device as many threads as the largest device of that moment has.
    fn contestants<'a>(
        &self,
        scene: &SceneDefinition,
        engines: &'a [Present],
    ) -> Result<Vec<Contestant<'a>>> {
        let taking_part = engines.iter().filter(|(e, _)| !scene.exclude.contains(&e.name));
        let mut contestants: Vec<_> = taking_part
            .map(|(definition, engine)| Contestant::new(definition, &**engine))
            .collect();
        for threads in self.threads {
            for contestant in &mut contestants {
                contestant.get_ready(*threads)?;
            }
        }
        Ok(contestants)
    }

    /// The first pass counts memory and warms up; the others are timed.
    fn build_all(&self, contestants: &mut [Contestant], mesh: &Mesh) -> Result<()> {
        for pass in 0..=self.definition.build_passes {
            for which in 0..self.threads.len() {
                for contestant in contestants.iter_mut() {
                    let name = &contestant.definition.name;
                    self.progress.set_message(format!("{name} builds"));
                    let context = name.clone();
                    match pass {
                        0 => contestant.count(which, mesh).context(context)?,
                        _ if contestant.definition.takes_part(pass - 1) => {
                            contestant.time(which, mesh).context(context)?;
                        }
                        _ => {}
                    }
                    self.progress.inc(1);
                }
            }
        }
        Ok(())
    }

    fn build_records(&self, contestants: &[Contestant]) -> Vec<BuildRecord> {
        let records = contestants.iter().flat_map(|contestant| {
            let record = |(which, threads): (usize, &usize)| contestant.record(which, *threads);
            self.threads.iter().enumerate().filter_map(record)
        });
        records.collect()
    }

    fn rays(&self, set: RaySet, maker: &RayMaker, contestants: &[Contestant]) -> Rays {
        self.progress.set_message(format!("{} rays", set.name()));
        let rays = maker.rays(set);
        let is_baseline = |c: &&Contestant| c.definition.name == self.definition.baseline;
        let baseline = contestants.iter().find(is_baseline).and_then(|c| c.index.as_deref());
        let truth = baseline.map(|index| {
            let mut answers = Answers::new(set.query(), rays.len());
            trace(index, Mode::Single, &rays, 1, &mut answers);
            answers
        });
        Rays { set, rays, truth }
    }

    fn trace_all(&self, contestants: &[Contestant], rays: &Rays) -> Vec<TraceRecord> {
        let mut heats = self.heats(contestants);
        let mut answers = Answers::new(rays.set.query(), rays.rays.len());
        for pass in 0..self.definition.trace_passes {
            for heat in &mut heats {
                let contestant = &contestants[heat.contestant];
                self.progress.inc(1);
                if let Some(index) = contestant.index.as_deref()
                    && contestant.definition.takes_part(pass)
                {
                    let name = &contestant.definition.name;
                    self.progress.set_message(format!("{name} traces {}", rays.set.name()));
                    heat.trace(index, rays, &mut answers);
                }
            }
        }
        let record = |heat: Heat| heat.record(&contestants[heat.contestant].definition.name, rays);
        heats.into_iter().filter_map(record).collect()
    }

    /// Thread counts outside, engines inside: rivals run right after each other.
    fn heats(&self, contestants: &[Contestant]) -> Vec<Heat> {
        let mut heats = Vec::new();
        for threads in self.threads {
            for (contestant, Contestant { definition, .. }) in contestants.iter().enumerate() {
                heats.extend(definition.modes.iter().map(|mode| Heat {
                    contestant,
                    mode: *mode,
                    threads: *threads,
                    seconds: Vec::new(),
                    cpu_seconds: Vec::new(),
                    differ: None,
                }));
            }
        }
        heats
    }
}

impl EngineDefinition {
    /// Whether the engine runs in this pass, counted from zero.
    fn takes_part(&self, pass: usize) -> bool {
        self.passes.is_none_or(|passes| pass < passes)
    }
}

impl<'a> Contestant<'a> {
    fn new(definition: &'a EngineDefinition, engine: &'a dyn Engine) -> Self {
        let (builders, memory, builds) = (Vec::new(), Vec::new(), Vec::new());
        Self { definition, engine, builders, memory, builds, index: None }
    }

    fn get_ready(&mut self, threads: usize) -> Result<()> {
        let builder = self.engine.builder(threads);
        self.builders.push(builder.with_context(|| self.definition.name.clone())?);
        self.builds.push(Vec::new());
        Ok(())
    }

    fn count(&mut self, which: usize, mesh: &Mesh) -> Result<()> {
        self.index = None;
        let (index, own) = memory::measure(|| self.builders[which].build(mesh));
        let index = index?;
        let foreign = index.foreign_memory();
        self.memory.push(Memory {
            final_bytes: own.final_bytes + foreign.final_bytes,
            peak_bytes: own.peak_bytes + foreign.peak_bytes,
        });
        self.index = Some(index);
        Ok(())
    }

    fn time(&mut self, which: usize, mesh: &Mesh) -> Result<()> {
        self.index = None;
        let (wall, cpu) = (Instant::now(), ProcessTime::now());
        let index = self.builders[which].build(mesh)?;
        let seconds = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
        self.builds[which].push(seconds);
        self.index = Some(index);
        Ok(())
    }

    fn record(&self, which: usize, threads: usize) -> Option<BuildRecord> {
        let (wall, cpu): (Vec<_>, Vec<_>) = self.builds[which].iter().copied().unzip();
        let memory = self.memory[which];
        Some(BuildRecord {
            engine: self.definition.name.clone(),
            threads,
            seconds: Spread::of_seconds(&wall)?,
            cpu_seconds: Spread::of_seconds(&cpu)?.best,
            final_bytes: memory.final_bytes,
            peak_bytes: memory.peak_bytes,
        })
    }
}

impl Heat {
    fn trace(&mut self, index: &dyn Index, rays: &Rays, answers: &mut Answers) {
        let cpu = ProcessTime::now();
        let time = trace(index, self.mode, &rays.rays, self.threads, answers);
        self.cpu_seconds.push(cpu.elapsed().as_secs_f64() / self.threads as f64);
        self.seconds.push(time.as_secs_f64());
        if self.differ.is_none() {
            self.differ = rays.truth.as_ref().map(|truth| truth.disagreement(answers));
        }
    }

    fn record(&self, engine: &str, rays: &Rays) -> Option<TraceRecord> {
        let millions = 1e-6 * rays.rays.len() as f64;
        Some(TraceRecord {
            engine: engine.to_owned(),
            mode: self.mode,
            threads: self.threads,
            set: rays.set,
            mrays: Spread::of_rates(millions, &self.seconds)?,
            cpu_mrays: Spread::of_rates(millions, &self.cpu_seconds)?,
            differ: self.differ,
        })
    }
}

/// Closest hits by kdray with its default options: the source of secondary rays.
fn reference(mesh: &Mesh) -> Result<impl Fn(&[Ray]) -> Vec<Hit>> {
    let tracer = Tracer::new(mesh, &Tree::build(mesh, &BuildOptions::default())?);
    Ok(move |rays: &[Ray]| {
        let mut hits = vec![None; rays.len()];
        tracer.closest_hits(rays, &mut hits);
        let hit = |hit: kdray::Hit| Hit { t: hit.t, triangle: hit.triangle };
        hits.into_iter().map(|found| found.map_or(Hit::MISS, hit)).collect()
    })
}
