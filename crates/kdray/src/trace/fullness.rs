//! How full packets are on their way.

/// Rays that packets took along, and how many there was room for: at every node and leaf that they
/// came to.
#[derive(Default)]
pub(super) struct Fullness {
    pub(super) rays: usize,
    pub(super) room: usize,
}

impl Fullness {
    /// Adds what is known of another packet.
    #[inline(always)]
    pub(super) fn add(&mut self, packet: &Self) {
        self.rays += packet.rays;
        self.room += packet.room;
    }

    /// Whether rays in these packets are faster than alone, as far as is known.
    pub(super) fn is_enough(&self) -> bool {
        // Over eight scenes they were as fast in either way at six sixteenths, and faster in packets above.
        16 * self.rays >= 6 * self.room
    }
}
