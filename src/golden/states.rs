//! What is known about states, exactly or rounded, and what moved between two sides.

use crate::output::state_digest;
use crate::sim::apart::{distances, largest};
use crate::sim::body::Dimension;
use crate::sim::diagnostics::{Chosen, Diagnostic, Reach};
use crate::sim::snapshot::Snapshot;
use crate::sim::words::rounded;
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
    /// How its time is stepped, if that is known.
    pub(super) step: Option<Step>,
    /// By the number of the frame.
    pub(super) states: BTreeMap<u64, State>,
}

/// How the time of a run is stepped.
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
    pub(super) places: Option<Places>,
    /// What describes it, coarsely.
    pub(super) numbers: Option<Chosen>,
}

/// Where nodes were.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Places {
    /// To what positions are rounded (m); 0: not at all.
    pub(super) quantum: f64,
    /// Every so many nodes are known, from the first one.
    pub(super) every: usize,
    /// How many nodes there are in all.
    pub(super) nodes: usize,
    /// Positions (m).
    pub(super) at: Vec<DVec3>,
}

impl State {
    /// All that a snapshot tells; its places only if they are asked for.
    pub(super) fn of(snapshot: &Snapshot, with_places: bool) -> Self {
        let at = &snapshot.position;
        let places = with_places.then(|| Places { quantum: 0.0, every: 1, nodes: at.len(), at: at.clone() });
        let numbers = Some(Chosen::within(Reach::Goldens, &snapshot.diagnostics));
        Self { time: Some(snapshot.time), digest: state_digest(snapshot), places, numbers }
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

    /// Whether nothing is known at all.
    fn is_empty(&self) -> bool {
        self.runs.iter().all(|run| run.states.is_empty())
    }

    /// Adds all that others know, which counts where both know something.
    pub(super) fn extend(&mut self, others: Self) {
        for run in others.runs {
            for (frame, state) in run.states {
                self.add(&run.name, frame, state);
            }
        }
    }

    /// Notes how the time of runs is stepped, of those that are known.
    pub(super) fn set_steps<'a>(&mut self, steps: impl IntoIterator<Item = (&'a str, Step)>) {
        for (name, step) in steps {
            if let Some(run) = self.runs.iter_mut().find(|run| run.name == name) {
                run.step = Some(step);
            }
        }
    }

    /// Adds what is known of a run at a frame.
    pub(super) fn add(&mut self, run: &str, frame: u64, state: State) {
        let at = self.runs.iter().position(|known| known.name == run).unwrap_or_else(|| {
            self.runs.push(Run { name: run.to_owned(), ..Run::default() });
            self.runs.len() - 1
        });
        self.runs[at].states.insert(frame, state);
    }
}

/// How far a node is from where it was expected.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Displacement {
    /// The frame.
    pub frame: u64,
    /// The node that is farthest away, counted from 0.
    pub node: usize,
    /// How far (m).
    pub distance: f64,
    /// The largest distance that is left after the best rigid fit of the nodes to where they were expected (m): how far the
    /// shape is another one.
    pub of_shape: f64,
    /// To what distances are known (m); 0: exactly.
    pub precision: f64,
}

/// What became of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Change {
    /// Its states are other ones.
    Moved,
    /// It is not there any more.
    Gone,
    /// It was not there.
    New,
}

/// Another time step than was expected.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct StepChange {
    /// As it was expected (s).
    pub before: f64,
    /// As it is (s).
    pub after: f64,
    /// Into how many parts both divide the cycle T of the stiffest run, which is another one then; `None` if they do not.
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

/// A run whose states are not those that were expected.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Moved {
    /// Name of the run.
    pub run: String,
    /// What became of it.
    pub change: Change,
    /// The first frame, of those that were compared, with another state.
    pub first: Option<u64>,
    /// The last frame before that with the state that was expected.
    pub last_equal: Option<u64>,
    /// Its time step, if that is another one, and both are known.
    pub step: Option<StepChange>,
    /// How many nodes were expected, and how many there are, if these are not as many.
    pub nodes: Option<[usize; 2]>,
    /// The node that is farthest away at the first frame with another state at which places are known.
    pub displacement: Option<Displacement>,
    /// And where it is farthest away of all frames.
    pub largest: Option<Displacement>,
    /// What describes the state at the first frame of another state that has such numbers, as expected and as it is.
    pub numbers: Option<[Chosen; 2]>,
}

