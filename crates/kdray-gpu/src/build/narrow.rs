//! Nodes that are too large for the events of all axes at once.
//!
//! A level is *narrow* if it is one node whose references have bounds, and no events. These are made
//! for one axis at a time, swept, and given back: 64 bytes a reference, where a level with events and
//! its children take 130. Children are narrow levels of their own, until there is room for their
//! events. It takes sorting each anew, and gives the same planes.

use super::arrays::Array;
use super::data::{Best, Part, Plan};
use super::driver::{Driver, Level, NEXT_LEVEL, words};
use super::executor::Executor;
use super::{carry, choose, part, price, settle, starts};

impl<E: Executor> Driver<'_, E> {
    /// Splits the node of a narrow level, and parks its right child.
    pub(super) fn narrow(&mut self, level: Level) -> Result<Option<[Level; 2]>, E::Error> {
        let Some(next) = self.level(level)? else { return Ok(None) };
        self.device.free(Array::References);
        self.device.stage("part", level.depth);
        let [left, right] = [self.params.left, self.params.right];
        let [left, right] = [left, right].map(|kept| kept + self.params.straddlers);
        // Until the left ones are there, the right ones' bounds are where nobody needs anything.
        self.carry(1, right)?;
        self.device.swap(Array::NextBounds, Array::NextEvents);
        self.carry(0, left)?;
        self.device.free(Array::Bounds);
        self.device.free(Array::Marks);
        self.device.swap(Array::Bounds, Array::NextBounds);
        self.device.swap(Array::References, Array::NextReferences);
        self.device.swap(Array::Nodes, Array::NextNodes);
        let child = |references, first_record| Level { references, first_record, nodes: 1, ..next };
        let front = child(left, next.first_record);
        let back = child(right, next.first_record + 1);
        self.params.has_bounds = 1;
        self.device.swap(Array::NextBounds, Array::NextEvents);
        self.pick(&back, 1)?;
        self.device.park(&NEXT_LEVEL);
        self.pick(&front, 0)?;
        self.device.swap(Array::Bounds, Array::NextBounds);
        self.descend();
        NEXT_LEVEL.into_iter().for_each(|array| self.device.free(array));
        Ok(Some([front, back]))
    }

    /// Makes the bounds of the references of one child, of which there are `most` at most.
    fn carry(&mut self, side: u32, most: u32) -> Result<(), E::Error> {
        self.params.first_node = side;
        self.device.reserve(Array::NextBounds, words::<Part>(most))?;
        self.run(&carry::CARRY, self.params.references())
    }

    /// Copies the references of one child to where the next level will be.
    fn pick(&mut self, child: &Level, node: u32) -> Result<(), E::Error> {
        self.device.free(Array::NextReferences);
        self.device.free(Array::NextNodes);
        self.reserve_next(child)?;
        self.params.nodes = 1;
        self.params.first_node = node;
        self.params.next_events = 2 * child.references;
        for array in [Array::Events, Array::NextEvents] {
            self.device.reserve(array, 0)?;
        }
        self.run(&part::PART, child.references.max(1))
    }

    /// Finds the cheapest plane of the node of a narrow level, one axis after the other.
    pub(super) fn sweep_narrow(&mut self, level: Level) -> Result<(), E::Error> {
        self.device.reserve(Array::Inner, 3)?;
        self.device.clear(Array::Inner, 3)?;
        self.device.reserve(Array::Plans, words::<Plan>(1))?;
        self.device.clear(Array::Plans, words::<Plan>(1))?;
        self.device.reserve(Array::Best, words::<Best>(1))?;
        self.params.has_bounds = level.has_bounds();
        self.params.axis = 2;
        let axes = if self.params.may_split == 1 { 0..3 } else { 0..0 };
        for axis in axes.clone() {
            self.params.base_axis = axis;
            self.device.stage("events", level.depth);
            self.sort_axis(&level, axis)?;
            self.free_sorted();
            self.device.stage("sweep", level.depth);
            let chunks = self.params.event_chunks();
            self.device.reserve(Array::Sums, 6 * chunks as usize + 1)?;
            self.device.reserve(Array::Lows, chunks as usize)?;
            self.device.clear(Array::Best, words::<Best>(1))?;
            self.run(&starts::STARTS, chunks)?;
            self.device.scan(Array::Sums, chunks)?;
            self.run(&price::PRICE, chunks)?;
            self.run(&choose::CHOOSE, chunks)?;
            self.run(&settle::SETTLE, 1)?;
            self.device.free(Array::Events);
        }
        if axes.is_empty() {
            self.device.reserve(Array::Events, 0)?;
            self.device.reserve(Array::Sums, 6 * self.params.event_chunks() as usize + 1)?;
            self.device.clear(Array::Best, words::<Best>(1))?;
            self.run(&settle::SETTLE, 1)?;
        }
        self.params.base_axis = 0;
        self.device.free(Array::Events);
        self.device.reserve(Array::Bounds, 0)?;
        self.device.scan(Array::Inner, 3)
    }
}
