//! Known states, exact or rounded, and their differences between two sides.

use crate::output::state_digest;
use crate::sim::apart::{distances, largest};
use crate::sim::body::Dimension;
use crate::sim::diagnostics::{Chosen, Diagnostic, Reach};
use crate::sim::snapshot::Snapshot;
use crate::sim::words::{quantity, rounded};
use glam::DVec3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The states of several runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct States {
    /// One for each run, in the order of the scene.
    pub(super) runs: Vec<Run>,
}

/// The states of one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Run {
    pub(super) name: String,
    /// Its time step, if known.
    pub(super) step: Option<Step>,
    /// By the number of the frame.
    pub(super) states: BTreeMap<u64, State>,
}

/// The time step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// ΔT (s).
    pub(super) step: f64,
    /// The cycle T of the scene's lightest node and stiffest run (s), of which steps may be fractions.
    pub(super) cycle: f64,
}

/// One run at one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct State {
    /// The moment (s), if it is known.
    pub(super) time: Option<f64>,
    /// Digest of all positions and velocities in hexadecimal digits, or as many of them as were kept.
    pub(super) digest: String,
    pub(super) positions: Option<Positions>,
    /// Some diagnostics.
    pub(super) numbers: Option<Chosen>,
}

/// Positions of nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Positions {
    /// The step to which positions are rounded (m); 0 if they are exact.
    pub(super) quantum: f64,
    /// The stride of known nodes, from the first one.
    pub(super) every: usize,
    /// The number of all nodes.
    pub(super) nodes: usize,
    /// Positions (m).
    pub(super) at: Vec<DVec3>,
}

impl State {
    /// The state in a snapshot; its positions only on request.
    pub(super) fn of(snapshot: &Snapshot, with_positions: bool) -> Self {
        let at = &snapshot.position;
        let positions = with_positions.then(|| Positions { quantum: 0.0, every: 1, nodes: at.len(), at: at.clone() });
        let numbers = Some(Chosen::within(Reach::Goldens, &snapshot.diagnostics));
        Self { time: Some(snapshot.time), digest: state_digest(snapshot), positions, numbers }
    }

    /// Whether two states are the same, as far as both digests go.
    fn equals(&self, other: &Self) -> bool {
        let length = self.digest.len().min(other.digest.len());
        length > 0 && self.digest.as_bytes()[..length] == other.digest.as_bytes()[..length]
    }
}

impl States {
    pub(super) fn run(&self, name: &str) -> Option<&Run> {
        self.runs.iter().find(|run| run.name == name)
    }

    /// Whether no state is known.
    fn is_empty(&self) -> bool {
        self.runs.iter().all(|run| run.states.is_empty())
    }

    /// Adds other states, which replace those of the same run and frame.
    pub(super) fn extend(&mut self, others: Self) {
        for run in others.runs {
            for (frame, state) in run.states {
                self.add(&run.name, frame, state);
            }
        }
    }

    /// Sets the time steps of known runs.
    pub(super) fn set_steps<'a>(&mut self, steps: impl IntoIterator<Item = (&'a str, Step)>) {
        for (name, step) in steps {
            if let Some(run) = self.runs.iter_mut().find(|run| run.name == name) {
                run.step = Some(step);
            }
        }
    }

    /// Adds the state of a run at a frame.
    pub(super) fn add(&mut self, run: &str, frame: u64, state: State) {
        let at = self.runs.iter().position(|known| known.name == run).unwrap_or_else(|| {
            self.runs.push(Run { name: run.to_owned(), ..Run::default() });
            self.runs.len() - 1
        });
        self.runs[at].states.insert(frame, state);
    }
}

/// The distance of a node from its expected position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Displacement {
    /// The frame.
    pub frame: u64,
    /// The node with the largest distance, counted from 0.
    pub node: usize,
    /// The distance (m).
    pub distance: f64,
    /// The largest distance that is left after the best rigid fit of the nodes to where they were expected (m): the
    /// difference in shape.
    pub of_shape: f64,
    /// The precision of the distances (m); 0 if they are exact.
    pub precision: f64,
}

/// How a run changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Change {
    /// Its states differ.
    #[default]
    Moved,
    /// It no longer exists.
    Gone,
    /// It is new.
    New,
}

/// A change of the time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct StepChange {
    /// The expected step (s).
    pub before: f64,
    /// The actual step (s).
    pub after: f64,
    /// The divisor, if both are the same fraction of the cycle T of the stiffest run, which has changed then.
    pub parts: Option<f64>,
}

