//! Random numbers that are the same everywhere.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// A seeded stream of numbers.
pub struct Random(Pcg32);

impl Random {
    /// The stream of `seed`.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    /// 32 bits.
    pub fn word(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// So many times 32 bits.
    pub fn words(&mut self, count: usize) -> Vec<u32> {
        (0..count).map(|_| self.word()).collect()
    }

    /// At least 0, less than 1.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    /// At least `from`, at most `to`.
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// At least 0, less than `end`, which is not 0.
    pub fn below(&mut self, end: usize) -> usize {
        (u64::from(self.0.next_u32()) % end as u64) as usize
    }

    /// One of `choices`, which are not empty.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A point of the cube from -1 to 1.
    pub fn point(&mut self) -> [f64; 3] {
        [(); 3].map(|()| self.between(-1.0, 1.0))
    }

    /// A point of the lattice of whole numbers from `-reach` to `reach`.
    pub fn lattice_point(&mut self, reach: usize) -> [f64; 3] {
        [(); 3].map(|()| self.below(2 * reach + 1) as f64 - reach as f64)
    }
}
