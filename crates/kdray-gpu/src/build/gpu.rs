//! The kernels on a device.

use kdray::BuildError;

use super::arrays::Array;
use super::executor::Executor;
use super::kernel::{Kernel, Params, Worker};
use super::spare::Spare;
use crate::device::{Buffer, Device, Watch};
use crate::error::GpuError;
use crate::primitives::radix::{Pairs, Sort};
use crate::primitives::scan::Scan;
use crate::record::{Count, Moved, Profile, Recording, Work};

/// Runs kernels on a device: notes them down, and submits what it has whenever something is read.
pub(crate) struct Gpu<'a> {
    device: &'a Device,
    buffers: [Option<Buffer>; Array::COUNT],
    parked: Vec<Option<Buffer>>,
    recording: Recording<'a>,
    stage: (&'static str, u32),
    spare: Spare,
    /// What was given back, and is there until the work that is noted down is done.
    leaving: Vec<Watch>,
    /// The most bytes that the build may have at one time, those that it should keep to, and those
    /// that it had.
    budget: Option<u64>,
    aim: u64,
    pub(crate) peak_bytes: u64,
    /// What the work took, if that is asked for.
    pub(crate) profile: Option<Profile>,
    pub(crate) readbacks: u64,
}

const RESERVED: &str = "arrays are reserved before they are used";

/// The fewest words of a buffer: every element fits.
const LEAST: usize = 16;

/// Buffers are larger than asked for by one part in so many.
const SLACK: u64 = 16;

/// The most single words that are read at once.
const WORDS: u64 = 16;

impl<'a> Gpu<'a> {
    pub(crate) fn new(
        device: &'a Device,
        spare: Spare,
        (budget, aim): (Option<u64>, u64),
        with_profile: bool,
    ) -> Self {
        Self {
            device,
            leaving: Vec::new(),
            buffers: [const { None }; Array::COUNT],
            parked: Vec::new(),
            recording: Recording::new(device),
            stage: ("", 0),
            spare,
            budget,
            aim,
            peak_bytes: 0,
            profile: with_profile.then(Profile::default),
            readbacks: 0,
        }
    }

    fn buffer(&self, array: Array) -> &Buffer {
        self.buffers[array as usize].as_ref().expect(RESERVED)
    }

    /// Room for `words` in a new buffer, if the array has less.
    fn larger(&mut self, array: Array, words: usize) -> Result<Option<Buffer>, GpuError> {
        let held = self.buffers[array as usize].as_ref().map_or(0, Buffer::size_bytes);
        let words = words.max(LEAST) as u64;
        if 4 * words <= held {
            return Ok(None);
        }
        // Levels grow and shrink a little; not every one needs new buffers, if there is room for more.
        let slack = (words / SLACK).min((self.most_bytes() / 4).saturating_sub(words));
        let is_tight = self.in_use() + 4 * (words + slack) > self.aim;
        let slack = if is_tight { 0 } else { slack };
        self.allocate(words + slack).map(Some)
    }

    /// A buffer of `words`, or a spare one that is larger.
    fn allocate(&mut self, words: u64) -> Result<Buffer, GpuError> {
        if let Some(buffer) = self.spare.take(4 * words) {
            self.book(0)?;
            return Ok(buffer);
        }
        let most = self.most_bytes();
        if 4 * words > most {
            return Err(GpuError::Limit {
                adapter: self.device.adapter().name.clone(),
                limit: "binding_bytes",
                asked: 4 * words,
                offered: most,
            });
        }
        let words = self.spare.generous(words).min(most / 4);
        self.book(4 * words)?;
        self.device.buffer(self.stage.0, words)
    }

    /// Leaves the array without memory.
    fn retire(&mut self, array: Array) {
        if let Some(buffer) = self.buffers[array as usize].take() {
            self.give_back(buffer);
        }
    }

