//! An answer, or a list of them, for each of many items.

use bytemuck::Zeroable;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::zeros;
use crate::run::Watch;

/// Items that a thread takes at a time, and looks whether to go on.
const CHUNK: usize = 256;

/// By item what `ask` says of it.
pub(crate) fn each<T: Send + Zeroable>(
    count: usize,
    watch: &Watch,
    ask: impl Fn(usize) -> T + Sync,
) -> PyResult<Vec<T>> {
    let mut answers = zeros(count)?;
    answers.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, answers)| {
        if !watch.is_cancelled() {
            for (index, answer) in answers.iter_mut().enumerate() {
                *answer = ask(CHUNK * chunk + index);
            }
        }
    });
    Ok(answers)
}

/// By item a list: where each list begins, and the lists of a chunk of items together. `ask`
/// leaves an item's list in the vector, whatever was in there.
pub(crate) fn lists<T: Send + Copy>(
    count: usize,
    watch: &Watch,
    ask: impl Fn(usize, &mut Vec<T>) + Sync,
) -> PyResult<(Vec<i64>, Vec<Vec<T>>)> {
    let mut offsets: Vec<i64> = zeros(count + 1)?;
    let of_chunk = |(chunk, lengths): (usize, &mut [i64])| {
        let (mut all, mut list) = (Vec::new(), Vec::new());
        if !watch.is_cancelled() {
            for (index, length) in lengths.iter_mut().enumerate() {
                ask(CHUNK * chunk + index, &mut list);
                *length = list.len() as i64;
                all.extend_from_slice(&list);
            }
        }
        all
    };
    let lists = offsets[1..].par_chunks_mut(CHUNK).enumerate().map(of_chunk).collect();
    let mut end = 0;
    for offset in &mut offsets {
        end += *offset;
        *offset = end;
    }
    Ok((offsets, lists))
}