impl StepChange {
    fn between(before: Option<Step>, after: Option<Step>) -> Option<Self> {
        let (before, after) = before.zip(after).filter(|(before, after)| before.step != after.step)?;
        let parts = [before, after].map(|one| rounded(one.cycle / one.step, 6));
        let parts = (parts[0] == parts[1]).then_some(parts[0]);
        Some(Self { before: before.step, after: after.step, parts })
    }
}

impl fmt::Display for StepChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { before, after, parts } = self;
        write!(f, "its step changed from {} s to {} s", rounded(*before, 4), rounded(*after, 4))?;
        // A stiffer run makes the step of all runs shorter.
        parts.map_or(Ok(()), |parts| write!(f, " (T/{parts} of the stiffest run)"))
    }
}

/// A run whose states are not as expected.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Moved {
    /// Name of the run.
    pub run: String,
    /// How it changed.
    pub change: Change,
    /// The first compared frame with another state.
    pub first: Option<u64>,
    /// The last compared frame before that, whose state is as expected.
    pub last_equal: Option<u64>,
    /// The change of its time step, if both are known.
    pub step: Option<StepChange>,
    /// The expected and the actual number of nodes, if they differ.
    pub nodes: Option<[usize; 2]>,
    /// The largest displacement at the first frame with another state and known positions.
    pub displacement: Option<Displacement>,
    /// The largest displacement of all frames.
    pub largest: Option<Displacement>,
    /// Expected and actual diagnostics at the first frame with another state that has them.
    pub numbers: Option<[Chosen; 2]>,
}

/// A run on both sides, frame by frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunDifference {
    /// Name of the run.
    pub run: String,
    /// The precision of displacements (m); 0 if they are exact.
    pub precision: f64,
    /// Frames that are known on both sides, rising.
    pub moments: Vec<FrameDifference>,
}

/// A run on both sides at one frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameDifference {
    /// The frame.
    pub frame: u64,
    /// The moment (s), if it is known.
    pub time: Option<f64>,
    /// Whether the states differ.
    pub moved: bool,
    /// By how much, where that is known.
    pub displacement: Option<Displacement>,
}

/// All runs that are known on both sides.
pub(super) fn run_differences(expected: &States, actual: &States) -> Vec<RunDifference> {
    let difference = |run: &Run| {
        let other = actual.run(&run.name)?;
        let both = run.states.iter().filter_map(|(frame, state)| Some((*frame, state, other.states.get(frame)?)));
        let moments: Vec<FrameDifference> = both
            .map(|(frame, before, after)| {
                let moved = !before.equals(after);
                let displacement = moved.then(|| displacement(frame, before, after)).flatten();
                FrameDifference { frame, time: after.time.or(before.time), moved, displacement }
            })
            .collect();
        let precision = moments.iter().filter_map(|moment| Some(moment.displacement?.precision)).fold(0.0, f64::max);
        (!moments.is_empty()).then(|| RunDifference { run: run.name.clone(), precision, moments })
    };
    expected.runs.iter().filter_map(difference).collect()
}

/// The runs that moved, and those on one side only.
pub(super) fn moved(expected: &States, actual: &States, differences: &[RunDifference]) -> Vec<Moved> {
    if expected.is_empty() || actual.is_empty() {
        // Without recorded states no runs are gone or new.
        return Vec::new();
    }
    let lone = |run: &Run, change| Moved { run: run.name.clone(), change, ..Moved::default() };
    let absent = |run: &&Run, from: &States| !run.states.is_empty() && from.run(&run.name).is_none();
    let gone = expected.runs.iter().filter(|run| absent(run, actual)).map(|run| lone(run, Change::Gone));
    let new = actual.runs.iter().filter(|run| absent(run, expected)).map(|run| lone(run, Change::New));
    let moved = differences.iter().filter_map(|difference| {
        let first = difference.moments.iter().find(|moment| moment.moved)?.frame;
        let equal = difference.moments.iter().take_while(|moment| !moment.moved).last();
        let displaced = || difference.moments.iter().filter_map(|moment| moment.displacement);
        let runs = [expected, actual].map(|side| side.run(&difference.run).expect("on both sides"));
        let [before, after] = runs.map(|run| &run.states);
        let both = |frame: &u64| Some([before.get(frame)?, after.get(frame)?]);
        let later = || difference.moments.iter().filter(|moment| moment.moved).map(|moment| moment.frame);
        let numbers = later().find_map(|frame| {
            let [before, after] = both(&frame)?;
            Some([before.numbers.clone()?, after.numbers.clone()?])
        });
        let nodes = later().find_map(|frame| {
            let [before, after] = both(&frame)?;
            let nodes = [before.positions.as_ref()?.nodes, after.positions.as_ref()?.nodes];
            (nodes[0] != nodes[1]).then_some(nodes)
        });
        Some(Moved {
            run: difference.run.clone(),
            change: Change::Moved,
            first: Some(first),
            last_equal: equal.map(|moment| moment.frame),
            step: StepChange::between(runs[0].step, runs[1].step),
            nodes,
            displacement: displaced().next(),
            // The first of equal maxima.
            largest: displaced().reduce(|one, other| if other.distance > one.distance { other } else { one }),
            numbers,
        })
    });
    moved.chain(gone).chain(new).collect()
}

