//! Sort events by radix: once for each axis of the whole mesh.

use super::event::Event;
use crate::memory::zeros_in_huge_pages;

/// Bits of a digit. Three digits hold position and kind; more of them would be smaller, and their
/// buckets would fit the first cache.
const DIGIT: u32 = 12;
const BUCKETS: usize = 1 << DIGIT;
const DIGITS: usize = 3;

/// Fewer events than this are sorted by comparing.
const FEW: usize = 4 * BUCKETS;

/// Bytes that [`sort`] takes beside those of `count` events.
pub(super) const fn bytes(count: usize) -> usize {
    if count < FEW { 0 } else { count * size_of::<Event>() }
}

/// The events by position and kind.
pub(super) fn sort(mut events: Vec<Event>) -> Vec<Event> {
    if events.len() < FEW {
        events.sort_unstable();
        return events;
    }
    let mut counts = vec![[0_u32; BUCKETS]; DIGITS];
    for event in &events {
        for (digit, counts) in counts.iter_mut().enumerate() {
            counts[bucket(*event, digit)] += 1;
        }
    }
    let mut sorted = zeros_in_huge_pages(events.len());
    for (digit, counts) in counts.iter_mut().enumerate() {
        if counts.iter().any(|count| *count as usize == events.len()) {
            continue;
        }
        let mut start = 0;
        for count in counts.iter_mut() {
            start += std::mem::replace(count, start);
        }
        for event in &events {
            let place = &mut counts[bucket(*event, digit)];
            sorted[*place as usize] = *event;
            *place += 1;
        }
        std::mem::swap(&mut events, &mut sorted);
    }
    events
}

#[inline(always)]
fn bucket(event: Event, digit: usize) -> usize {
    (event.order() >> (digit as u32 * DIGIT)) as usize & (BUCKETS - 1)
}

#[cfg(test)]
mod tests {
    use super::super::event::Kind;
    use super::*;

    #[test]
    fn events_come_in_order() {
        let kinds = [Kind::End, Kind::FlatEnter, Kind::FlatLeave, Kind::Start];
        for (count, spread) in [(100, 1e3), (20_000, 1e-3), (30_000, 1e30), (20_000, 0.0)] {
            let event = |k: u32| {
                let position = (k.wrapping_mul(2_654_435_761) >> 8) as f32 - 8e6;
                Event::new(position * spread, kinds[k as usize % 4], k)
            };
            let events: Vec<Event> = (0..count).map(event).collect();
            let sorted = sort(events.clone());
            assert!(sorted.is_sorted_by_key(|event| event.order()), "{count} events");
            let by_reference = |events: &[Event]| {
                let mut events = events.to_vec();
                events.sort_unstable_by_key(|event| event.reference());
                events
            };
            assert_eq!(by_reference(&sorted), by_reference(&events));
        }
    }
}
