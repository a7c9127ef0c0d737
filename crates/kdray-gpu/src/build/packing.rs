//! The tree, when all levels are done.

use super::arrays::Array;
use super::data::{Extent, Record};
use super::driver::{Driver, Finished, MOST_RECORDS, too_large, words};
use super::executor::Executor;
use super::kernel::Kernel;
use super::{offset, pack, weigh};

/// What the tree is packed from, and what may stay beside it.
const FINISHED: [Array; 2] = [Array::Records, Array::Finished];
const MESH: [Array; 2] = [Array::Positions, Array::Triangles];

impl<E: Executor> Driver<'_, E> {
    /// Brings nodes and references into their order.
    pub(super) fn pack(&mut self) -> Result<Finished, E::Error> {
        let records = self.params.next_records;
        self.device.stage("pack", 0);
        let keeps_mesh = self.terms.keeps_mesh;
        let stays =
            |array: &Array| FINISHED.contains(array) || (keeps_mesh && MESH.contains(array));
        for array in Array::ALL.into_iter().filter(|array| !stays(array)) {
            self.device.free(array);
        }
        self.device.reserve(Array::Extents, words::<Extent>(records))?;
        for index in (0..self.levels.len()).rev() {
            self.run_over(&weigh::WEIGH, index)?;
        }
        let whole = self.device.read(&[(Array::Extents, 0), (Array::Extents, 1)])?;
        let [nodes, references] = [whole[0], whole[1]];
        if nodes > MOST_RECORDS {
            return Err(too_large());
        }
        for index in 0..self.levels.len() {
            self.run_over(&offset::OFFSET, index)?;
        }
        self.device.reserve(Array::TreeNodes, words::<Record>(nodes))?;
        self.device.reserve(Array::TreeReferences, references as usize)?;
        self.run(&pack::PACK, records)?;
        let levels = std::mem::take(&mut self.reports);
        Ok(Finished { counts: [nodes, references], levels })
    }

    /// Runs a kernel over the records of a level.
    fn run_over(&mut self, kernel: &'static Kernel, index: usize) -> Result<(), E::Error> {
        let [first, count] = self.levels[index];
        self.params.records = first;
        self.run(kernel, count)
    }
}
