//! The build, level by level, whoever runs the kernels.

use std::sync::atomic::Ordering;

use kdray::{BuildError, BuildOptions};

use super::arrays::Array;
use super::data::{Best, Event, HEADER, MOST, Node, Pair, Part, Plan, Record, Reference};
use super::executor::Executor;
use super::first::Start;
use super::kernel::{Kernel, Params};
use super::piece::PIECE;
use super::rank::RUN;
use super::report::LevelReport;
use super::route::ROUTES;
use super::{assign, bear, choose, clip, decide, finish, gather, keep, mark, merge, name};
use super::{pair, place, price, rank, renew, side, starts, stow, tally};
use crate::record::Moved;

/// How a tree is built; it is the same tree.
#[derive(Clone, Copy)]
pub(crate) struct Terms {
    /// Bytes that the build keeps to as far as single nodes allow.
    pub(crate) budget: u64,
    /// Whether teams finish small subtrees.
    pub(crate) with_teams: bool,
    /// Whether the mesh stays when the tree is finished.
    pub(crate) keeps_mesh: bool,
}

/// A finished tree, in the arrays that its name says.
pub(crate) struct Finished {
    /// How many nodes and references it has.
    pub(crate) counts: [u32; 2],
    pub(crate) levels: Vec<LevelReport>,
}

/// Builds the tree below a node.
pub(crate) fn build<E: Executor>(
    device: &mut E,
    start: &Start,
    options: &BuildOptions,
    terms: Terms,
) -> Result<Finished, E::Error> {
    let limits = start.limits;
    let triangles = start.triangles.len() as u32;
    let params = Params {
        max_leaf: u32::try_from(limits.max_leaf).unwrap_or(u32::MAX),
        clip: u32::from(limits.clip),
        traversal: limits.cost.traversal,
        intersect: limits.cost.intersect,
        empty_factor: 1.0 - limits.cost.empty_bonus,
        triangles,
        next_records: 1,
        ..Params::default()
    };
    let room = terms.budget.saturating_sub(start.mesh_bytes());
    let (levels, reports) = (Vec::new(), Vec::new());
    let max_depth = limits.max_depth;
    let most_references = triangles;
    let mut driver = Driver {
        device,
        params,
        max_depth,
        levels,
        reports,
        most_references,
        done: 0,
        room,
        terms,
    };
    let first = driver.first(start)?;
    driver.levels(first, options)?;
    let finished = driver.pack()?;
    if let Some(report) = options.progress {
        report(1.0);
    }
    Ok(finished)
}

/// Nodes of one depth.
#[derive(Clone, Copy)]
pub(super) struct Level {
    pub(super) nodes: u32,
    /// The most references that they have.
    pub(super) references: u32,
    /// Of the nodes.
    pub(super) first_record: u32,
    pub(super) depth: u32,
    /// Whether it is one node that has no events.
    pub(super) is_narrow: bool,
}

/// The arrays of a level.
const LEVEL: [Array; 4] = [Array::References, Array::Events, Array::Nodes, Array::Bounds];
pub(super) const NEXT_LEVEL: [Array; 4] =
    [Array::NextReferences, Array::NextEvents, Array::NextNodes, Array::NextBounds];

/// The most records that their indices can name.
pub(super) const MOST_RECORDS: u32 = (1 << 30) - 1;

pub(super) struct Driver<'a, E> {
    pub(super) device: &'a mut E,
    pub(super) params: Params,
    max_depth: u32,
    /// By level: its first record and how many it has.
    pub(super) levels: Vec<[u32; 2]>,
    pub(super) reports: Vec<LevelReport>,
    /// What a node of the level has at most.
    most_references: u32,
    /// References that have come to a leaf.
    done: u64,
    /// Bytes for everything but the mesh.
    pub(super) room: u64,
    pub(super) terms: Terms,
}

/// Words of `count` elements.
pub(super) fn words<T>(count: u32) -> usize {
    count as usize * size_of::<T>() / size_of::<u32>()
}

pub(super) fn too_large<E: From<BuildError>>() -> E {
    BuildError::TreeTooLarge { what: "nodes", limit: MOST_RECORDS as usize }.into()
}

impl Level {
    /// 1 if its references have bounds of their own: those of the root are their triangles'.
    pub(super) fn has_bounds(&self) -> u32 {
        u32::from(self.is_narrow && self.depth > 0)
    }
}

