//! How many elements a dispatch works on.

use bytemuck::{Pod, Zeroable};

use super::{Binding, Kernel, Moved, Recording, WORKGROUP};
use crate::device::{Buffer, Device};
use crate::error::GpuError;

/// Elements of which a workgroup makes a tile, 16 an invocation.
pub const TILE: u32 = 16 * WORKGROUP;

/// Most workgroups in a row of a grid.
pub(crate) const ROW: u32 = 65_535;

/// How many elements there are: known now, or only to the device.
#[derive(Clone, Debug)]
pub struct Count {
    /// The most there can be.
    bound: u32,
    /// How many of them make one element: more than one where tiles are counted.
    per: u32,
    /// A word of the device that says how many there are. Above `bound` it means `bound`.
    live: Option<Live>,
}

#[derive(Clone, Debug)]
struct Live {
    counter: Buffer,
    at: u32,
    /// The grids that [`Recording::measure`] made of the word, for both kinds of [`Work`].
    grids: Buffer,
}

/// How the elements of a count are shared out among workgroups.
#[derive(Clone, Debug)]
pub struct Work {
    pub(super) count: Count,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Each,
    Tiles,
    Groups,
    One,
}

/// The words that say to a kernel how many elements there are.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CountParams {
    /// The most there can be.
    pub bound: u32,
    /// Place of the count in the counter buffer.
    pub at: u32,
    /// How many of them make one element.
    pub per: u32,
    /// Uniforms come in sixteens of bytes.
    pub unused: u32,
}

impl Count {
    /// As many as the word `at` of `counter` says when the device gets there, and at most `bound`.
    ///
    /// [`Recording::measure`] has to follow every change of the word.
    ///
    /// # Errors
    ///
    /// If the device has no memory for the count's grids, 32 bytes.
    pub fn live(device: &Device, counter: &Buffer, at: u32, bound: u32) -> Result<Self, GpuError> {
        let grids = device.buffer("grids of a count", 8)?;
        Ok(Self { bound, per: 1, live: Some(Live { counter: counter.clone(), at, grids }) })
    }

    /// The most elements there can be.
    #[must_use]
    pub fn bound(&self) -> u32 {
        self.bound.div_ceil(self.per)
    }

    /// How many blocks of `size` elements these elements are.
    #[must_use]
    pub fn blocks(&self, size: u32) -> Self {
        Self { per: self.per.saturating_mul(size), ..self.clone() }
    }

    /// What a kernel must be told. Its `counter` binding takes [`Count::counter`].
    #[must_use]
    pub fn params(&self) -> CountParams {
        let at = self.live.as_ref().map_or(0, |live| live.at);
        CountParams { bound: self.bound, at, per: self.per, unused: 0 }
    }

    /// The buffer with the count; for a count known now, one whose first word is greater than all.
    #[must_use]
    pub fn counter<'a>(&'a self, device: &'a Device) -> &'a Buffer {
        self.live.as_ref().map_or(&device.unlimited, |live| &live.counter)
    }

    /// The grids of a live count: three words for [`Work::each`], and three for [`Work::tiles`] from
    /// the fourth on.
    #[must_use]
    pub fn grids(&self) -> Option<&Buffer> {
        self.live.as_ref().map(|live| &live.grids)
    }

    /// How many elements there are if the device's word is `word`.
    pub(super) fn elements(&self, word: u32) -> u32 {
        self.bound.min(word).div_ceil(self.per)
    }

    /// Where the device finds the count, if it is not known now.
    pub(super) fn word(&self) -> Option<Buffer> {
        self.live.as_ref().map(|live| live.counter.words(live.at.into(), 1))
    }
}

impl From<u32> for Count {
    fn from(count: u32) -> Self {
        Self { bound: count, per: 1, live: None }
    }
}

impl Work {
    /// An element an invocation.
    #[must_use]
    pub fn each(count: &Count) -> Self {
        Self { count: count.clone(), shape: Shape::Each }
    }

    /// A tile of [`TILE`] elements a workgroup.
    #[must_use]
    pub fn tiles(count: &Count) -> Self {
        Self { count: count.clone(), shape: Shape::Tiles }
    }

    /// A workgroup an element.
    #[must_use]
    pub fn groups(count: u32) -> Self {
        Self { count: count.into(), shape: Shape::Groups }
    }

    /// All elements in one workgroup.
    #[must_use]
    pub fn one(count: &Count) -> Self {
        Self { count: count.clone(), shape: Shape::One }
    }

    pub(super) fn grid(&self) -> Grid {
        let (per_group, place) = match self.shape {
            Shape::Each => (WORKGROUP, 0),
            Shape::Tiles => (TILE, 4),
            Shape::Groups => (1, 8),
            Shape::One => return Grid::Known(grid(1)),
        };
        match &self.count.live {
            Some(live) if self.count.per == 1 => Grid::Live(live.grids.words(place, 3)),
            _ => Grid::Known(grid(self.count.bound().div_ceil(per_group))),
        }
    }
}

/// Workgroups along three dimensions.
#[derive(Debug)]
pub(super) enum Grid {
    Known([u32; 3]),
    Live(Buffer),
}

/// Rows of workgroups, at least `groups` in all.
#[must_use]
pub fn grid(groups: u32) -> [u32; 3] {
    [groups.min(ROW), groups.div_ceil(ROW), groups.min(1)]
}

/// Makes the grids of a count. Twin of [`grid`].
pub(crate) const MEASURE: Kernel = Kernel {
    name: "measure",
    source: include_str!("measure.wgsl"),
    bindings: &[Binding::Uniform, Binding::Read, Binding::Write],
};

impl Recording<'_> {
    /// Makes the grids of a live count anew, after the device has changed it. Costs a dispatch;
    /// nothing for a count known now.
    pub fn measure(&mut self, count: &Count) {
        let Some(live) = &count.live else { return };
        let one = Work::each(&Count::from(1));
        let buffers = [&live.counter, &live.grids];
        self.dispatch(&MEASURE, &count.params(), &buffers, &one, |_| Moved {
            read: 4,
            written: 32,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_hold_all_workgroups_and_no_row_is_too_long() {
        for groups in [0, 1, 2, ROW - 1, ROW, ROW + 1, 2 * ROW, u32::MAX] {
            let [x, y, z] = grid(groups);
            assert!(x <= ROW && y <= ROW + 2 && z <= 1, "{groups}");
            let all = u64::from(x) * u64::from(y) * u64::from(z);
            assert!(
                all >= u64::from(groups) && all < u64::from(groups) + u64::from(ROW),
                "{groups}"
            );
        }
    }
}
