//! What a build asks of whoever runs its kernels.

use kdray::BuildError;

use super::arrays::Array;
use super::kernel::{Kernel, Params};
use crate::record::Moved;

/// What runs kernels: a device, or the twins on the CPU.
pub(crate) trait Executor {
    type Error: From<BuildError>;

    /// Bytes that an array can have.
    fn most_bytes(&self) -> u64;
    /// Makes the array hold `words` at its start.
    fn upload(&mut self, array: Array, words: &[u32]) -> Result<(), Self::Error>;
    /// Makes room for `words`; what the array held may be lost.
    fn reserve(&mut self, array: Array, words: usize) -> Result<(), Self::Error>;
    /// Makes room for `words` and keeps what the array held.
    fn grow(&mut self, array: Array, words: usize) -> Result<(), Self::Error>;
    /// Gives the array's memory back.
    fn free(&mut self, array: Array);
    /// Puts arrays away, and leaves none in their places.
    fn park(&mut self, arrays: &[Array]);
    /// Puts the arrays back that were put away last.
    fn unpark(&mut self, arrays: &[Array]);
    /// Zeros at the start of an array.
    fn clear(&mut self, array: Array, words: usize) -> Result<(), Self::Error>;
    /// Counts what a stage moved beside what its kernels say.
    fn charge(&mut self, _stage: (&'static str, u32), _moved: Moved) {}
    /// What follows is a part of this stage, at this depth of the tree.
    fn stage(&mut self, name: &'static str, depth: u32);
    fn run(&mut self, kernel: &'static Kernel, params: &Params) -> Result<(), Self::Error>;
    /// Replaces each of the first `words` by the sum of those before it.
    fn scan(&mut self, array: Array, words: u32) -> Result<(), Self::Error>;
    /// Sorts the first `words` of the first array, and those of the second with them; equals keep their
    /// order. The other two are room.
    fn sort(&mut self, arrays: [Array; 4], words: u32) -> Result<(), Self::Error>;
    fn swap(&mut self, one: Array, other: Array);
    /// Waits for all that was asked for and reads single words.
    fn read(&mut self, places: &[(Array, u32)]) -> Result<Vec<u32>, Self::Error>;
}
