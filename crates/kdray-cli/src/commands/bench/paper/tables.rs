//! The paper's tables, with kdray's columns beside its own.

use maud::{Markup, html};

use super::measure::SIDE;
use super::published::{BANDWIDTH, Peer};
use super::report::{Measured, Outcome, Report, SceneReport};
use super::scenes::Likeness;
use crate::sizes::count;

/// A table: its head, in groups of columns, and a row a scene.
struct Table<'a> {
    report: &'a Report,
    groups: Vec<(String, Vec<&'a str>)>,
}

impl Table<'_> {
    /// The table, with the cells of every scene that was measured.
    fn rows(&self, cells: impl Fn(&SceneReport, &Measured) -> Vec<String>) -> Markup {
        html! {
            div .scroll {
                table {
                    thead {
                        tr {
                            th rowspan="2" scope="col" { "Scene" }
                            @for (group, columns) in &self.groups {
                                th colspan=(columns.len()) scope="colgroup" { (group) }
                            }
                        }
                        tr {
                            @for column in self.columns() { th scope="col" { (column) } }
                        }
                    }
                    tbody {
                        @for scene in &self.report.scenes {
                            (self.row(scene, &cells))
                        }
                    }
                }
            }
        }
    }

    fn columns(&self) -> impl Iterator<Item = &str> {
        self.groups.iter().flat_map(|(_, columns)| columns.iter().copied())
    }

    fn row(
        &self,
        scene: &SceneReport,
        cells: impl Fn(&SceneReport, &Measured) -> Vec<String>,
    ) -> Markup {
        html! {
            tr {
                th scope="row" { (scene.title) (star(scene)) }
                @match &scene.outcome {
                    Outcome::Missing { wanted } => {
                        td .missing colspan=(self.columns().count()) {
                            "missing: no " (wanted) " in " (self.report.meshes)
                        }
                    }
                    Outcome::Measured(measured) => {
                        @for cell in cells(scene, measured) { td { (cell) } }
                    }
                }
            }
        }
    }
}

/// A star where the mesh is not the paper's.
fn star(scene: &SceneReport) -> &'static str {
    match scene.measured() {
        Some(measured) if measured.likeness != Likeness::Same => " *",
        _ => "",
    }
}

fn group<'a>(name: &str, columns: &[&'a str]) -> (String, Vec<&'a str>) {
    (name.to_owned(), columns.to_vec())
}

/// Builds and pictures, beside the paper's. A software device's times have a table of their own.
pub(super) fn speed(report: &Report) -> Markup {
    let real = report.device.as_ref().filter(|device| !device.is_software);
    let mut builds = vec!["this CPU"];
    builds.extend(real.map(|device| device.adapter.as_str()));
    let mut traces = builds.clone();
    builds.extend(["paper", "Choi", "Lauterbach"]);
    traces.extend(["paper", "Lauterbach"]);
    let groups = vec![
        group("Triangles", &["here", "paper"]),
        group("Build, s", &builds),
        group("Trace, ms", &traces),
    ];
    Table { report, groups }.rows(|scene, measured| {
        let paper = scene.paper;
        let peer = |peer| (paper.peer == peer).then_some(paper.peer_build_s);
        let mut cells = vec![
            count(measured.tree.triangles),
            count(paper.triangles as usize),
            seconds(Some(measured.cpu.build_s)),
        ];
        cells.extend(real.map(|_| seconds(measured.gpu.as_ref().map(|gpu| gpu.build_s))));
        cells.push(seconds(Some(paper.build_s)));
        cells.extend([Peer::Choi, Peer::Lauterbach].map(|name| seconds(peer(name))));
        cells.push(milliseconds(Some(measured.cpu.trace_s)));
        cells.extend(real.map(|_| milliseconds(measured.gpu.as_ref().map(|gpu| gpu.trace_s))));
        cells.extend([Some(paper.trace_s), paper.peer_trace_s].map(milliseconds));
        cells
    })
}

