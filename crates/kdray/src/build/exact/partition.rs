//! Deal the events of a sorted list out to two children, and merge new ones in.

use super::event::Event;

/// A reference's name in its child, with the child in the two highest bits.
pub(super) const TO_RIGHT: u32 = 1 << 30;
pub(super) const TO_NONE: u32 = 1 << 31;

/// Events are dealt out this many at a time, and written so many to each list, whoever gets them:
/// lists have places to spare.
pub(super) const SPARE: usize = 8;

/// Sends every event where its reference went, under its name there; gives the lengths of the
/// lists, which keep the order. `names` has a name for every reference of the events.
pub(super) fn partition(
    events: &[Event],
    names: &[u32],
    [left, right]: [&mut [Event]; 2],
) -> [usize; 2] {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
        let (chunks, rest) = events.as_chunks::<SPARE>();
        // SAFETY: the processor has what is asked for.
        let [lefts, rights] = unsafe { avx512::partition(chunks, names, [left, right]) };
        let ends = [&mut left[lefts..], &mut right[rights..]];
        let [more_left, more_right] = partition_each(rest, names, ends);
        return [lefts + more_left, rights + more_right];
    }
    partition_each(events, names, [left, right])
}

/// One event after the other. Branch-free: both lists are written at their end, and the one that
/// gets the event grows.
#[inline(always)]
fn partition_each(events: &[Event], names: &[u32], [left, right]: [&mut [Event]; 2]) -> [usize; 2] {
    let (mut lefts, mut rights) = (0, 0);
    for event in events {
        let name = names[event.reference()];
        let renamed = event.renamed(name);
        left[lefts] = renamed;
        right[rights] = renamed;
        lefts += usize::from(name < TO_RIGHT);
        rights += usize::from(name & (TO_RIGHT | TO_NONE) == TO_RIGHT);
    }
    [lefts, rights]
}

/// Merges sorted `fresh` events into the first `len` of a sorted list, which has room for them.
pub(super) fn merge(list: &mut [Event], len: usize, fresh: &[Event]) {
    // From the back: the last `index` fresh events are where they belong, and so is what follows.
    let mut until = len;
    for (index, event) in fresh.iter().enumerate().rev() {
        let from = place_of(*event, &list[..until]);
        list.copy_within(from..until, from + index + 1);
        list[from + index] = *event;
        until = from;
    }
}

/// How many events of a sorted list come before `event`, looked for from the end of the list.
fn place_of(event: Event, list: &[Event]) -> usize {
    let is_before = |old: &Event| old.order() <= event.order();
    let (mut end, mut step) = (list.len(), 1);
    while step <= end && !is_before(&list[end - step]) {
        end -= step;
        step *= 2;
    }
    let start = end.saturating_sub(step);
    start + list[start..end].partition_point(is_before)
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use std::arch::x86_64::*;

    use super::super::event::Event;
    use super::{SPARE, TO_NONE, TO_RIGHT};

    /// [`super::partition`] for whole chunks.
    #[target_feature(enable = "avx512f,avx512vl")]
    pub(super) fn partition(
        chunks: &[[Event; SPARE]],
        names: &[u32],
        [left, right]: [&mut [Event]; 2],
    ) -> [usize; 2] {
        let name_bits = _mm512_set1_epi64(i64::from(TO_RIGHT - 1));
        let child_bits = _mm512_set1_epi64(i64::from(TO_RIGHT | TO_NONE));
        let to_right = _mm512_set1_epi64(i64::from(TO_RIGHT));
        let bound = _mm512_set1_epi64(names.len() as i64);
        let (mut lefts, mut rights) = (0, 0);
        for chunk in chunks {
            assert!(lefts + SPARE <= left.len() && rights + SPARE <= right.len());
            // SAFETY: a chunk has the size of a vector.
            let events = unsafe { _mm512_loadu_si512(chunk.as_ptr().cast()) };
            let references = _mm512_and_si512(events, name_bits);
            let known = _mm512_cmplt_epu64_mask(references, bound);
            let zero = _mm256_setzero_si256();
            let indices = _mm512_cvtepi64_epi32(references);
            // SAFETY: only names below the number of names are read.
            let names = unsafe {
                _mm256_mmask_i32gather_epi32::<4>(zero, known, indices, names.as_ptr().cast())
            };
            let names = _mm512_cvtepu32_epi64(names);
            // Where a bit is the name's, that one, else the event's.
            let renamed = _mm512_ternarylogic_epi64::<0xca>(name_bits, names, events);
            let child = _mm512_and_si512(names, child_bits);
            let is_left = _mm512_testn_epi64_mask(child, child);
            let is_right = _mm512_cmpeq_epi64_mask(child, to_right);
            // SAFETY: both lists have room for a vector, as was just checked.
            unsafe {
                let ends = [left.as_mut_ptr().add(lefts), right.as_mut_ptr().add(rights)];
                let of_left = _mm512_maskz_compress_epi64(is_left, renamed);
                let of_right = _mm512_maskz_compress_epi64(is_right, renamed);
                _mm512_storeu_si512(ends[0].cast(), of_left);
                _mm512_storeu_si512(ends[1].cast(), of_right);
            }
            lefts += is_left.count_ones() as usize;
            rights += is_right.count_ones() as usize;
        }
        [lefts, rights]
    }
}

#[cfg(test)]
mod tests {
    use super::super::event::Kind;
    use super::*;

    /// Events at 0, 0, 1, 1, 2, 2 and so on, of references in turn.
    fn events(count: u32, references: u32) -> Vec<Event> {
        let event = |k| Event::new((k / 2) as f32, Kind::Start, k * 7 % references);
        (0..count).map(event).collect()
    }

    #[test]
    fn many_at_a_time_go_where_each_goes() {
        let names: Vec<u32> =
            (0..13).map(|name| name | [0, TO_RIGHT, TO_NONE, 0][name as usize % 4]).collect();
        for count in [0, 1, 7, 8, 9, 40, 100] {
            let events = events(count, 13);
            let room = || vec![Event::new(0.0, Kind::End, 0); events.len() + SPARE];
            let (mut left, mut right) = (room(), room());
            let (mut expected_left, mut expected_right) = (room(), room());
            let lengths = partition(&events, &names, [&mut left, &mut right]);
            let expected =
                partition_each(&events, &names, [&mut expected_left, &mut expected_right]);
            assert_eq!(lengths, expected);
            assert_eq!(left[..lengths[0]], expected_left[..lengths[0]]);
            assert_eq!(right[..lengths[1]], expected_right[..lengths[1]]);
        }
    }

    #[test]
    fn merged_lists_are_sorted() {
        for (old, new) in [(0, 0), (0, 3), (5, 0), (50, 1), (50, 9), (3, 40)] {
            let mut fresh: Vec<Event> = (0..new)
                .map(|k| Event::new((k * 37 % 29) as f32 - 0.5 * (k % 2) as f32, Kind::End, k))
                .collect();
            fresh.sort_unstable();
            let mut list = events(old, 13);
            let mut expected = [&list[..], &fresh].concat();
            list.resize((old + new) as usize, Event::new(0.0, Kind::End, 0));
            merge(&mut list, old as usize, &fresh);
            expected.sort_unstable();
            assert!(list.is_sorted_by_key(|event| event.order()));
            list.sort_unstable();
            assert_eq!(list, expected);
        }
    }
}