impl<E: Executor> Driver<'_, E> {
    pub(super) fn run(&mut self, kernel: &'static Kernel, count: u32) -> Result<(), E::Error> {
        self.params.count = count;
        self.device.run(kernel, &self.params)
    }

    /// Sorts the new events of each child; the longest list has at most `longest`.
    fn sort_fresh(&mut self, longest: u32) -> Result<(), E::Error> {
        let count = 3 * self.params.fresh_events;
        self.run(&rank::RANK, count)?;
        self.device.swap(Array::Fresh, Array::NextFresh);
        self.params.run = RUN;
        while self.params.run < longest {
            self.run(&merge::MERGE, count)?;
            self.device.swap(Array::Fresh, Array::NextFresh);
            self.params.run *= 2;
        }
        Ok(())
    }

    /// Makes the next level this one.
    pub(super) fn descend(&mut self) {
        for (next, this) in NEXT_LEVEL.into_iter().zip(LEVEL) {
            self.device.swap(next, this);
        }
    }

    /// Builds all levels from one on; where memory is short, in batches \[Hou11].
    fn levels(&mut self, first: Level, options: &BuildOptions) -> Result<(), E::Error> {
        let mut parked: Vec<Level> = Vec::new();
        let mut level = first;
        loop {
            if options.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                return Err(BuildError::Cancelled.into());
            }
            if level.is_narrow && self.has_room(&level, &parked) {
                level = self.widen(level)?;
            }
            while self.is_too_large(&level, &parked) {
                let [front, back] = self.halve(&level)?;
                parked.push(back);
                level = front;
            }
            self.report_progress(&level, &parked, options);
            if let Some(next) = self.below(level, &mut parked)? {
                level = next;
            } else if let Some(next) = parked.pop() {
                self.device.unpark(&LEVEL);
                level = next;
            } else {
                return Ok(());
            }
        }
    }

    /// Builds a level, and gives the next of its own; of a narrow level the right half waits.
    fn below(&mut self, level: Level, parked: &mut Vec<Level>) -> Result<Option<Level>, E::Error> {
        if !level.is_narrow {
            let next = self.level(level)?;
            self.descend();
            return Ok(next);
        }
        let children = self.narrow(level)?;
        Ok(children.map(|[front, back]| {
            parked.push(back);
            front
        }))
    }

    /// Says how many of the references known so far have come to a leaf, or how close they are.
    fn report_progress(&self, level: &Level, parked: &[Level], options: &BuildOptions) {
        let Some(report) = options.progress else { return };
        let finished = self.done as f64;
        let (mut done, mut all) = (finished, finished);
        for level in parked.iter().chain([level]) {
            let references = f64::from(level.references);
            done += references * f64::from(level.depth) / f64::from(self.max_depth.max(1));
            all += references;
        }
        report((done / all.max(1.0)) as f32);
    }

    /// Makes room for the references and nodes of the next level.
    pub(super) fn reserve_next(&mut self, next: &Level) -> Result<(), E::Error> {
        self.device.reserve(Array::NextNodes, words::<Node>(next.nodes))?;
        self.device.reserve(Array::NextReferences, HEADER + words::<Reference>(next.references))
    }

    /// Splits the nodes of a level and gives the next, if there is one.
    pub(super) fn level(&mut self, level: Level) -> Result<Option<Level>, E::Error> {
        self.params.records = level.first_record;
        self.params.nodes = level.nodes;
        self.params.events = 2 * level.references;
        self.params.depth_left = self.max_depth - level.depth;
        self.params.may_split = u32::from(self.params.depth_left > 0);
        self.levels.push([level.first_record, level.nodes]);
        self.device.reserve(Array::Moved, 2)?;
        self.device.clear(Array::Moved, 2)?;
        if level.is_narrow {
            self.sweep_narrow(level)?;
        } else {
            self.sweep(level)?;
        }
        let inner = self.assign(level)?;
        self.finish_leaves(level, inner)?;
        self.params.next_nodes = 2 * inner;
        let next = Level {
            nodes: 2 * inner,
            references: self.params.left + self.params.right + 2 * self.params.straddlers,
            first_record: self.params.next_records,
            depth: level.depth + 1,
            is_narrow: level.is_narrow,
        };
        self.split(level, next)?;
        if inner > 0 && !level.is_narrow {
            self.sort(next)?;
        }
        self.params.next_records += 2 * inner;
        if self.params.next_records > MOST_RECORDS {
            return Err(too_large());
        }
        self.params.finished += self.params.leaf + self.params.piece_words;
        self.done += u64::from(self.params.leaf + self.params.gone);
        Ok((inner > 0).then_some(next))
    }

    /// Finds the cheapest plane of every node that is not finished with all that is below it.
    fn sweep(&mut self, level: Level) -> Result<(), E::Error> {
        self.device.stage("finish", level.depth);
        let chunks = self.params.event_chunks();
        self.device.reserve(Array::Inner, 2 * level.nodes as usize + 1)?;
        self.device.clear(Array::Inner, 2 * level.nodes as usize + 1)?;
        if self.params.may_split == 1 && self.terms.with_teams {
            self.device.reserve(Array::NextEvents, (PIECE * level.references) as usize)?;
            self.run(&finish::FINISH, level.nodes)?;
        }
        self.device.stage("sweep", level.depth);
        self.device.reserve(Array::Sums, 6 * chunks as usize + 1)?;
        self.device.reserve(Array::Lows, 3 * chunks as usize)?;
        self.device.reserve(Array::Best, words::<Best>(level.nodes))?;
        self.device.reserve(Array::Plans, words::<Plan>(level.nodes))?;
        self.device.clear(Array::Best, words::<Best>(level.nodes))?;
        if self.params.may_split == 1 {
            self.run(&starts::STARTS, 3 * chunks)?;
            self.device.scan(Array::Sums, 3 * chunks)?;
            self.run(&price::PRICE, 3 * chunks)?;
            self.run(&choose::CHOOSE, 3 * chunks)?;
        }
        self.run(&decide::DECIDE, level.nodes + 1)?;
        self.device.scan(Array::Inner, 2 * level.nodes + 1)
    }

    /// Counts where references go; gives the number of inner nodes.
    fn assign(&mut self, level: Level) -> Result<u32, E::Error> {
        self.device.stage("split", level.depth);
        self.device.reserve(Array::Marks, level.references as usize)?;
        self.device.clear(Array::Marks, level.references as usize)?;
        if level.is_narrow {
            self.run(&side::SIDE, level.references)?;
        } else {
            self.run(&mark::MARK, 2 * level.references)?;
        }
        let chunks = self.params.reference_chunks();
        self.run(&assign::ASSIGN, chunks)?;
        self.device.scan(Array::Sums, ROUTES * chunks + 1)?;
        let mut places: Vec<_> = (0..=ROUTES).map(|way| (Array::Sums, way * chunks)).collect();
        places.extend([1, 2].map(|end| (Array::Inner, end * level.nodes)));
        places.extend(MOST.map(|word| (Array::References, word)));
        places.extend([0, 1].map(|word| (Array::Moved, word)));
        let read = self.device.read(&places)?;
        let counts: Vec<u32> = read[..6].windows(2).map(|ends| ends[1] - ends[0]).collect();
        self.params.straddlers = counts[0];
        self.params.left = counts[1];
        self.params.right = counts[2];
        self.params.leaf = counts[3];
        self.params.gone = counts[4];
        let inner = read[6];
        self.params.piece_words = read[7] - inner;
        self.reports.push(LevelReport {
            depth: level.depth,
            nodes: level.nodes,
            references: self.params.references(),
            finished: counts[4],
            clipped: counts[0],
            largest_bucket: 2 * read[9],
        });
        self.most_references = read[8];
        let [read, written] = [read[10], read[11]].map(|words| 4 * u64::from(words));
        self.device.charge(("finish", level.depth), Moved { read, written });
        Ok(inner)
    }

    /// Puts the references of leaves where they stay until the tree is packed.
    fn finish_leaves(&mut self, level: Level, inner: u32) -> Result<(), E::Error> {
        let finished = self.params.finished + self.params.leaf + self.params.piece_words;
        self.device.grow(Array::Finished, finished as usize)?;
        self.device.grow(Array::Records, words::<Record>(self.params.next_records + 2 * inner))?;
        self.device.reserve(Array::Pairs, words::<Pair>(inner))?;
        self.device.reserve(Array::Straddlers, self.params.straddlers as usize)?;
        self.run(&pair::PAIR, level.nodes)?;
        if self.params.piece_words > 0 {
            self.device.stage("finish", level.depth);
            self.run(&stow::STOW, level.nodes)?;
            self.device.stage("split", level.depth);
        }
        self.run(&gather::GATHER, self.params.reference_chunks())
    }

    /// Clips the straddlers and gives all references their places in the next level.
    fn split(&mut self, level: Level, next: Level) -> Result<(), E::Error> {
        let straddlers = self.params.straddlers;
        self.device.stage("clip", level.depth);
        self.device.reserve(Array::Parts, words::<[Part; 2]>(straddlers))?;
        self.device.reserve(Array::Exists, 2 * straddlers as usize + 1)?;
        self.device.reserve(Array::Places, words::<[u32; 2]>(straddlers))?;
        self.reserve_next(&next)?;
        self.device.clear(Array::NextReferences, HEADER)?;
        self.run(&clip::CLIP, straddlers + 1)?;
        self.device.scan(Array::Exists, 2 * straddlers + 1)?;
        self.device.stage("split", level.depth);
        self.run(&bear::BEAR, level.nodes)?;
        if next.nodes > 0 {
            self.run(&name::NAME, self.params.reference_chunks())?;
        }
        Ok(())
    }

    /// Sorts the events of the next level: what is new, and that into what is kept.
    fn sort(&mut self, next: Level) -> Result<(), E::Error> {
        let straddlers = self.params.straddlers;
        self.device.stage("sort", next.depth - 1);
        self.params.next_events = 2 * next.references;
        self.params.fresh_events = 4 * straddlers;
        let chunks = self.params.event_chunks();
        self.device.reserve(Array::NextEvents, words::<Event>(3 * self.params.next_events))?;
        self.device.reserve(Array::Fresh, words::<Event>(3 * self.params.fresh_events))?;
        self.device.reserve(Array::NextFresh, words::<Event>(3 * self.params.fresh_events))?;
        self.run(&tally::TALLY, 3 * chunks)?;
        self.device.scan(Array::Sums, 6 * chunks)?;
        if straddlers > 0 {
            self.run(&renew::RENEW, 2 * straddlers)?;
            self.sort_fresh(2 * straddlers.min(self.most_references))?;
            self.run(&place::PLACE, 3 * self.params.fresh_events)?;
        }
        self.run(&keep::KEEP, 3 * chunks)
    }
}
