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
/// this many a thread, and the list of one query more.
const ITEMS: usize = 1 << 16;

/// What one thread has found, and not yet handed over.
struct Found<T> {
    first: usize,
    offsets: Vec<usize>,
    items: Vec<T>,
    /// Those of one query.
    list: Vec<T>,
}

impl<T: Copy> Found<T> {
    fn new() -> Self {
        Self { first: 0, offsets: Vec::new(), items: Vec::new(), list: Vec::new() }
    }

    fn lists(&self) -> Lists<'_, T> {
        Lists { first: self.first, offsets: &self.offsets, items: &self.items }
    }

    /// How many queries have been answered.
    fn count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Asks from `first` on, until all `queries` are answered or there are enough items.
    fn ask<Q>(&mut self, first: usize, queries: &[Q], ask: impl Fn(usize, &Q, &mut Vec<T>)) {
        self.first = first;
        self.items.clear();
        self.offsets.clear();
        self.offsets.push(0);
        for (index, query) in queries.iter().enumerate() {
            if self.items.len() >= ITEMS {
                break;
            }
            ask(first + index, query, &mut self.list);
            self.items.extend_from_slice(&self.list);
            self.offsets.push(self.items.len());
        }
    }
}

impl Batch<'_> {
    /// Gives `sink` the list that `ask(i, queries[i])` makes for each query, in order, until it
    /// breaks.
    pub(super) fn stream<Q: Sync, T: Copy + Send>(
        &self,
        queries: &[Q],
        ask: impl Fn(usize, &Q, &mut Vec<T>) + Sync,
        mut sink: impl FnMut(Lists<T>) -> ControlFlow<()>,
    ) -> Result<(), BatchError> {
        let meter = Meter::new(&self.options, queries.len());
        let mut team: Vec<Found<T>> = (0..self.team.threads()).map(|_| Found::new()).collect();
        let round_length = CHUNK * team.len();
        for (round, queries) in queries.chunks(round_length).enumerate() {
            meter.check()?;
            let start = |member: usize| round * round_length + member * CHUNK;
            self.team.run(|| {
                let work = team.par_iter_mut().zip(queries.par_chunks(CHUNK)).enumerate();
                work.for_each(|(member, (found, queries))| {
                    found.ask(start(member), queries, &ask);
                });
            });
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
    ask: impl Fn(usize, &Q, &mut Vec<T>),
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
