//! The twins as an executor: the whole build in the CPU's memory.

use kdray::BuildError;

use super::arrays::{Array, Arrays};
use super::executor::Executor;
use super::kernel::{Kernel, Params};
use crate::primitives::{radix, scan};

/// Runs the twins of the kernels.
#[derive(Default)]
pub(crate) struct Twins {
    pub(crate) arrays: Arrays,
    parked: Vec<Vec<u32>>,
}

impl Executor for Twins {
    type Error = BuildError;

    fn most_bytes(&self) -> u64 {
        u64::MAX
    }

    fn upload(&mut self, array: Array, words: &[u32]) -> Result<(), BuildError> {
        self.arrays[array] = words.to_vec();
        Ok(())
    }

    fn reserve(&mut self, array: Array, words: usize) -> Result<(), BuildError> {
        self.grow(array, words)
    }

    fn grow(&mut self, array: Array, words: usize) -> Result<(), BuildError> {
        let words = words.max(self.arrays[array].len());
        self.arrays[array].resize(words, 0);
        Ok(())
    }

    fn free(&mut self, array: Array) {
        self.arrays[array] = Vec::new();
    }

    fn park(&mut self, arrays: &[Array]) {
        for array in arrays {
            self.parked.push(std::mem::take(&mut self.arrays[*array]));
        }
    }

    fn unpark(&mut self, arrays: &[Array]) {
        for array in arrays.iter().rev() {
            self.arrays[*array] = self.parked.pop().unwrap_or_default();
        }
    }

    fn clear(&mut self, array: Array, words: usize) -> Result<(), BuildError> {
        self.arrays[array][..words].fill(0);
        Ok(())
    }

    fn stage(&mut self, _: &'static str, _: u32) {}

    fn run(&mut self, kernel: &'static Kernel, params: &Params) -> Result<(), BuildError> {
        (kernel.twin)(&mut self.arrays, params);
        Ok(())
    }

    fn scan(&mut self, array: Array, words: u32) -> Result<(), BuildError> {
        scan::exclusive(&mut self.arrays[array][..words as usize]);
        Ok(())
    }

    fn sort(&mut self, arrays: [Array; 4], words: u32) -> Result<(), BuildError> {
        let [mut keys, mut values] =
            [arrays[0], arrays[1]].map(|array| self.arrays[array][..words as usize].to_vec());
        radix::sort(&mut keys, &mut values, u32::BITS);
        self.arrays[arrays[0]][..words as usize].copy_from_slice(&keys);
        self.arrays[arrays[1]][..words as usize].copy_from_slice(&values);
        Ok(())
    }

    fn swap(&mut self, one: Array, other: Array) {
        self.arrays.swap(one, other);
    }

    fn read(&mut self, places: &[(Array, u32)]) -> Result<Vec<u32>, BuildError> {
        Ok(places.iter().map(|(array, place)| self.arrays[*array][*place as usize]).collect())
    }
}
