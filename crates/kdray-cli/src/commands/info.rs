//! `kdray info`: what a tree file or a mesh is like.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use kdray::{Stats, Tree};
use serde::Serialize;

use crate::sizes::{bytes, count};
use crate::topology::Topology;
use crate::{arguments, input, output};

#[derive(Args)]
pub(crate) struct Arguments {
    /// A tree file, or a mesh
    #[arg(value_name = "FILE")]
    path: PathBuf,
    #[command(flatten)]
    repair: arguments::Repair,
    #[command(flatten)]
    pub(crate) json: arguments::Json,
}

/// The figures of a tree.
#[derive(Serialize)]
pub(crate) struct TreeFigures {
    pub(crate) triangles: usize,
    pub(crate) nodes: usize,
    pub(crate) leaves: usize,
    empty_leaves: usize,
    pub(crate) references: usize,
    pub(crate) depth: u32,
    e_inner: f64,
    e_leaf: f64,
    e_prim: f64,
    pub(crate) sah_cost: f64,
    cost_traversal: f32,
    cost_intersect: f32,
    empty_bonus: f32,
    pub(crate) tree_bytes: usize,
    bytes_per_triangle: f64,
    /// At index n the leaves with n references.
    leaf_histogram: Vec<usize>,
}

impl TreeFigures {
    pub(crate) fn of(tree: &Tree) -> Self {
        let (stats, cost) = (tree.stats(), tree.cost());
        let sah_cost = stats.sah_cost(&cost);
        let triangles = tree.triangle_count();
        let Stats { nodes, leaves, empty_leaves, references, depth, .. } = stats;
        let Stats { e_inner, e_leaf, e_prim, leaf_histogram, .. } = stats;
        Self {
            triangles,
            nodes,
            leaves,
            empty_leaves,
            references,
            depth,
            e_inner,
            e_leaf,
            e_prim,
            sah_cost,
            cost_traversal: cost.traversal,
            cost_intersect: cost.intersect,
            empty_bonus: cost.empty_bonus,
            tree_bytes: stats.bytes,
            bytes_per_triangle: stats.bytes as f64 / triangles.max(1) as f64,
            leaf_histogram,
        }
    }

    /// Names and values for people.
    pub(crate) fn rows(&self) -> Vec<(&'static str, String)> {
        let leaves = format!("{} ({} empty)", count(self.leaves), count(self.empty_leaves));
        let per_triangle = self.references as f64 / self.triangles.max(1) as f64;
        let [inner, leaf, tests] = [self.e_inner, self.e_leaf, self.e_prim];
        let prices = format!(
            "traversal {}, intersection {}, empty bonus {}",
            self.cost_traversal, self.cost_intersect, self.empty_bonus
        );
        let size = bytes(self.tree_bytes as u64);
        vec![
            ("nodes", format!("{}, {} levels deep", count(self.nodes), self.depth)),
            ("leaves", leaves),
            ("references", format!("{}, {per_triangle:.2} a triangle", count(self.references))),
            ("tree", format!("{size}, {:.1} bytes a triangle", self.bytes_per_triangle)),
            ("SAH cost", format!("{:.2} ({prices})", self.sah_cost)),
            (
                "a ray meets",
                format!("{inner:.1} inner nodes, {leaf:.1} leaves, {tests:.1} references"),
            ),
        ]
    }

    /// How many leaves have how many references, as bars.
    fn histogram(&self) -> String {
        const WIDTH: usize = 40;
        const ROWS: usize = 12;
        let (shown, rest) = self.leaf_histogram.split_at(self.leaf_histogram.len().min(ROWS));
        let rest: usize = rest.iter().sum();
        let most = shown.iter().copied().max().unwrap_or(0).max(rest).max(1);
        let row = |(name, leaves): (String, usize)| {
            let bar = "#".repeat((leaves * WIDTH).div_ceil(most));
            format!("{name:>6}  {bar:WIDTH$}  {}\n", count(leaves))
        };
        let rows = shown.iter().enumerate().map(|(n, leaves)| (n.to_string(), *leaves));
        let last = (rest > 0).then(|| (format!("{ROWS}+"), rest));
        let bars: String = rows.chain(last).map(row).collect();
        format!("\nreferences in a leaf\n{bars}")
    }
}

