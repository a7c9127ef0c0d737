//! One answer a query.

use rayon::prelude::*;

use super::options::Meter;
use super::{Batch, BatchError, CHUNK};

/// Queries that are brought in order together: what sorting them takes is bounded by this.
const WINDOW: usize = 1 << 18;

/// Queries that a thread answers together. `index` says which of the batch they are.
pub(super) struct Chunk<'a, Q> {
    pub(super) queries: &'a [Q],
    pub(super) index: &'a dyn Fn(usize) -> usize,
}

impl Batch<'_> {
    /// Writes to `answers[i]` what `ask(state, i, queries[i])` gives; what it keeps in `state` is
    /// there for the next query that it is asked. With `reorder` that is one with a similar `key`,
    /// near it.
    pub(super) fn fill<Q: Copy + Sync, A: Default + Send, S: Default>(
        &self,
        queries: &[Q],
        answers: &mut [A],
        reorder: bool,
        key: impl Fn(&Q) -> u32 + Sync,
        ask: impl Fn(&mut S, usize, &Q) -> A + Sync,
    ) -> Result<(), BatchError> {
        self.fill_chunks(queries, answers, reorder, key, |chunk, answers| {
            let mut state = S::default();
            for (place, (query, answer)) in chunk.queries.iter().zip(answers).enumerate() {
                *answer = ask(&mut state, (chunk.index)(place), query);
            }
        })
    }

    /// Writes to `answers` what `ask` writes, chunk by chunk.
    pub(super) fn fill_chunks<Q: Copy + Sync, A: Default + Send>(
        &self,
        queries: &[Q],
        answers: &mut [A],
        reorder: bool,
        key: impl Fn(&Q) -> u32 + Sync,
        ask: impl Fn(&Chunk<Q>, &mut [A]) + Sync,
    ) -> Result<(), BatchError> {
        assert_eq!(queries.len(), answers.len(), "one answer a query");
        let meter = Meter::new(self, queries.len());
        let (key, ask) = (&key, &ask);
        self.team.run(|| {
            if !reorder {
                return as_given(queries, answers, &meter, ask);
            }
            let windows = queries.chunks(WINDOW).zip(answers.chunks_mut(WINDOW));
            for (index, (queries, answers)) in windows.enumerate() {
                reordered(index * WINDOW, queries, answers, &meter, key, ask)?;
            }
            Ok(())
        })
    }
}

fn as_given<Q: Sync, A: Send>(
    queries: &[Q],
    answers: &mut [A],
    meter: &Meter,
    ask: impl Fn(&Chunk<Q>, &mut [A]) + Sync,
) -> Result<(), BatchError> {
    let chunks = queries.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).enumerate();
    chunks.try_for_each(|(chunk, (queries, answers))| {
        meter.check()?;
        ask(&Chunk { queries, index: &|place| chunk * CHUNK + place }, answers);
        meter.advance(queries.len());
        Ok(())
    })
}

/// `start` is the index of the first query.
fn reordered<Q: Copy + Sync, A: Default + Send>(
    start: usize,
    queries: &[Q],
    answers: &mut [A],
    meter: &Meter,
    key: impl Fn(&Q) -> u32 + Sync,
    ask: impl Fn(&Chunk<Q>, &mut [A]) + Sync,
) -> Result<(), BatchError> {
    // The key above the index: one number sorts faster than two.
    let keyed = |(index, query)| u64::from(key(query)) << 32 | index as u64;
    let mut order: Vec<u64> = queries.par_iter().enumerate().map(keyed).collect();
    order.par_sort_unstable();
    let index_of = |keyed: &u64| *keyed as u32 as usize;
    let asked = order.par_chunks(CHUNK).map(|chunk| {
        meter.check()?;
        let here: Vec<Q> = chunk.iter().map(|keyed| queries[index_of(keyed)]).collect();
        let mut found: Vec<A> = chunk.iter().map(|_| A::default()).collect();
        let index = |place: usize| start + index_of(&chunk[place]);
        ask(&Chunk { queries: &here, index: &index }, &mut found);
        meter.advance(chunk.len());
        Ok(found)
    });
    let asked: Vec<Vec<A>> = asked.collect::<Result<_, BatchError>>()?;
    for (keyed, answer) in order.iter().zip(asked.into_iter().flatten()) {
        answers[index_of(keyed)] = answer;
    }
    Ok(())
}
