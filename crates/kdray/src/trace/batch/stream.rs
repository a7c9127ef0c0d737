//! Lists of any length, a part at a time.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::options::Meter;
use super::{Batch, BatchError, CHUNK};

/// What some consecutive queries gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lists<'a, T> {
    /// The first of the queries.
    pub first: usize,
    /// Where each query's items begin in `items`, and, last, where those of the last one end.
    pub offsets: &'a [usize],
    /// The items of all of them.
    pub items: &'a [T],
}

impl<'a, T> Lists<'a, T> {
    /// The list of each query, in order.
    pub fn lists(&self) -> impl Iterator<Item = &'a [T]> + use<'a, T> {
        let items = self.items;
        self.offsets.windows(2).map(move |ends| &items[ends[0]..ends[1]])
    }
}

/// Items with which a thread stops asking and waits until they are taken. So a batch holds
/// this many a thread, and the lists of one group of queries more.
const ITEMS: usize = 1 << 16;

/// Queries that are asked together at first. A group grows as long as its lists are short, and
/// shrinks, to one query in the end, if they are long.
const GROUP: usize = 64;

/// What one thread has found, and not yet handed over.
pub(super) struct Found<T> {
    first: usize,
    offsets: Vec<usize>,
    items: Vec<T>,
    group: usize,
    /// For whoever makes lists of a group of queries one beside the other.
    pub(super) room: Vec<Vec<T>>,
}

impl<T: Copy> Found<T> {
    fn new() -> Self {
        let (offsets, items, room) = (Vec::new(), Vec::new(), Vec::new());
        Self { first: 0, offsets, items, group: GROUP, room }
    }

    fn lists(&self) -> Lists<'_, T> {
        Lists { first: self.first, offsets: &self.offsets, items: &self.items }
    }

    /// How many queries have been answered.
    fn count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Adds the list of the next query.
    #[inline]
    pub(super) fn add(&mut self, list: &[T]) {
        self.items.extend_from_slice(list);
        self.offsets.push(self.items.len());
    }

    /// Asks from `first` on, until all `queries` are answered or there are enough items.
    fn ask<Q>(&mut self, first: usize, queries: &[Q], ask: impl Fn(usize, &[Q], &mut Self)) {
        self.first = first;
        self.items.clear();
        self.offsets.clear();
        self.offsets.push(0);
        while self.count() < queries.len() && self.items.len() < ITEMS {
            let rest = &queries[self.count()..];
            self.ask_group(&rest[..self.group.min(rest.len())], &ask);
        }
    }

    fn ask_group<Q>(&mut self, queries: &[Q], ask: impl Fn(usize, &[Q], &mut Self)) {
        let (items, count) = (self.items.len(), self.count());
        ask(self.first + count, queries, self);
        assert_eq!(self.count() - count, queries.len(), "one list a query");
        match self.items.len() - items {
            many if many > ITEMS / 2 => self.group = (self.group / 2).max(1),
            few if few < ITEMS / 8 => self.group = (2 * self.group).min(CHUNK),
            _ => {}
        }
        // Room that one long list took is not kept for all.
        self.room.iter_mut().for_each(|list| list.shrink_to(ITEMS / CHUNK));
    }
}

impl Batch<'_> {
    /// Gives `sink` the list that `ask(queries[i])` makes for each query, in order, until it breaks.
    pub(super) fn stream<Q: Sync, T: Copy + Send>(
        &self,
        queries: &[Q],
        ask: impl Fn(&Q, &mut Vec<T>) + Sync,
        sink: impl FnMut(Lists<T>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        let ask_each = |_: usize, queries: &[Q], found: &mut Found<T>| {
            let mut list = found.room.pop().unwrap_or_default();
            for query in queries {
                ask(query, &mut list);
                found.add(&list);
            }
            found.room.push(list);
        };
        self.stream_groups(queries, ask_each, sink)
    }

    /// The same, where `ask(i, queries[i..i + n], found)` adds the lists of `n` queries.
    pub(super) fn stream_groups<Q: Sync, T: Copy + Send>(
        &self,
        queries: &[Q],
        ask: impl Fn(usize, &[Q], &mut Found<T>) + Sync,
        mut sink: impl FnMut(Lists<T>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        let meter = Meter::new(self, queries.len());
        let mut team: Vec<Found<T>> = (0..self.team.threads()).map(|_| Found::new()).collect();
        let round_length = CHUNK * team.len();
        for (round, queries) in queries.chunks(round_length).enumerate() {
            meter.check()?;
            let start = |member: usize| round * round_length + member * CHUNK;
            if let [alone] = &mut team[..] {
                // Another thread would have to be woken for every chunk.
                alone.ask(start(0), queries, &ask);
            } else {
                self.team.run(|| {
                    let work = team.par_iter_mut().zip(queries.par_chunks(CHUNK)).enumerate();
                    work.for_each(|(member, (found, queries))| {
                        found.ask(start(member), queries, &ask);
                    });
                });
            }
            for (member, (found, queries)) in team.iter_mut().zip(queries.chunks(CHUNK)).enumerate()
            {
                let handed = hand_over(found, start(member), queries, &meter, &ask, &mut sink);
                if handed?.is_break() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }
}

/// Gives `sink` what was found; where there were more items than one part may have, asks on.
fn hand_over<Q, T: Copy>(
    found: &mut Found<T>,
    start: usize,
    queries: &[Q],
    meter: &Meter,
    ask: impl Fn(usize, &[Q], &mut Found<T>),
    sink: &mut impl FnMut(Lists<T>) -> ControlFlow<()>,
) -> Result<ControlFlow<()>, BatchError> {
    let mut done = 0;
    loop {
        if sink(found.lists()).is_break() {
            return Ok(ControlFlow::Break(()));
        }
        meter.advance(found.count());
        done += found.count();
        if done == queries.len() {
            return Ok(ControlFlow::Continue(()));
        }
        meter.check()?;
        found.ask(start + done, &queries[done..], &ask);
    }
}
