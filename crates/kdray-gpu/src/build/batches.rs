//! Levels in batches, where memory is short \[Hou11].

use super::arrays::Array;
use super::data::{Best, Event, Node, Pair, Part, Plan, Record, Reference};
use super::driver::{Driver, Level, NEXT_LEVEL, words};
use super::executor::Executor;
use super::part;

/// Levels of fewer references are not halved: there is nothing to gain.
const SMALL: u32 = 4096;

impl Level {
    /// Bytes of its arrays.
    fn bytes(&self) -> u64 {
        let known = if self.is_narrow { size_of::<Part>() } else { 6 * size_of::<Event>() };
        u64::from(self.references) * (size_of::<Reference>() + known) as u64
            + u64::from(self.nodes) * size_of::<Node>() as u64
    }

    /// Bytes to build the next level from it, with events: both, and what is known of every node
    /// between.
    fn working_bytes(&self) -> u64 {
        let known = size_of::<Best>() + size_of::<Plan>() + size_of::<Pair>();
        let wide = Self { is_narrow: false, ..*self };
        5 * wide.bytes() / 2 + u64::from(self.nodes) * known as u64
    }

    /// Bytes of the events of the next level, at most: every reference may straddle.
    fn next_event_bytes(&self) -> u64 {
        12 * u64::from(self.references) * size_of::<Event>() as u64
    }
}

impl<E: Executor> Driver<'_, E> {
    /// Whether building on from `level` with events, with others waiting, takes too much memory, and
    /// some of its nodes can wait.
    pub(super) fn is_too_large(&self, level: &Level, parked: &[Level]) -> bool {
        level.nodes > 1 && !self.has_room(level, parked)
    }

    /// Whether building on from `level` with events, with others waiting, takes no more memory than
    /// there is, and no array more than the device can bind.
    pub(super) fn has_room(&self, level: &Level, parked: &[Level]) -> bool {
        let finished = words::<Record>(self.params.next_records) + self.params.finished as usize;
        let parked: u64 = parked.iter().map(Level::bytes).sum();
        let bytes = 4 * finished as u64 + parked + level.working_bytes();
        let fits = bytes <= self.room && level.next_event_bytes() <= self.device.most_bytes();
        level.references <= SMALL || fits
    }

    /// Parks the second half of a level's nodes.
    pub(super) fn halve(&mut self, level: &Level) -> Result<[Level; 2], E::Error> {
        self.device.stage("part", level.depth);
        let middle = level.nodes / 2;
        let first_word = words::<Node>(middle) + std::mem::offset_of!(Node, first) / 4;
        let start = self.device.read(&[(Array::Nodes, first_word as u32)])?[0];
        let back = Level {
            nodes: level.nodes - middle,
            references: level.references - start,
            first_record: level.first_record + middle,
            depth: level.depth,
            is_narrow: false,
        };
        let front = Level { nodes: middle, references: start, ..*level };
        self.params.events = 2 * level.references;
        self.part(&back, middle)?;
        self.device.park(&NEXT_LEVEL);
        self.part(&front, 0)?;
        self.descend();
        NEXT_LEVEL.into_iter().for_each(|array| self.device.free(array));
        Ok([front, back])
    }

    /// Copies a part of the level to where the next one will be.
    fn part(&mut self, part: &Level, node: u32) -> Result<(), E::Error> {
        NEXT_LEVEL.into_iter().for_each(|array| self.device.free(array));
        self.reserve_next(part)?;
        self.params.next_events = 2 * part.references;
        self.params.nodes = part.nodes;
        self.params.has_bounds = 0;
        self.params.first_node = node;
        self.device.reserve(Array::NextEvents, words::<Event>(6 * part.references))?;
        self.run(&part::PART, part.references.max(part.nodes))
    }
}