/// The largest displacement of the nodes known on both sides.
fn displacement(frame: u64, before: &State, after: &State) -> Option<Displacement> {
    let (before, after) = before.positions.as_ref().zip(after.positions.as_ref())?;
    if before.nodes != after.nodes {
        return None;
    }
    // Rounding moves each coordinate by half a quantum at most.
    let precision = 0.5 * 3_f64.sqrt() * (before.quantum + after.quantum);
    let nodes = (0..before.nodes).step_by(before.every).filter(|node| node % after.every == 0);
    let known: Vec<usize> = nodes.collect();
    let at = |places: &Positions| known.iter().map(|node| places.at[node / places.every]).collect::<Vec<_>>();
    let [before, after] = [at(before), at(after)];
    let farthest = known.iter().copied().zip(distances(&before, &after));
    let (node, distance) = farthest.reduce(|one, other| if other.1 > one.1 { other } else { one })?;
    let is_flat = before.iter().chain(&after).all(|at| at.z == 0.0);
    let dimension = if is_flat { Dimension::Plane } else { Dimension::Space };
    let of_shape = largest(dimension, [&before, &after], true);
    Some(Displacement { frame, node, distance, of_shape, precision })
}

impl Displacement {
    /// The displacement in words, with ` at frame …` as `place` where the frame is not clear.
    pub(super) fn words(&self, place: &str) -> String {
        let Self { node, distance, precision, .. } = self;
        if *precision == 0.0 && *distance == 0.0 {
            format!("no node{place}, but velocities differ")
        } else if distance <= precision {
            // Both rounding errors can have the same direction.
            let most = quantity(2.0 * precision, "m");
            format!("no node by more than {most}{place} (positions are recorded no finer)")
        } else {
            format!("node {node} by {}{place}", quantity(*distance, "m"))
        }
    }
}

