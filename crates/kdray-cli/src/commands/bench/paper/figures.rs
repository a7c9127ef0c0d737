//! The paper's figures, each with a sentence that says what it shows.

use maud::{Markup, PreEscaped, html};

use super::charts::{self, Axes, Series};
use super::measure::GpuFigures;
use super::report::{Report, SceneReport};
use crate::commands::build::profile::{Level, Stage};

/// The stages of every level, in the paper's words; `finish` and `part` are kdray's own.
const OF_LEVELS: [&str; 6] = ["sweep", "split", "clip", "sort", "finish", "part"];

/// Those before the first level and after the last.
const OF_NO_LEVEL: [&str; 2] = ["events", "pack"];

/// A chart with its title, its sentence and its legend.
fn figure(title: &str, sentence: &str, svg: String, legend: &[String]) -> Markup {
    html! {
        figure {
            h3 { (title) }
            div role="img" aria-label=(title) { (PreEscaped(svg)) }
            ul .legend {
                @for (index, name) in legend.iter().enumerate() {
                    @let (shape, colour) = charts::mark(index);
                    li { span style={ "color:" (colour) } { (shape) } " " (name) }
                }
            }
            figcaption { (sentence) }
        }
    }
}

fn names(series: &[Series]) -> Vec<String> {
    series.iter().map(|series| series.name.clone()).collect()
}

/// All figures that the report has data for.
pub(super) fn all(report: &Report) -> anyhow::Result<Vec<Markup>> {
    if report.measured().next().is_none() {
        return Ok(Vec::new());
    }
    let mut all = vec![memory(report)?];
    if report.on_gpu().next().is_none() {
        return Ok(all);
    }
    all.push(floors(report)?);
    all.push(shares(report, "bytes that the kernels move", |stage| {
        (stage.read_bytes + stage.written_bytes) as f64
    })?);
    let where_timed = format!("time in the kernels{}", software(report));
    all.push(shares(report, &where_timed, |stage| stage.ms)?);
    all.push(buckets(report)?);
    all.push(clipped(report)?);
    for (scene, gpu) in report.on_gpu() {
        all.push(stages(report, scene.title, gpu)?);
    }
    Ok(all)
}

/// The label of times that are not a GPU's.
fn software(report: &Report) -> &'static str {
    match &report.device {
        Some(device) if device.is_software => " (software device: not comparable with the paper)",
        _ => "",
    }
}

/// How much more memory a build takes than its tree.
fn memory(report: &Report) -> anyhow::Result<Markup> {
    let scenes: Vec<&str> = report.measured().map(|(scene, _)| scene.title).collect();
    let mut series = ["paper", "CPU builder", "GPU builder"]
        .map(|name| Series { name: name.to_owned(), points: Vec::new() });
    for (row, (scene, measured)) in report.measured().enumerate() {
        let gpu = measured.gpu.as_ref().map(|gpu| &gpu.profile);
        let ratios = [
            Some(scene.paper.peak_mb / scene.paper.final_mb),
            Some(measured.cpu.peak_bytes as f64 / measured.cpu.final_bytes as f64),
            gpu.map(|profile| profile.peak_bytes as f64 / profile.final_bytes as f64),
        ];
        for (series, ratio) in series.iter_mut().zip(ratios) {
            series.points.extend(ratio.map(|ratio| [row as f64, ratio]));
        }
    }
    let series: Vec<Series> = series.into_iter().filter(|s| !s.points.is_empty()).collect();
    let svg = charts::dots("peak memory / memory of the tree", &scenes, &series)?;
    let sentence = "The paper's builds take five to seven times the memory of their trees at their \
                    peak; a mark further left is a build that needs less beside its result.";
    Ok(figure("Peak memory over final memory", sentence, svg, &names(&series)))
}

/// The least times that the bytes moved allow, and the paper's times.
fn floors(report: &Report) -> anyhow::Result<Markup> {
    let scenes: Vec<&str> = report.on_gpu().map(|(scene, _)| scene.title).collect();
    let points = |of: &dyn Fn(&SceneReport, &GpuFigures) -> f64| {
        let values = report.on_gpu().map(|(scene, gpu)| of(scene, gpu));
        values.enumerate().map(|(row, value)| [row as f64, value]).collect()
    };
    let series = [
        Series { name: "paper's build".into(), points: points(&|scene, _| scene.paper.build_s) },
        Series { name: "kdray's floor".into(), points: points(&|_, gpu| gpu.profile.floor_s) },
    ];
    let svg = charts::dots("seconds", &scenes, &series)?;
    let sentence = "The floor is the time that the paper's GPU would need only to move the bytes \
                    that kdray's kernels read and write; the paper's build times are the whole of \
                    what it took there.";
    Ok(figure("Least build time by bytes moved", sentence, svg, &names(&series)))
}