/// Peak and final memory, beside the paper's.
pub(super) fn memory(report: &Report) -> Markup {
    let columns = ["peak", "final", "ratio"];
    let mut groups = vec![group("CPU builder, MB", &columns)];
    if report.device.is_some() {
        groups.push(group("GPU builder, MB", &columns));
    }
    groups.push(group("Paper, MB", &columns));
    let three = |peak: f64, tree: f64| {
        [format!("{peak:.1}"), format!("{tree:.2}"), format!("{:.1}", peak / tree)]
    };
    let megabytes = |bytes: u64| bytes as f64 / 1e6;
    Table { report, groups }.rows(|scene, measured| {
        let cpu = &measured.cpu;
        let mut cells = Vec::from(three(megabytes(cpu.peak_bytes), megabytes(cpu.final_bytes)));
        let gpu = measured.gpu.as_ref().map(|gpu| &gpu.profile);
        cells.extend(gpu.into_iter().flat_map(|profile| {
            three(megabytes(profile.peak_bytes), megabytes(profile.final_bytes))
        }));
        cells.extend(three(scene.paper.peak_mb, scene.paper.final_mb));
        cells
    })
}

/// What the build on the device does, whatever runs it.
pub(super) fn work(report: &Report) -> Markup {
    let groups = vec![
        group("Work", &["dispatches", "readbacks"]),
        group("Bytes moved", &["MB", "bytes a triangle"]),
        group(&format!("Build at {BANDWIDTH} GB/s, s"), &["floor", "paper's time"]),
        group("As the CPU's", &["tree", "hits"]),
    ];
    Table { report, groups }.rows(|scene, measured| {
        let Some(gpu) = &measured.gpu else { return Vec::new() };
        let profile = &gpu.profile;
        let moved = profile.bytes_moved as f64;
        vec![
            count(profile.dispatches as usize),
            count(profile.readbacks as usize),
            count((moved / 1e6).round() as usize),
            count((moved / measured.tree.triangles.max(1) as f64).round() as usize),
            format!("{:.4}", profile.floor_s),
            seconds(Some(scene.paper.build_s)),
            if gpu.same_tree { "yes, byte for byte" } else { "no" }.to_owned(),
            if gpu.same_hits { "yes, bit for bit" } else { "no" }.to_owned(),
        ]
    })
}

/// What rays take on the device, beside the tracer on the CPU.
pub(super) fn rays(report: &Report) -> Markup {
    let groups = vec![
        group("Million rays a second", &["CPU", "GPU"]),
        group("A ray's", &["nodes", "leaves", "triangle tests"]),
    ];
    let rate = |seconds: f64| format!("{:.2}", 1e-6 * f64::from(SIDE * SIDE) / seconds.max(1e-9));
    Table { report, groups }.rows(|_, measured| {
        let Some(gpu) = &measured.gpu else { return Vec::new() };
        let rays = &gpu.rays;
        let each = [rays.nodes_per_ray, rays.leaves_per_ray, rays.triangle_tests_per_ray];
        let mut cells = Vec::from([measured.cpu.trace_s, gpu.trace_s].map(rate));
        cells.extend(each.map(|count| format!("{count:.1}")));
        cells
    })
}

/// What the trees are like.
pub(super) fn trees(report: &Report) -> Markup {
    let groups = vec![
        group("Cost", &["SAH"]),
        group("Nodes", &["all", "leaves", "levels"]),
        group("References", &["all", "a triangle"]),
        group("Size", &["MB"]),
    ];
    Table { report, groups }.rows(|_, measured| {
        let tree = &measured.tree;
        vec![
            format!("{:.2}", tree.sah_cost),
            count(tree.nodes),
            count(tree.leaves),
            tree.depth.to_string(),
            count(tree.references),
            format!("{:.2}", tree.references as f64 / tree.triangles.max(1) as f64),
            format!("{:.2}", tree.tree_bytes as f64 / 1e6),
        ]
    })
}

/// Times of a software device, beside nothing.
pub(super) fn software(report: &Report) -> Markup {
    let groups =
        vec![group("Software device, s", &["build", "kernels, with the profile", "trace"])];
    Table { report, groups }.rows(|_, measured| {
        let Some(gpu) = &measured.gpu else { return Vec::new() };
        [gpu.build_s, gpu.profile.kernels_ms / 1e3, gpu.trace_s].map(|s| seconds(Some(s))).to_vec()
    })
}

fn seconds(seconds: Option<f64>) -> String {
    seconds.map_or_else(|| "–".into(), |seconds| format!("{seconds:.3}"))
}

fn milliseconds(seconds: Option<f64>) -> String {
    seconds.map_or_else(|| "–".into(), |seconds| format!("{:.1}", 1e3 * seconds))
}
