//! Which frames of a scene its golden records.

use super::record::{COORDINATE, DIGITS, ROOM_FOR_DIGESTS, ROOM_FOR_PLACES, Record};
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
    pub(super) places: BTreeSet<u64>,
}

impl Plan {
    /// What is recorded of a scene of so many runs and nodes in which `pictures` are drawn.
    pub(super) fn new(last: u64, runs: usize, nodes: usize, pictures: &BTreeSet<u64>) -> Self {
        let row = 5 + (DIGITS + 1) * runs;
        let stride = ((last as usize + 1) * row).div_ceil(ROOM_FOR_DIGESTS).max(1);
        let ends = [0, last];
        let digests = (0..=last).step_by(stride).chain(pictures.iter().copied()).chain(ends).collect();
        let most = (ROOM_FOR_PLACES / (runs * nodes * 3 * COORDINATE).max(1)).max(1);
        // The last frame first: whatever went astray is farthest away there. Then those that can be seen.
        let evenly = (1..=FRAMES_WITH_NUMBERS).map(|at| last * at / FRAMES_WITH_NUMBERS);
        let mut places = BTreeSet::new();
        for frame in [last].into_iter().chain(pictures.iter().rev().copied()).chain(evenly).chain([0]) {
            if places.len() < most {
                places.insert(frame);
            }
        }
        let mut plan = Self { pictures: pictures.clone(), digests, places };
        plan.digests.extend(&plan.places);
        plan
    }

    /// The same with all that another record knows, as far as the scene goes.
    pub(super) fn with(mut self, record: &Record, last: u64) -> Self {
        for (frame, state) in record.states.runs.iter().flat_map(|run| &run.states).filter(|(frame, _)| **frame <= last)
        {
            self.digests.insert(*frame);
            if state.places.is_some() {
                self.places.insert(*frame);
            }
        }
        self
    }

    /// All frames that are looked at, rising.
    pub(super) fn frames(&self) -> BTreeSet<u64> {
        self.pictures.iter().chain(&self.digests).chain(&self.places).copied().collect()
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
        assert!(plan.places.contains(&300) && plan.places.contains(&200), "{plan:?}");
        let long = Plan::new(1_000_000, 3, 100_000, &pictures);
        assert!(long.digests.len() < 1000 && long.places == BTreeSet::from([1_000_000]), "{}", long.digests.len());
    }
}
