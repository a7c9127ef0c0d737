//! What is known of lanes before a hit is worked out: of the triangles of a block, or the rays of a packet.

/// Lanes whose ray may hit its triangle in the interval that was asked for, a bit each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sifted {
    pub(super) maybe: u32,
    /// Those whose line crosses for certain, wherever.
    pub(super) surely: u32,
    /// Those that are hit in the interval for certain.
    pub(super) inside: u32,
}

impl Sifted {
    /// Whether the line of a lane crosses for certain.
    #[inline(always)]
    pub(super) fn surely(&self, lane: usize) -> bool {
        self.surely >> lane & 1 == 1
    }
}

/// What a visitor wants of the triangles of a block.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Wants {
    /// All hits.
    All,
    /// The first hit of those it accepts.
    First,
    /// All hits, or to know that there are some.
    Whether,
}

/// No vector has more lanes.
const MOST: usize = 16;

/// The lanes of a mask.
#[inline(always)]
pub(super) fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < MOST).then_some(lane)
    })
}
