//! Events: where references start, lie flat and end along an axis \[WH06].

use crate::geometry::Aabb;
use crate::geometry::ordered::ordered;

/// What an event says of its reference. At one position events come in this order.
///
/// A plane that moves up along the axis passes two events of every reference: at one the reference
/// enters the left side (odd kinds), at the other it leaves the right side. A flat reference has
/// both at one position, and enters before it leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub(super) enum Kind {
    End = 0,
    FlatEnter = 1,
    FlatLeave = 2,
    Start = 3,
}

/// Position, kind and reference in 64 bits that sort as events should.
///
/// ```text
/// 63      32 31  30 29        0
/// position   kind   reference
/// ```
///
/// The position is an f32 whose bits were rearranged so that they compare like the number.
/// The reference is an index into the triangles of the event's node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub(super) struct Event(u64);

const REFERENCE: u64 = (1 << 30) - 1;

impl Event {
    #[inline(always)]
    pub(super) fn new(position: f32, kind: Kind, reference: u32) -> Self {
        Self(u64::from(ordered(position)) << 32 | (kind as u64) << 30 | u64::from(reference))
    }

    /// The position as an integer that compares like it.
    #[inline(always)]
    pub(super) fn ordered_position(self) -> u32 {
        (self.0 >> 32) as u32
    }

    #[inline(always)]
    pub(super) fn reference(self) -> usize {
        (self.0 & REFERENCE) as usize
    }

    /// Whether the reference enters the left side here; else it leaves the right side.
    #[inline(always)]
    pub(super) fn enters(self) -> bool {
        self.0 >> 30 & 1 == 1
    }

    #[inline(always)]
    pub(super) fn is(self, kind: Kind) -> bool {
        self.0 >> 30 & 3 == kind as u64
    }

    /// Whether the reference is flat.
    #[inline(always)]
    pub(super) fn is_flat(self) -> bool {
        matches!(self.0 >> 30 & 3, 1 | 2)
    }

    /// Position and kind: what the order of a list depends on.
    #[inline(always)]
    pub(super) fn order(self) -> u64 {
        self.0 >> 30
    }

    /// The same event of the reference called `reference` in a child.
    #[inline(always)]
    pub(super) fn renamed(self, reference: u32) -> Self {
        Self(self.0 & !REFERENCE | u64::from(reference) & REFERENCE)
    }
}

/// The two events of a reference along `axis`.
#[inline(always)]
pub(super) fn events_of(bounds: &Aabb, axis: usize, reference: u32) -> [Event; 2] {
    let (lower, upper) = (bounds.lower[axis], bounds.upper[axis]);
    let kinds =
        if lower == upper { [Kind::FlatEnter, Kind::FlatLeave] } else { [Kind::Start, Kind::End] };
    [Event::new(lower, kinds[0], reference), Event::new(upper, kinds[1], reference)]
}

const _: () = assert!(size_of::<Event>() == 8);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ordered::position_of;

    #[test]
    fn an_event_keeps_what_it_was_made_of() {
        let event = Event::new(-2.5, Kind::Start, 77);
        assert_eq!((position_of(event.ordered_position()), event.reference()), (-2.5, 77));
        assert!(event.enters() && !event.is_flat());
        assert_eq!(event.renamed(5), Event::new(-2.5, Kind::Start, 5));
    }

    #[test]
    fn at_one_position_flat_references_enter_and_leave_between_ends_and_starts() {
        let at = |kind| Event::new(1.0, kind, 9).order();
        let orders = [Kind::End, Kind::FlatEnter, Kind::FlatLeave, Kind::Start].map(at);
        assert!(orders.is_sorted_by(|a, b| a < b), "{orders:?}");
    }
}
