//! Every kernel beside its twin, on what the twins before it made of real scenes.

use kdray::{BuildOptions, Cost};
use kdray_test::{Scene, scenes, vulkan};

use super::arrays::Array;
use super::cpu::Twins;
use super::driver::{Terms, build};
use super::executor::Executor;
use super::first::Start;
use super::gpu::Gpu;
use super::kernel::{Kernel, Params};
use super::report::LevelReport;
use super::spare::Spare;
use super::subtree::SMALL;
use super::{KERNELS, budget};
use crate::device::{Device, Limits};
use crate::error::GpuError;
use crate::record::Binding;

/// The twins; each kernel is also run on the device, and what it writes compared.
struct Lockstep<'a> {
    twins: Twins,
    gpu: Gpu<'a>,
    scene: &'a str,
    seen: Vec<&'static str>,
}

impl<'a> Lockstep<'a> {
    fn new(device: &'a Device, scene: &'a str) -> Self {
        let gpu = Gpu::new(device, Spare::default(), (None, u64::MAX), false);
        Self { twins: Twins::default(), gpu, scene, seen: Vec::new() }
    }

    /// Gives the device what the twin sees.
    fn hand_over(&mut self, array: Array) -> Result<(), GpuError> {
        self.gpu.upload(array, &self.twins.arrays[array])
    }

    fn compare(&mut self, array: Array, name: &str) -> Result<(), GpuError> {
        let expected = &self.twins.arrays[array];
        let found = self.gpu.download(array, expected.len())?;
        let differs = (0..found.len()).find(|place| found[*place] != expected[*place]);
        assert!(differs.is_none(), "{}: {name} differs in {array:?}[{differs:?}]", self.scene);
        Ok(())
    }
}

impl Executor for Lockstep<'_> {
    type Error = GpuError;

    fn run(&mut self, kernel: &'static Kernel, params: &Params) -> Result<(), GpuError> {
        kernel.arrays.iter().try_for_each(|array| self.hand_over(*array))?;
        self.gpu.run(kernel, params)?;
        if params.count > 0 {
            self.twins.run(kernel, params)?;
        }
        self.seen.push(kernel.shader.name);
        let storage = kernel.shader.bindings.iter().filter(|kind| **kind != Binding::Uniform);
        for (array, kind) in kernel.arrays.iter().zip(storage) {
            if *kind == Binding::Write {
                self.compare(*array, kernel.shader.name)?;
            }
        }
        Ok(())
    }

    fn scan(&mut self, array: Array, words: u32) -> Result<(), GpuError> {
        self.hand_over(array)?;
        self.gpu.scan(array, words)?;
        self.twins.scan(array, words)?;
        self.compare(array, "scan")
    }

    fn sort(&mut self, arrays: [Array; 4], words: u32) -> Result<(), GpuError> {
        arrays.into_iter().try_for_each(|array| self.hand_over(array))?;
        self.gpu.sort(arrays, words)?;
        self.twins.sort(arrays, words)?;
        arrays[..2].iter().try_for_each(|array| self.compare(*array, "sort"))
    }

    fn most_bytes(&self) -> u64 {
        self.twins.most_bytes()
    }

    fn upload(&mut self, array: Array, words: &[u32]) -> Result<(), GpuError> {
        Ok(self.twins.upload(array, words)?)
    }

    fn reserve(&mut self, array: Array, words: usize) -> Result<(), GpuError> {
        Ok(self.twins.reserve(array, words)?)
    }

    fn grow(&mut self, array: Array, words: usize) -> Result<(), GpuError> {
        Ok(self.twins.grow(array, words)?)
    }

    fn free(&mut self, array: Array) {
        self.twins.free(array);
    }

    fn park(&mut self, arrays: &[Array]) {
        self.twins.park(arrays);
    }

    fn unpark(&mut self, arrays: &[Array]) {
        self.twins.unpark(arrays);
    }

    fn clear(&mut self, array: Array, words: usize) -> Result<(), GpuError> {
        Ok(self.twins.clear(array, words)?)
    }

    fn stage(&mut self, name: &'static str, depth: u32) {
        self.twins.stage(name, depth);
    }

    fn swap(&mut self, one: Array, other: Array) {
        self.twins.swap(one, other);
    }

    fn read(&mut self, places: &[(Array, u32)]) -> Result<Vec<u32>, GpuError> {
        Ok(self.twins.read(places)?)
    }
}

pub(super) fn lavapipe() -> Device {
    vulkan::set_up();
    let name = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    let selection = name.parse().expect("every word is a selection");
    Device::open(&selection, &Limits::PORTABLE).expect("`.ci/vulkan` brings the device")
}

/// Builds in lockstep; gives the names of the kernels that were run, and what the levels had.
fn check(
    device: &Device,
    Scene { name, mesh, .. }: &Scene,
    options: &BuildOptions,
    budget: u64,
    with_teams: bool,
) -> (Vec<&'static str>, Vec<LevelReport>) {
    let mut lockstep = Lockstep::new(device, name);
    let terms = Terms { budget, with_teams, keeps_mesh: false };
    let start = Start::root(mesh, options).expect("the options have a meaning");
    let finished = build(&mut lockstep, &start, options, terms);
    let finished = finished.unwrap_or_else(|error| panic!("{name}: {error}"));
    let nodes: u32 = finished.levels.iter().map(|level| level.nodes).sum();
    let [all, _] = finished.counts;
    assert!(if with_teams { nodes <= all } else { nodes == all });
    (lockstep.seen, finished.levels)
}

#[test]
fn kernels_do_what_their_twins_do() {
    let device = lavapipe();
    let mut seen = Vec::new();
    for (index, scene) in scenes::all().enumerate() {
        let options = BuildOptions { clip: index % 8 != 7, ..BuildOptions::default() };
        for with_teams in [false, true] {
            let budget = budget(scene.mesh.triangles().len(), &options);
            seen.extend(check(&device, &scene, &options, budget, with_teams).0);
        }
    }
    let soup = Scene::open("soup in batches", &scenes::soup_of_size(6000, 1, 0.1));
    let options = BuildOptions { max_depth: Some(4), ..BuildOptions::default() };
    // Once with no room for the root's events, and once for little more than these.
    for budget in [0, 210 * 6000] {
        seen.extend(check(&device, &soup, &options, budget, true).0);
    }
    for kernel in KERNELS {
        assert!(seen.contains(&kernel.shader.name), "{} was never run", kernel.shader.name);
    }
}

/// Where planes cost next to nothing, large triangles are cut into many parts.
#[test]
fn a_team_without_room_leaves_the_subtree_to_the_kernels_of_levels() {
    let scene = Scene::open("soup", &scenes::soup_of_size(SMALL as usize, 1, 0.5));
    let cost = Cost { traversal: 0.01, ..Cost::default() };
    let options = BuildOptions { cost, ..BuildOptions::default() };
    let (_, levels) = check(&lavapipe(), &scene, &options, u64::MAX, true);
    assert_eq!((levels[0].references, levels[0].finished), (SMALL, 0));
    assert!(levels.iter().any(|level| level.finished > 0), "none of its children had room");
}
