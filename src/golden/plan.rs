//! Which frames of a scene its golden records.

use super::record::{COORDINATE, DIGITS, ROOM_FOR_DIGESTS, ROOM_FOR_POSITIONS, Record};
use std::collections::BTreeSet;

/// Approximate number of frames with diagnostics.
const FRAMES_WITH_NUMBERS: u64 = 10;

/// Which frames and nodes are recorded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Plan {
    /// Frames with pictures.
    pub(super) pictures: BTreeSet<u64>,
    /// Frames with a digest.
    pub(super) digests: BTreeSet<u64>,
    /// Frames with positions.
    pub(super) positions: BTreeSet<u64>,
}

impl Plan {
    /// The plan for a scene with a number of runs and nodes, with pictures at some frames.
    pub(super) fn new(last: u64, runs: usize, nodes: usize, pictures: &BTreeSet<u64>) -> Self {
        let row = 5 + (DIGITS + 1) * runs;
        let stride = ((last as usize + 1) * row).div_ceil(ROOM_FOR_DIGESTS).max(1);
        let ends = [0, last];
        let digests = (0..=last).step_by(stride).chain(pictures.iter().copied()).chain(ends).collect();
        let most = (ROOM_FOR_POSITIONS / (runs * nodes * 3 * COORDINATE).max(1)).max(1);
        // The last frame first: errors have grown most there. Then those with pictures.
        let evenly = (1..=FRAMES_WITH_NUMBERS).map(|at| last * at / FRAMES_WITH_NUMBERS);
        let mut positions = BTreeSet::new();
        for frame in [last].into_iter().chain(pictures.iter().rev().copied()).chain(evenly).chain([0]) {
            if positions.len() < most {
                positions.insert(frame);
            }
        }
        let mut plan = Self { pictures: pictures.clone(), digests, positions };
        plan.digests.extend(&plan.positions);
        plan
    }

    /// Adds the frames of an existing record, up to the end of the scene.
    pub(super) fn with(mut self, record: &Record, last: u64) -> Self {
        for (frame, state) in record.states.runs.iter().flat_map(|run| &run.states).filter(|(frame, _)| **frame <= last)
        {
            self.digests.insert(*frame);
            if state.positions.is_some() {
                self.positions.insert(*frame);
            }
        }
        self
    }

    /// All frames in the plan, rising.
    pub(super) fn frames(&self) -> BTreeSet<u64> {
        self.pictures.iter().chain(&self.digests).chain(&self.positions).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_and_large_scenes_are_recorded_at_fewer_frames() {
        let pictures = BTreeSet::from([100, 200]);
        let plan = Plan::new(300, 2, 64, &pictures);
        assert_eq!(plan.digests.len(), 301, "each frame of a usual scene");
        assert!(plan.positions.contains(&300) && plan.positions.contains(&200), "{plan:?}");
        let long = Plan::new(1_000_000, 3, 100_000, &pictures);
        assert!(long.digests.len() < 1000 && long.positions == BTreeSet::from([1_000_000]), "{}", long.digests.len());
    }
}