/// What part of a build each stage has.
fn shares(report: &Report, what: &str, of: impl Fn(&Stage) -> f64) -> anyhow::Result<Markup> {
    let scenes: Vec<&str> = report.on_gpu().map(|(scene, _)| scene.title).collect();
    let sum = |gpu: &GpuFigures, name: Option<&str>| -> f64 {
        let stages = gpu.profile.stages.iter();
        stages.filter(|stage| name.is_none_or(|name| stage.stage == name)).map(&of).sum()
    };
    let part = |name: &&str| {
        let share = |gpu: &GpuFigures| 100.0 * sum(gpu, Some(name)) / sum(gpu, None).max(1e-12);
        let points = report.on_gpu().enumerate();
        let points = points.map(|(row, (_, gpu))| [row as f64, share(gpu)]).collect();
        Series { name: (*name).to_owned(), points }
    };
    let parts: Vec<Series> = OF_LEVELS.iter().chain(&OF_NO_LEVEL).map(part).collect();
    let svg = charts::bars("percent of the build", &scenes, &parts)?;
    let sentence = format!(
        "Every stage's part of the {what}; in the paper sorting events takes about one and a half \
         times what the SAH (sweep) takes. kdray finishes small subtrees at once (finish)."
    );
    let title = format!("Stages by {what}");
    Ok(figure(&title, &sentence, svg, &names(&parts)))
}

/// A figure of every level, batches of one level together.
fn by_level(gpu: &GpuFigures, fold: impl Fn(f64, &Level) -> f64) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for level in &gpu.profile.levels {
        while points.len() <= level.level as usize {
            points.push([points.len() as f64, 0.0]);
        }
        let value = &mut points[level.level as usize][1];
        *value = fold(*value, level);
    }
    points
}

/// The largest bucket of every level.
fn buckets(report: &Report) -> anyhow::Result<Markup> {
    let series = |(scene, gpu): (&SceneReport, &GpuFigures)| {
        let mut points = by_level(gpu, |most, level| most.max(level.largest_bucket.into()));
        // The root has no bucket: all of its events are sorted at once.
        points.drain(..points.len().min(1));
        Series { name: scene.title.to_owned(), points }
    };
    let series: Vec<Series> = report.on_gpu().map(series).collect();
    let axes = Axes { x: "level", y: "new events" };
    let svg = charts::lines(&axes, &series, &[])?;
    let sentence = "The most new events along one axis that a single node has to sort, on every \
                    level below the root; the paper's are greatest on the middle levels.";
    Ok(figure("Largest bucket on every level", sentence, svg, &names(&series)))
}

/// Clipped references of every level over the square root of the triangles.
fn clipped(report: &Report) -> anyhow::Result<Markup> {
    let mut series = Vec::new();
    for (scene, gpu) in report.on_gpu() {
        let triangles = scene.measured().map_or(1, |measured| measured.tree.triangles.max(1));
        let root = (triangles as f64).sqrt();
        let points = by_level(gpu, |sum, level| sum + f64::from(level.clipped) / root);
        series.push(Series { name: scene.title.to_owned(), points });
    }
    let levels = series.iter().map(|series| series.points.len()).max().unwrap_or(0);
    let guide: Vec<[f64; 2]> =
        (0..levels.min(24)).map(|x| [x as f64, (x as f64 / 2.0).exp2()]).collect();
    let axes = Axes { x: "level", y: "clipped / √N" };
    let svg = charts::lines(&axes, &series, &guide)?;
    let sentence = "References that are clipped on every level, over the square root of the \
                    scene's triangles; the dashed line is what 2^level nodes would have if each \
                    clipped the square root of its own share.";
    Ok(figure("Clipped references against √N", sentence, svg, &names(&series)))
}

/// The stages of one scene on every level.
fn stages(report: &Report, title: &str, gpu: &GpuFigures) -> anyhow::Result<Markup> {
    let levels = gpu.profile.levels.iter().map(|level| level.level + 1).max().unwrap_or(0);
    let part = |name: &&str| {
        let at = |level: u32| -> f64 {
            let stages = gpu.profile.stages.iter();
            stages.filter(|s| s.stage == *name && s.level == level).map(|stage| stage.ms).sum()
        };
        let points = (0..levels).map(|level| [f64::from(level), at(level)]).collect();
        Series { name: (*name).to_owned(), points }
    };
    let parts: Vec<Series> = OF_LEVELS.iter().map(part).collect();
    let [events, pack] = OF_NO_LEVEL.map(|name| {
        let stages = gpu.profile.stages.iter().filter(|stage| stage.stage == name);
        stages.map(|stage| stage.ms).sum::<f64>()
    });
    let axes = Axes { x: "level", y: "ms" };
    let svg = charts::columns(&axes, &parts)?;
    let sentence = format!(
        "Time that every stage takes on every level of {title}{}; sorting all events before the \
         first level takes {events:.1} ms more, and packing after the last {pack:.1} ms.",
        software(report)
    );
    Ok(figure(&format!("{title}: stages on every level"), &sentence, svg, &names(&parts)))
}