impl fmt::Display for Moved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.run)?;
        match self.change {
            Change::Gone => return f.write_str(" is gone"),
            Change::New => return f.write_str(" is new"),
            Change::Moved => {}
        }
        match (self.first, self.last_equal) {
            (Some(first), Some(last)) if first > last + 1 => {
                write!(f, ", first between frames {} and {first}", last + 1)?;
            }
            (Some(first), _) => write!(f, ", first at frame {first}")?,
            (None, _) => {}
        }
        if let Some([before, after]) = self.nodes {
            write!(f, ": {after} nodes instead of {before}")?;
            return self.step.map_or(Ok(()), |step| write!(f, "; {step}"));
        }
        match &self.displacement {
            // Goldens record the positions of some frames.
            Some(near) if self.first != Some(near.frame) => {
                write!(f, "; at frame {}, the next with recorded positions, {}", near.frame, near.words(""))?;
            }
            Some(near) => write!(f, ": {}", near.words(""))?,
            None => f.write_str("; how far nodes moved is known only with states.npz on both sides (--states)")?,
        }
        let farther = |far: &&Displacement| Some(far.frame) != self.displacement.map(|near| near.frame);
        if let Some(far) = self.largest.as_ref().filter(farther).filter(|far| far.distance > far.precision) {
            write!(f, "; farthest at frame {}: {}", far.frame, far.words(""))?;
        }
        if let Some(numbers) = &self.numbers {
            let [before, after] = [0, 1].map(|side| numbers[side].get(Diagnostic::TurnedOver));
            if before != after {
                write!(f, "; turned over {before} → {after}")?;
            }
        }
        self.step.map_or(Ok(()), |step| write!(f, "; {step}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(digest: &str, quantum: f64, at: &[f64]) -> State {
        let positions =
            Positions { quantum, every: 1, nodes: at.len(), at: at.iter().map(|&x| DVec3::X * x).collect() };
        State { time: None, digest: digest.into(), positions: Some(positions), numbers: None }
    }

    fn states(of: impl Fn(u64) -> State) -> States {
        let mut states = States::default();
        (0..4).for_each(|frame| states.add("run", frame, of(frame)));
        states
    }

    #[test]
    fn first_frame_node_and_distance_are_told() {
        let golden = states(|frame| state(&format!("a{frame}"), 1e-3, &[0.0, 1.0]));
        let same = states(|frame| state(&format!("a{frame}ffff"), 0.0, &[0.0, 1.0]));
        let all = run_differences(&golden, &same);
        assert!(moved(&golden, &same, &all).is_empty());
        let later = states(|frame| match frame {
            0 | 1 => state(&format!("a{frame}"), 0.0, &[0.0, 1.0]),
            _ => state("bb", 0.0, &[0.0, 1.0 + 0.1 * (frame - 1) as f64]),
        });
        let [found] = &moved(&golden, &later, &run_differences(&golden, &later))[..] else { panic!("one run") };
        assert_eq!((found.first, found.last_equal), (Some(2), Some(1)));
        assert_eq!(found.to_string(), "run, first at frame 2: node 1 by 100 mm; farthest at frame 3: node 1 by 200 mm");
        // Below what the record knows, nothing is made up.
        let hardly = states(|_| state("bb", 0.0, &[1e-5, 1.0]));
        let [found] = &moved(&golden, &hardly, &run_differences(&golden, &hardly))[..] else { panic!("one run") };
        assert!(
            found.to_string().starts_with("run, first at frame 0: no node by more than 1.73 mm (positions"),
            "{found}"
        );
    }

    #[test]
    fn runs_come_and_go_and_change_their_nodes() {
        let golden = states(|_| state("aa", 0.0, &[0.0]));
        let mut other = states(|_| state("bb", 0.0, &[0.0, 1.0]));
        let words = |actual: &States| {
            moved(&golden, actual, &run_differences(&golden, actual)).iter().map(Moved::to_string).collect::<Vec<_>>()
        };
        assert_eq!(words(&other), ["run, first at frame 0: 2 nodes instead of 1"]);
        other.runs[0].name = "walk".into();
        assert_eq!(words(&other), ["run is gone", "walk is new"]);
        // An empty digest says nothing and is no state.
        assert!(!State::default().equals(&State::default()));
    }

    #[test]
    fn another_step_is_told_and_whether_the_stiffest_run_made_it() {
        let with = |digest: &str, step: f64, cycle: f64| {
            let mut states = states(|_| state(digest, 0.0, &[0.0]));
            states.set_steps([("run", Step { step, cycle }), ("other", Step { step: 1.0, cycle: 1.0 })]);
            states
        };
        let told = |before: &States, after: &States| {
            let [found] = &moved(before, after, &run_differences(before, after))[..] else { panic!("one run") };
            found.to_string().split_once("velocities differ").expect("no other place").1.to_owned()
        };
        let before = with("aa", 0.0444 / 50.0, 0.0444);
        assert_eq!(told(&before, &with("bb", 0.0444 / 50.0, 0.0314)), "");
        let shared = "; its step changed from 0.000888 s to 0.000628 s (T/50 of the stiffest run)";
        assert_eq!(told(&before, &with("bb", 0.0314 / 50.0, 0.0314)), shared);
        assert_eq!(told(&before, &with("bb", 1e-5, 0.0444)), "; its step changed from 0.000888 s to 0.00001 s");
        // Records of earlier versions of this program know no steps.
        assert_eq!(told(&states(|_| state("aa", 0.0, &[0.0])), &with("bb", 1e-5, 0.0444)), "");
    }

    #[test]
    fn some_nodes_tell_of_themselves_alone() {
        let mut golden = state("aa", 0.0, &[0.0, 2.0]);
        let positions = golden.positions.as_mut().expect("known");
        (positions.every, positions.nodes) = (2, 4);
        let after = state("bb", 0.0, &[0.0, 9.0, 2.5, 9.0]);
        let found = displacement(7, &golden, &after).expect("known on both sides");
        assert_eq!((found.node, found.distance), (2, 0.5));
        // Two nodes half a metre nearer to or farther from each other: each is off by half of that.
        assert!((found.of_shape - 0.25).abs() < 1e-15, "{}", found.of_shape);
    }
}
