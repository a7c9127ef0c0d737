//! The build on a device: kernels over flat arrays, level by level \[WZL11].
//!
//! ARCHITECTURE.md, "The build on the GPU", draws a level. Each kernel is a WGSL file and a Rust
//! file of the same name, with its place in the build and its twin: what it does, on the CPU.

mod arrays;
mod assign;
mod batches;
mod bear;
mod carry;
mod choose;
mod clip;
mod cpu;
mod crown;
mod data;
mod decide;
mod driver;
mod ends;
mod executor;
mod finish;
mod first;
mod flats;
mod gather;
mod gpu;
mod join;
mod keep;
mod kernel;
#[cfg(test)]
mod lockstep;
mod mark;
mod merge;
mod name;
mod narrow;
mod offer;
mod offset;
mod pack;
mod packing;
mod pair;
mod part;
mod piece;
mod place;
mod price;
mod pricing;
mod rank;
mod rebuilder;
mod renew;
mod report;
mod resident;
mod route;
mod seed;
mod settle;
mod side;
mod spare;
mod starts;
mod stow;
mod subtree;
mod tally;
mod weigh;

use kdray::{BuildError, BuildOptions, Mesh, Tree};

#[cfg(test)]
pub(crate) use kernel::{Params, Worker};
#[cfg(test)]
pub(crate) use piece::PIECE;
pub use rebuilder::Rebuilder;
pub use report::{BuildReport, LevelReport};
#[cfg(test)]
pub(crate) use subtree::{ROOM, SMALL, WAITING};

use crate::device::{Buffer, Device};
use crate::error::GpuError;
use crate::primitives::{radix, scan};
use crate::trace::Packed;
use arrays::Array;
use driver::{Finished, Terms};
use first::Start;
use gpu::Gpu;
use spare::Spare;

/// The parts that the kernels of the build share.
pub(crate) const PARTS: &[(&str, &str)] = &[
    ("advance", include_str!("advance.wgsl")),
    ("bases", include_str!("bases.wgsl")),
    ("kept", include_str!("kept.wgsl")),
    ("level", include_str!("level.wgsl")),
    ("offer", include_str!("offer.wgsl")),
    ("piece", include_str!("piece.wgsl")),
    ("polygon", include_str!("polygon.wgsl")),
    ("prices", include_str!("prices.wgsl")),
    ("route", include_str!("route.wgsl")),
    ("share", include_str!("share.wgsl")),
    ("span", include_str!("span.wgsl")),
    ("subtree", include_str!("subtree.wgsl")),
    ("sweep", include_str!("sweep.wgsl")),
    ("team", include_str!("team.wgsl")),
    ("triangle", include_str!("triangle.wgsl")),
];

/// The kernels of the build, in the order of their first use.
pub(crate) const KERNELS: &[&kernel::Kernel] = &[
    &seed::SEED,
    &flats::FLATS,
    &ends::ENDS,
    &join::JOIN,
    &finish::FINISH,
    &starts::STARTS,
    &price::PRICE,
    &choose::CHOOSE,
    &decide::DECIDE,
    &settle::SETTLE,
    &mark::MARK,
    &side::SIDE,
    &assign::ASSIGN,
    &pair::PAIR,
    &stow::STOW,
    &gather::GATHER,
    &clip::CLIP,
    &bear::BEAR,
    &name::NAME,
    &tally::TALLY,
    &renew::RENEW,
    &rank::RANK,
    &merge::MERGE,
    &place::PLACE,
    &keep::KEEP,
    &carry::CARRY,
    &part::PART,
    &weigh::WEIGH,
    &offset::OFFSET,
    &pack::PACK,
];

/// Bytes of the device for each triangle that a build keeps to if it is not told otherwise.
const BYTES_PER_TRIANGLE: u64 = 180;

/// The least that a build is given: below that, batches only cost time.
const LEAST_BYTES: u64 = 4 << 20;

/// How often a build that ran out of memory starts again with less of it in mind, before the last
/// time, when every batch is as small as it can be.
const RETRIES: usize = 2;

/// Builds the exact-SAH tree of `mesh` on a device, with the bytes of [`Tree::build`].
///
/// Costs O(N log N) work, at most 40 dispatches and one read of a few words for each level of the
/// tree. Of the options, builder and threads mean nothing here. Nodes near the root that are larger than
/// what the device can bind are made by the CPU ([`BuildReport::crown`]).
///
/// # Errors
///
/// [`GpuError`]: options without meaning, too little memory, or a device that fails.
///
/// ```no_run
/// use kdray::{BuildOptions, Mesh};
/// use kdray_gpu::{Device, Limits, Selection, build};
///
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(&positions, &[[0, 1, 2]])?;
/// let device = Device::open(&Selection::Best, &Limits::PORTABLE)?;
/// let tree = build(&device, &mesh, &BuildOptions::default())?;
/// assert_eq!(tree.nodes().len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn build(device: &Device, mesh: &Mesh, options: &BuildOptions) -> Result<Tree, GpuError> {
    Ok(build_reported(device, mesh, options, false)?.0)
}

