//! Meshes that are larger than what a device can bind.
//!
//! The CPU cuts nodes near the root until each has few enough references ([`Crown`]). The device
//! builds what is below, one node after the other, of the triangles that reach into it.

use kdray::build::{Below, Crown, Limits, ordered};
use kdray::{Aabb, BuildOptions, Mesh, Tree};

use super::data::Part;
use super::first::Start;
use super::report::BuildReport;
use super::spare::Spare;
use super::{Wanted, build_in};
use crate::device::Device;
use crate::error::GpuError;

/// Bytes of the largest array that a reference may need at first: three vertices of its own.
const REFERENCE_BYTES: u64 = 36;

/// Nodes of so few references are not cut for the sake of a device.
const LEAST: u64 = 1024;

/// Builds the tree of `mesh`, from as large parts as the device can bind.
pub(super) fn build(
    device: &Device,
    mesh: &Mesh,
    options: &BuildOptions,
    with_profile: bool,
) -> Result<(Tree, BuildReport), GpuError> {
    let mut most = device.limits().binding_bytes / REFERENCE_BYTES;
    loop {
        let built = build_of(most as usize, device, mesh, options, with_profile);
        // The lists of a part may be many times those of its root.
        match built {
            Err(GpuError::Limit { .. }) if most > LEAST => most /= 4,
            built => return built,
        }
    }
}

/// Builds from parts of at most so many references.
fn build_of(
    most: usize,
    device: &Device,
    mesh: &Mesh,
    options: &BuildOptions,
    with_profile: bool,
) -> Result<(Tree, BuildReport), GpuError> {
    // A budget is the device's, and what there is to say of progress is said below.
    let crown_options = BuildOptions { memory_budget: None, progress: None, ..options.clone() };
    let crown = Crown::new(mesh, &crown_options, most)?;
    let [nodes, references] = crown.counts();
    let mut report = BuildReport { crown: nodes, ..BuildReport::default() };
    let limits = Limits::new(mesh, options)?;
    let wanted = Wanted { with_profile, keeps_mesh: false };
    let (mut cutting, mut done) = (Cutting::new(mesh), 0);
    let tree = crown.into_tree(mesh, options, |below| {
        let share =
            |part: f32| (done as f32 + part * below.triangles.len() as f32) / references as f32;
        let progress = options.progress.map(|report| move |part| report(share(part)));
        let progress = progress.as_ref().map(|report| report as &(dyn Fn(f32) + Sync));
        let options = BuildOptions { progress, ..options.clone() };
        let parts = ordered_parts(below);
        let start = cutting.start(below, &parts, limits);
        let (left, of_part, _) = build_in(Spare::default, device, &start, &options, wanted)?;
        done += below.triangles.len();
        report.add(of_part);
        left.tree.lists(device)
    })?;
    report.tree_bytes = tree.size_bytes() as u64;
    if let Some(report) = options.progress {
        report(1.0);
    }
    Ok((tree, report))
}

fn ordered_parts(below: &Below) -> Vec<Part> {
    let part =
        |bounds: &Aabb| Part { lower: bounds.lower.map(ordered), upper: bounds.upper.map(ordered) };
    below.parts.iter().map(part).collect()
}

/// Cuts parts out of a mesh.
struct Cutting<'a> {
    mesh: &'a Mesh,
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    /// By vertex of the mesh, its place in `positions`, or [`u32::MAX`].
    places: Vec<u32>,
}

impl<'a> Cutting<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let places = vec![u32::MAX; mesh.positions().len()];
        Self { mesh, positions: Vec::new(), triangles: Vec::new(), places }
    }

    /// The triangles that reach into a node, with no vertices but theirs.
    fn start<'s>(&'s mut self, below: &Below, parts: &'s [Part], limits: Limits) -> Start<'s> {
        self.places.fill(u32::MAX);
        self.positions.clear();
        self.triangles.clear();
        for triangle in &below.triangles {
            let corners = self.mesh.triangles()[*triangle as usize].map(|vertex| vertex as usize);
            self.triangles.push(corners.map(|vertex| {
                if self.places[vertex] == u32::MAX {
                    self.places[vertex] = self.positions.len() as u32;
                    self.positions.push(self.mesh.positions()[vertex]);
                }
                self.places[vertex]
            }));
        }
        let (positions, triangles) = (&self.positions, &self.triangles);
        Start { positions, triangles, bounds: below.bounds, depth: below.depth, parts, limits }
    }
}

impl BuildReport {
    /// Adds what a part took, which was built after the others.
    fn add(&mut self, part: Self) {
        self.peak_bytes = self.peak_bytes.max(part.peak_bytes);
        self.readbacks += part.readbacks;
        self.levels.extend(part.levels);
        if let Some(profile) = part.profile {
            self.profile.get_or_insert_default().append(profile);
        }
    }
}

#[cfg(test)]
mod tests {
    use kdray_test::{Scene, scenes};

    use super::super::lockstep::lavapipe;
    use super::*;

    /// In parts of a few triangles, planes, straddlers and ties are those of the whole.
    #[test]
    fn parts_make_the_whole() {
        let device = lavapipe();
        let mut made = [0; 2];
        for (index, Scene { name, mesh, .. }) in scenes::all().enumerate() {
            let options = BuildOptions { clip: index % 4 != 3, ..BuildOptions::default() };
            let tree = Tree::build(&mesh, &options).expect("the options are in range");
            let most = mesh.triangles().len() / 6;
            let (same, report) = build_of(most, &device, &mesh, &options, true).expect(&name);
            assert!(same == tree, "{name}");
            made[0] += report.crown;
            made[1] += report.levels.len();
        }
        assert!(made.iter().all(|some| *some > 100), "{made:?}");
    }
}
