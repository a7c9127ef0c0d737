//! Memory that one build leaves to the next.

use crate::device::{Buffer, generous};
use crate::primitives::radix::Sort;
use crate::primitives::scan::Scan;

/// Buffers that are not in use.
#[derive(Default)]
pub(crate) struct Spare {
    /// `None` if there is no next build: then memory is given back at once.
    buffers: Option<Vec<Buffer>>,
    /// Those that trees are in, and are as long as somebody has them.
    lent: Vec<Buffer>,
    /// Room for scans, of the largest so far.
    pub(crate) scan: Option<Scan>,
    /// The same for sorts.
    pub(crate) sort: Option<Sort>,
    /// Single words on their way to the host.
    pub(crate) counts: Option<Buffer>,
}

impl Spare {
    /// For the first of several builds.
    pub(crate) fn kept() -> Self {
        Self { buffers: Some(Vec::new()), ..Self::default() }
    }

    /// The smallest buffer of at least `bytes`, however large it is: where that was bounded, what came in
    /// between decided whether a need found room when it came again.
    pub(crate) fn take(&mut self, bytes: u64) -> Option<Buffer> {
        let buffers = self.buffers.as_mut()?;
        buffers.extend(self.lent.extract_if(.., |buffer| !buffer.is_shared()));
        let sizes = buffers.iter().map(Buffer::size_bytes).enumerate();
        let fitting = sizes.filter(|(_, size)| *size >= bytes);
        let (index, _) = fitting.min_by_key(|(_, size)| *size)?;
        Some(buffers.swap_remove(index))
    }

    /// How many words to allocate where `words` are needed: some more if the next tree, which may be a
    /// little larger, is to find room in the same buffers.
    pub(crate) fn generous(&self, words: u64) -> u64 {
        if self.buffers.is_some() { generous(words) } else { words }
    }

    /// Keeps the buffer, or gives it back.
    pub(crate) fn put(&mut self, buffer: Buffer) -> Option<Buffer> {
        let Some(buffers) = &mut self.buffers else { return Some(buffer) };
        buffers.push(buffer);
        None
    }

    /// Keeps the buffer for when nobody else has it any more.
    pub(crate) fn lend(&mut self, buffer: &Buffer) {
        if self.buffers.is_some() {
            self.lent.push(buffer.clone());
        }
    }

    /// Gives the memory back.
    pub(crate) fn clear(&mut self) {
        self.lent.clear();
        if let Some(buffers) = &mut self.buffers {
            buffers.clear();
        }
    }

    /// Bytes of all that it has.
    pub(crate) fn size_bytes(&self) -> u64 {
        let buffers = self
            .buffers
            .iter()
            .flatten()
            .chain(&self.lent)
            .chain(&self.counts)
            .map(Buffer::size_bytes);
        let scan = self.scan.as_ref().map_or(0, Scan::size_bytes);
        buffers.sum::<u64>() + scan + self.sort.as_ref().map_or(0, Sort::size_bytes)
    }
}