#[derive(Serialize)]
struct TreeReport {
    kind: &'static str,
    file: String,
    #[serde(flatten)]
    bounds: Bounds,
    #[serde(flatten)]
    tree: TreeFigures,
}

#[derive(Serialize)]
struct MeshReport {
    kind: &'static str,
    file: String,
    vertices: usize,
    triangles: usize,
    #[serde(flatten)]
    bounds: Bounds,
    #[serde(flatten)]
    topology: Topology,
}

/// Where a mesh is, in the coordinates of its file.
#[derive(Serialize)]
struct Bounds {
    lower: [f64; 3],
    upper: [f64; 3],
    frame_origin: [f64; 3],
    frame_scale: f64,
}

impl Bounds {
    fn new(bounds: kdray::Aabb, frame: kdray::Frame) -> Self {
        Self {
            lower: frame.world_point(bounds.lower),
            upper: frame.world_point(bounds.upper),
            frame_origin: frame.origin,
            frame_scale: frame.scale,
        }
    }

    fn rows(&self) -> Vec<(&'static str, String)> {
        let is_plain = self.frame_origin == [0.0; 3] && self.frame_scale == 1.0;
        let number = |x: f64| if is_plain { (x as f32).to_string() } else { x.to_string() };
        let point = |point: [f64; 3]| point.map(number).join(" ");
        let mut rows = vec![("lower", point(self.lower)), ("upper", point(self.upper))];
        if !is_plain {
            let origin = point(self.frame_origin);
            rows.push(("frame", format!("around {origin}, scale {:e}", self.frame_scale)));
        }
        rows
    }
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let (path, json) = (&arguments.path, arguments.json.json);
    if input::is_tree(path)? {
        describe_tree(path, json)?;
    } else {
        describe_mesh(path, &arguments.repair, json)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn describe_tree(path: &Path, json: bool) -> anyhow::Result<()> {
    let tree = input::tree(path)?;
    let report = TreeReport {
        kind: "tree",
        file: path.display().to_string(),
        bounds: Bounds::new(tree.bounds(), tree.frame()),
        tree: TreeFigures::of(&tree),
    };
    let mut rows = vec![("tree file", report.file.clone())];
    rows.push(("triangles", count(report.tree.triangles)));
    rows.extend(report.bounds.rows());
    rows.extend(report.tree.rows());
    let text = output::table(&rows) + &report.tree.histogram();
    output::print(json, &report, &text)
}

fn describe_mesh(path: &Path, repair: &arguments::Repair, json: bool) -> anyhow::Result<()> {
    let mesh = input::mesh(path, repair)?;
    let topology = Topology::of(&mesh);
    let report = MeshReport {
        kind: "mesh",
        file: path.display().to_string(),
        vertices: mesh.positions().len(),
        triangles: mesh.triangles().len(),
        bounds: Bounds::new(mesh.bounds(), mesh.frame()),
        topology,
    };
    let mut rows = vec![("mesh", report.file.clone())];
    rows.push(("vertices", count(report.vertices)));
    let degenerate = count(topology.degenerate_triangles);
    rows.push(("triangles", format!("{} ({degenerate} without area)", count(report.triangles))));
    rows.extend(report.bounds.rows());
    rows.push(("closed", if topology.closed { "yes".into() } else { open_edges(&topology) }));
    output::print(json, &report, &output::table(&rows))
}

fn open_edges(topology: &Topology) -> String {
    let boundary = count(topology.boundary_edges);
    let crowded = count(topology.non_manifold_edges);
    format!("no: {boundary} edges of one triangle, {crowded} of more than two")
}