    fn give_back(&mut self, buffer: Buffer) {
        if let Some(buffer) = self.spare.put(buffer) {
            self.leaving.push(buffer.watch());
        }
    }

    /// Hands an array over, whose memory may come back.
    pub(crate) fn hand_over(&mut self, array: Array) -> Buffer {
        let buffer = self.buffers[array as usize].take().expect(RESERVED);
        self.spare.lend(&buffer);
        buffer
    }

    /// Waits for all that was asked for and reads the start of an array.
    #[cfg(test)]
    pub(crate) fn download(&mut self, array: Array, words: usize) -> Result<Vec<u32>, GpuError> {
        self.submit()?;
        if words == 0 {
            return Ok(Vec::new());
        }
        self.device.read(&self.buffer(array).words(0, words as u64))
    }

    /// Ends the build, and gives what the next one can use.
    pub(crate) fn leave(mut self) -> Spare {
        let left = self.buffers.iter_mut().chain(&mut self.parked).filter_map(Option::take);
        left.for_each(|buffer| drop(self.spare.put(buffer)));
        self.spare
    }

    /// Counts bytes that are about to be allocated, or refuses them. Where memory is short, the work
    /// that is noted down is done first, so that what was given back is gone.
    fn book(&mut self, bytes: u64) -> Result<(), GpuError> {
        if bytes > 0 && !self.leaving.is_empty() && self.held() + bytes > self.aim {
            self.submit()?;
            self.device.wait()?;
        }
        if self.budget.is_some_and(|budget| self.held() + bytes > budget) {
            self.spare.clear();
        }
        let needed = self.held() + bytes;
        self.peak_bytes = self.peak_bytes.max(needed);
        match self.budget {
            Some(budget) if needed > budget => {
                Err(BuildError::MemoryBudget { stage: self.stage.0, needed, budget }.into())
            }
            _ => Ok(()),
        }
    }

    /// Bytes of the device that the build has.
    fn held(&mut self) -> u64 {
        self.in_use() + self.spare.size_bytes()
    }

    /// Those that are not spare.
    fn in_use(&mut self) -> u64 {
        self.leaving.retain(|buffer| buffer.size_bytes() > 0);
        let used = self.buffers.iter().chain(&self.parked).flatten().map(Buffer::size_bytes);
        let leaving = self.leaving.iter().map(Watch::size_bytes);
        used.chain(leaving).sum()
    }

    /// Submits everything noted down.
    pub(crate) fn submit(&mut self) -> Result<(), GpuError> {
        let recording = std::mem::replace(&mut self.recording, Recording::new(self.device));
        self.recording.stage(self.stage.0, self.stage.1);
        match &mut self.profile {
            Some(profile) => profile.append(recording.profile()?),
            None => recording.run()?,
        }
        Ok(())
    }
}

