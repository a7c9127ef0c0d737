//! Levels in batches, where memory is short \[Hou11].

use super::arrays::Array;
use super::data::{Best, Event, Node, Pair, Plan, Record, Reference};
use super::driver::{Driver, Level, NEXT_LEVEL, words};
use super::executor::Executor;
use super::part;

/// Levels of fewer references are not halved: there is nothing to gain.
const SMALL: u32 = 4096;

impl Level {
    /// Bytes of its arrays.
    fn bytes(&self) -> u64 {
        u64::from(self.references) * (size_of::<Reference>() + 6 * size_of::<Event>()) as u64
            + u64::from(self.nodes) * size_of::<Node>() as u64
    }

    /// Bytes to build the next level from it: both, and what is known of every node between.
    fn working_bytes(&self) -> u64 {
        let known = size_of::<Best>() + size_of::<Plan>() + size_of::<Pair>();
        5 * self.bytes() / 2 + u64::from(self.nodes) * known as u64
    }
}

impl<E: Executor> Driver<'_, E> {
    /// Whether building on from `level`, with others waiting, would take too much memory.
    pub(super) fn is_too_large(&self, level: &Level, parked: &[Level]) -> bool {
        let finished = words::<Record>(self.params.next_records) + self.params.finished as usize;
        let parked: u64 = parked.iter().map(Level::bytes).sum();
        let bytes = 4 * finished as u64 + parked + level.working_bytes();
        level.nodes > 1 && level.references > SMALL && bytes > self.room
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
        };
        let front = Level { nodes: middle, references: start, ..*level };
        self.params.events = 2 * level.references;
        self.part(&back, [start, middle])?;
        self.device.park(&NEXT_LEVEL);
        self.part(&front, [0, 0])?;
        self.descend();
        NEXT_LEVEL.into_iter().for_each(|array| self.device.free(array));
        Ok([front, back])
    }

    /// Copies a part of the level to where the next one will be.
    fn part(&mut self, part: &Level, [reference, node]: [u32; 2]) -> Result<(), E::Error> {
        NEXT_LEVEL.into_iter().for_each(|array| self.device.free(array));
        self.reserve_next(part)?;
        self.params.next_events = 2 * part.references;
        self.params.nodes = part.nodes;
        self.params.first_reference = reference;
        self.params.first_node = node;
        self.device.reserve(Array::NextEvents, words::<Event>(6 * part.references))?;
        self.run(&part::PART, part.references.max(part.nodes))
    }
}
