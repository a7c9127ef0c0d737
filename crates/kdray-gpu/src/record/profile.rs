//! What a recording cost.

use super::recording::Moved;

/// What a recording cost, by stage and level in the order in which they came.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    /// One entry a stage and level.
    pub stages: Vec<StageProfile>,
}

/// What a stage cost on a level of the tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StageProfile {
    /// Its name.
    pub name: &'static str,
    /// Depth of the nodes that it worked on.
    pub level: u32,
    /// How many kernels were run.
    pub dispatches: u64,
    /// Bytes that they read and wrote, as each counts them.
    pub moved: Moved,
    /// Seconds between the timestamps around them; zero on a device without timestamps.
    pub seconds: f64,
}

impl Profile {
    /// Adds a dispatch.
    pub(super) fn add(&mut self, stage: (&'static str, u32), moved: Moved, seconds: f64) {
        self.charge(stage, moved);
        let stage = self.stage(stage);
        stage.dispatches += 1;
        stage.seconds += seconds;
    }

    /// Adds bytes that no dispatch knew of when it was noted down.
    pub(crate) fn charge(&mut self, stage: (&'static str, u32), moved: Moved) {
        let stage = self.stage(stage);
        stage.moved.read += moved.read;
        stage.moved.written += moved.written;
    }

    /// The last of the stages of a name and level.
    fn stage(&mut self, (name, level): (&'static str, u32)) -> &mut StageProfile {
        let same = |stage: &StageProfile| stage.name == name && stage.level == level;
        let place = self.stages.iter().rposition(same).unwrap_or(self.stages.len());
        if place == self.stages.len() {
            self.stages.push(StageProfile { name, level, ..Default::default() });
        }
        &mut self.stages[place]
    }

    /// Adds what a later recording cost.
    pub(crate) fn append(&mut self, later: Self) {
        self.stages.extend(later.stages);
    }

    /// All stages together, without a name.
    #[must_use]
    pub fn total(&self) -> StageProfile {
        let mut total = Self::default();
        for stage in &self.stages {
            total.add(("", 0), stage.moved, stage.seconds);
        }
        let dispatches = self.stages.iter().map(|stage| stage.dispatches).sum();
        StageProfile { dispatches, ..total.stages.pop().unwrap_or_default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dispatches_are_summed_by_stage_and_level() {
        let mut profile = Profile::default();
        for (stage, read) in [(("sweep", 0), 1), (("split", 0), 10), (("sweep", 1), 100)] {
            profile.add(stage, Moved { read, written: 1 }, 0.5);
            profile.add(stage, Moved { read, written: 1 }, 0.5);
        }
        let reads: Vec<u64> = profile.stages.iter().map(|stage| stage.moved.read).collect();
        assert_eq!(reads, [2, 20, 200]);
        let total = profile.total();
        assert_eq!((total.dispatches, total.moved.read, total.moved.written), (6, 222, 6));
        assert_eq!(total.seconds, 3.0);
    }
}