/// A run on both sides, frame by frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunDifference {
    /// Name of the run.
    pub run: String,
    /// To what displacements are known (m); 0: exactly.
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
pub(super) fn courses(expected: &States, actual: &States) -> Vec<RunDifference> {
    let course = |run: &Run| {
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
    expected.runs.iter().filter_map(course).collect()
}

/// The runs that moved, by their courses; and those on one side only.
pub(super) fn moved(expected: &States, actual: &States, courses: &[RunDifference]) -> Vec<Moved> {
    if expected.is_empty() || actual.is_empty() {
        // Without recorded states no runs are gone or new.
        return Vec::new();
    }
    let lone = |run: &Run, change| Moved {
        run: run.name.clone(),
        change,
        first: None,
        last_equal: None,
        step: None,
        nodes: None,
        displacement: None,
        largest: None,
        numbers: None,
    };
    let absent = |run: &&Run, from: &States| !run.states.is_empty() && from.run(&run.name).is_none();
    let gone = expected.runs.iter().filter(|run| absent(run, actual)).map(|run| lone(run, Change::Gone));
    let new = actual.runs.iter().filter(|run| absent(run, expected)).map(|run| lone(run, Change::New));
    let moved = courses.iter().filter_map(|course| {
        let first = course.moments.iter().find(|moment| moment.moved)?.frame;
        let equal = course.moments.iter().take_while(|moment| !moment.moved).last();
        let displaced = || course.moments.iter().filter_map(|moment| moment.displacement);
        let runs = [expected, actual].map(|side| side.run(&course.run).expect("on both sides"));
        let [before, after] = runs.map(|run| &run.states);
        let both = |frame: &u64| Some([before.get(frame)?, after.get(frame)?]);
        let later = || course.moments.iter().filter(|moment| moment.moved).map(|moment| moment.frame);
        let numbers = later().find_map(|frame| {
            let [before, after] = both(&frame)?;
            Some([before.numbers.clone()?, after.numbers.clone()?])
        });
        let nodes = later().find_map(|frame| {
            let [before, after] = both(&frame)?;
            let nodes = [before.places.as_ref()?.nodes, after.places.as_ref()?.nodes];
            (nodes[0] != nodes[1]).then_some(nodes)
        });
        Some(Moved {
            run: course.run.clone(),
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

/// The node that is farthest away, of those known on both sides.
fn displacement(frame: u64, before: &State, after: &State) -> Option<Displacement> {
    let (before, after) = before.places.as_ref().zip(after.places.as_ref())?;
    if before.nodes != after.nodes {
        return None;
    }
    // Rounding moves each coordinate by half a quantum at most.
    let precision = 0.5 * 3_f64.sqrt() * (before.quantum + after.quantum);
    let nodes = (0..before.nodes).step_by(before.every).filter(|node| node % after.every == 0);
    let known: Vec<usize> = nodes.collect();
    let at = |places: &Places| known.iter().map(|node| places.at[node / places.every]).collect::<Vec<_>>();
    let [before, after] = [at(before), at(after)];
    let farthest = known.iter().copied().zip(distances(&before, &after));
    let (node, distance) = farthest.reduce(|one, other| if other.1 > one.1 { other } else { one })?;
    let is_flat = before.iter().chain(&after).all(|at| at.z == 0.0);
    let dimension = if is_flat { Dimension::Plane } else { Dimension::Space };
    let of_shape = largest(dimension, [&before, &after], true);
    Some(Displacement { frame, node, distance, of_shape, precision })
}

impl Displacement {
    /// How far in words; `place` says where, if that is not plain.
    pub(super) fn words(&self, place: &str) -> String {
        let Self { node, distance, precision, .. } = self;
        if *precision == 0.0 && *distance == 0.0 {
            format!("no node{place}, but velocities differ")
        } else if distance <= precision {
            // Both rounding errors can have the same direction.
            format!("no node by more than {:.0e} m{place} (positions are recorded no finer)", 2.0 * precision)
        } else {
            format!("node {node} by {distance:.2e} m{place}")
        }
    }
}

impl fmt::Display for Displacement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words(&format!(" at frame {}", self.frame)))
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
        match (&self.displacement, &self.largest) {
            (Some(near), Some(far)) if near.frame != far.frame && far.distance > far.precision => {
                write!(f, ": {near}; farthest {far}")?;
            }
            (Some(near), _) => write!(f, ": {near}")?,
            (None, _) => f.write_str("; by how much is not recorded")?,
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
        let places = Places { quantum, every: 1, nodes: at.len(), at: at.iter().map(|&x| DVec3::X * x).collect() };
        State { time: None, digest: digest.into(), places: Some(places), numbers: None }
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
        let all = courses(&golden, &same);
        assert!(moved(&golden, &same, &all).is_empty());
        let later = states(|frame| match frame {
            0 | 1 => state(&format!("a{frame}"), 0.0, &[0.0, 1.0]),
            _ => state("bb", 0.0, &[0.0, 1.0 + 0.1 * (frame - 1) as f64]),
        });
        let [found] = &moved(&golden, &later, &courses(&golden, &later))[..] else { panic!("one run") };
        assert_eq!((found.first, found.last_equal), (Some(2), Some(1)));
        assert_eq!(
            found.to_string(),
            "run, first at frame 2: node 1 by 1.00e-1 m at frame 2; farthest node 1 by 2.00e-1 m at frame 3"
        );
        // Below what the record knows, nothing is made up.
        let hardly = states(|_| state("bb", 0.0, &[1e-5, 1.0]));
        let [found] = &moved(&golden, &hardly, &courses(&golden, &hardly))[..] else { panic!("one run") };
        assert!(
            found.to_string().starts_with("run, first at frame 0: no node by more than 2e-3 m at frame 0 (positions"),
            "{found}"
        );
    }

    #[test]
    fn runs_come_and_go_and_change_their_nodes() {
        let golden = states(|_| state("aa", 0.0, &[0.0]));
        let mut other = states(|_| state("bb", 0.0, &[0.0, 1.0]));
        let words = |actual: &States| {
            moved(&golden, actual, &courses(&golden, actual)).iter().map(Moved::to_string).collect::<Vec<_>>()
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
            let [found] = &moved(before, after, &courses(before, after))[..] else { panic!("one run") };
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
        let places = golden.places.as_mut().expect("known");
        (places.every, places.nodes) = (2, 4);
        let after = state("bb", 0.0, &[0.0, 9.0, 2.5, 9.0]);
        let found = displacement(7, &golden, &after).expect("known on both sides");
        assert_eq!((found.node, found.distance), (2, 0.5));
        // Two nodes half a metre nearer to or farther from each other: each is off by half of that.
        assert!((found.of_shape - 0.25).abs() < 1e-15, "{}", found.of_shape);
    }
}