impl Executor for Gpu<'_> {
    type Error = GpuError;

    fn most_bytes(&self) -> u64 {
        self.device.limits().binding_bytes
    }

    fn upload(&mut self, array: Array, words: &[u32]) -> Result<(), GpuError> {
        let mut padded;
        let mut data = words;
        if words.len() < LEAST {
            padded = [0; LEAST];
            padded[..words.len()].copy_from_slice(words);
            data = &padded;
        }
        self.retire(array);
        let buffer = self.allocate(data.len() as u64)?;
        // A build uploads before it notes anything down, so nothing waits that wants the old words.
        self.device.write(&buffer, data);
        self.buffers[array as usize] = Some(buffer);
        Ok(())
    }

    fn reserve(&mut self, array: Array, words: usize) -> Result<(), GpuError> {
        let held = self.buffers[array as usize].as_ref().map_or(0, Buffer::size_bytes);
        if 4 * words.max(LEAST) as u64 > held {
            // The old memory goes first.
            self.retire(array);
            self.buffers[array as usize] = self.larger(array, words)?;
        }
        Ok(())
    }

    fn grow(&mut self, array: Array, words: usize) -> Result<(), GpuError> {
        if let Some(buffer) = self.larger(array, words)? {
            let old = self.buffers[array as usize].replace(buffer.clone());
            if let Some(old) = old {
                self.recording.copy(&old, &buffer.words(0, old.size_bytes() / 4));
                self.give_back(old);
            }
        }
        Ok(())
    }

    fn free(&mut self, array: Array) {
        self.retire(array);
    }

    fn park(&mut self, arrays: &[Array]) {
        for array in arrays {
            self.parked.push(self.buffers[*array as usize].take());
        }
    }

    fn unpark(&mut self, arrays: &[Array]) {
        for array in arrays.iter().rev() {
            self.retire(*array);
            self.buffers[*array as usize] = self.parked.pop().flatten();
        }
    }

    fn clear(&mut self, array: Array, words: usize) -> Result<(), GpuError> {
        if words > 0 {
            self.recording.clear(&self.buffer(array).words(0, words as u64));
        }
        Ok(())
    }

    fn charge(&mut self, stage: (&'static str, u32), moved: Moved) {
        if let Some(profile) = &mut self.profile {
            profile.charge(stage, moved);
        }
    }

    fn stage(&mut self, name: &'static str, depth: u32) {
        self.stage = (name, depth);
        self.recording.stage(name, depth);
    }

    fn run(&mut self, kernel: &'static Kernel, params: &Params) -> Result<(), GpuError> {
        if params.count > 0 {
            let buffers: Vec<_> =
                kernel.arrays.iter().map(|array| self.buffer(*array).clone()).collect();
            let buffers: Vec<_> = buffers.iter().collect();
            let moved = (kernel.moved)(params);
            let work = match kernel.by {
                Worker::Invocation => Work::each(&Count::from(params.count)),
                Worker::Team => Work::groups(params.count),
            };
            self.recording.dispatch(&kernel.shader, params, &buffers, &work, move |_| moved);
        }
        Ok(())
    }

    fn scan(&mut self, array: Array, words: u32) -> Result<(), GpuError> {
        if self.spare.scan.as_ref().is_none_or(|scan| scan.bound() < words) {
            self.spare.scan = Some(Scan::new(self.device, words + words / 8)?);
        }
        if let Some(scan) = &self.spare.scan {
            let values = self.buffers[array as usize].as_ref().expect(RESERVED);
            scan.record(&mut self.recording, values, &Count::from(words), None);
        }
        Ok(())
    }

    fn sort(&mut self, arrays: [Array; 4], words: u32) -> Result<(), GpuError> {
        if self.spare.sort.as_ref().is_none_or(|sort| sort.bound() < words) {
            self.spare.sort = Some(Sort::new(self.device, words.max(1))?);
        }
        if let Some(sort) = &self.spare.sort {
            let [keys, values, next_keys, next_values] =
                arrays.map(|array| self.buffers[array as usize].as_ref().expect(RESERVED));
            let (pairs, room) =
                (Pairs { keys, values }, Pairs { keys: next_keys, values: next_values });
            sort.record(&mut self.recording, pairs, room, &Count::from(words), u32::BITS);
        }
        Ok(())
    }

    fn swap(&mut self, one: Array, other: Array) {
        self.buffers.swap(one as usize, other as usize);
    }

    fn read(&mut self, places: &[(Array, u32)]) -> Result<Vec<u32>, GpuError> {
        let words = match self.spare.counts.take() {
            Some(words) => words,
            None => self.device.buffer("counts", WORDS)?,
        };
        for (index, (array, place)) in (0..).zip(places) {
            self.recording
                .copy(&self.buffer(*array).words(u64::from(*place), 1), &words.words(index, 1));
        }
        self.submit()?;
        self.readbacks += 1;
        let mut read = self.device.read::<u32>(&words)?;
        read.truncate(places.len());
        self.spare.counts = Some(words);
        Ok(read)
    }
}