/// [`build`], and what it took; with a profile of the kernels if that is asked for, which makes it
/// slower.
///
/// # Errors
///
/// As [`build`].
pub fn build_reported(
    device: &Device,
    mesh: &Mesh,
    options: &BuildOptions,
    with_profile: bool,
) -> Result<(Tree, BuildReport), GpuError> {
    let wanted = Wanted { with_profile, keeps_mesh: false };
    let start = Start::root(mesh, options)?;
    match build_in(Spare::default, device, &start, options, wanted) {
        Err(GpuError::Limit { .. }) => crown::build(device, mesh, options, with_profile),
        built => built.and_then(|(left, report, _)| Ok((left.tree.read(device, mesh)?, report))),
    }
}

/// What a build is to give beside the tree.
#[derive(Clone, Copy)]
struct Wanted {
    with_profile: bool,
    keeps_mesh: bool,
}

/// What a build leaves on the device.
struct Left {
    tree: Packed,
    /// Positions and triangles, if they were to stay.
    mesh: Option<[Buffer; 2]>,
}

/// Builds in the memory that `spare` gives, and hands it on. Where a level took more than was thought,
/// and more than there is, it starts again and cuts levels into smaller batches.
fn build_in(
    mut spare: impl FnMut() -> Spare,
    device: &Device,
    start: &Start,
    options: &BuildOptions,
    wanted: Wanted,
) -> Result<(Left, BuildReport, Spare), GpuError> {
    let mut room = budget(start.triangles.len(), options);
    for _ in 0..RETRIES {
        let limits = (options.memory_budget, room);
        let mut gpu = Gpu::new(device, spare(), limits, wanted.with_profile);
        match build_on(&mut gpu, start, options, (room, wanted.keeps_mesh)) {
            Err(error) if error.is_memory() => room = room / 4 * 3,
            built => return built.map(|(left, report)| (left, report, gpu.leave())),
        }
    }
    let mut gpu = Gpu::new(device, spare(), (options.memory_budget, 0), wanted.with_profile);
    let (left, report) = build_on(&mut gpu, start, options, (0, wanted.keeps_mesh))?;
    Ok((left, report, gpu.leave()))
}

fn build_on(
    gpu: &mut Gpu,
    start: &Start,
    options: &BuildOptions,
    (budget, keeps_mesh): (u64, bool),
) -> Result<(Left, BuildReport), GpuError> {
    let terms = Terms { budget, with_teams: true, keeps_mesh };
    let Finished { counts, levels } = driver::build(gpu, start, options, terms)?;
    gpu.submit()?;
    let [nodes, references] =
        [Array::TreeNodes, Array::TreeReferences].map(|array| gpu.hand_over(array));
    let tree = Packed { nodes, references, counts, cost: options.cost };
    let mesh = [Array::Positions, Array::Triangles];
    let mesh = keeps_mesh.then(|| mesh.map(|array| gpu.hand_over(array)));
    let report = BuildReport {
        peak_bytes: gpu.peak_bytes,
        tree_bytes: tree.size_bytes(),
        readbacks: gpu.readbacks,
        crown: 0,
        levels,
        profile: gpu.profile.take(),
    };
    Ok((Left { tree, mesh }, report))
}

/// Compiles the kernels of the build, which would otherwise happen during the first one.
///
/// # Errors
///
/// If a kernel is refused, or the device fails.
pub fn prepare(device: &Device) -> Result<(), GpuError> {
    let mut kernels: Vec<_> = KERNELS.iter().map(|kernel| &kernel.shader).collect();
    kernels.extend([&scan::REDUCE, &scan::APPLY, &radix::COUNT, &radix::SCATTER]);
    device.compile(&kernels)
}

/// The same with the twins of the kernels, on the CPU: for tests. Without teams, all levels are built
/// by the kernels of levels.
///
/// # Errors
///
/// As [`Tree::build`].
#[doc(hidden)]
pub fn build_with_twins(
    mesh: &Mesh,
    options: &BuildOptions,
    with_teams: bool,
) -> Result<Tree, BuildError> {
    let mut twins = cpu::Twins::default();
    let budget = budget(mesh.triangles().len(), options);
    let terms = Terms { budget, with_teams, keeps_mesh: false };
    let start = Start::root(mesh, options)?;
    let [nodes, references] = driver::build(&mut twins, &start, options, terms)?.counts;
    let nodes = &twins.arrays.of(Array::TreeNodes)[..nodes as usize];
    let references = &twins.arrays[Array::TreeReferences][..references as usize];
    Ok(Tree::from_parts(mesh, nodes.to_vec(), references.to_vec(), options.cost))
}

/// Bytes that the build of so many triangles should keep to.
fn budget(triangles: usize, options: &BuildOptions) -> u64 {
    let usual = BYTES_PER_TRIANGLE * triangles as u64;
    // Of a budget that must not be exceeded, an eighth is for what nobody can know beforehand.
    options.memory_budget.map_or(usual.max(LEAST_BYTES), |budget| budget / 8 * 7)
}
