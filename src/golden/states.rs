//! Known states, exact or rounded, and the differences between two sides.

use crate::reading::captions::quantity;
use glam::DVec3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The states of several runs. The bodies of a run of several are recorded like runs of their own, named `RUN · BODY`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct States {
    /// In the order of the scene.
    pub(super) runs: Vec<Run>,
    /// The stride of nodes whose positions are known, from the first one.
    pub(super) every: usize,
    /// The step to which positions are rounded (m); 0 if they are exact.
    pub(super) quantum: f64,
}

/// The states of one run, or of one of its several bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Run {
    pub(super) name: String,
    /// The number of nodes; 0 if it is not known.
    pub(super) nodes: usize,
    /// By the number of the frame.
    pub(super) states: BTreeMap<u64, State>,
}

/// A run or body at one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct State {
    /// Digest of all positions and velocities in hexadecimal digits, complete or shortened.
    pub(super) digest: String,
    /// Positions of known nodes (m).
    pub(super) positions: Option<Vec<DVec3>>,
}

impl Default for States {
    fn default() -> Self {
        Self { runs: Vec::new(), every: 1, quantum: 0.0 }
    }
}

impl States {
    pub(super) fn run(&self, name: &str) -> Option<&Run> {
        self.runs.iter().find(|run| run.name == name)
    }

    /// The run of this name. A new run is added.
    pub(super) fn run_mut(&mut self, name: &str) -> &mut Run {
        let at = self.runs.iter().position(|run| run.name == name).unwrap_or_else(|| {
            self.runs.push(Run { name: name.to_owned(), ..Run::default() });
            self.runs.len() - 1
        });
        &mut self.runs[at]
    }

    /// The last known frame.
    pub(super) fn last(&self) -> Option<u64> {
        self.runs.iter().filter_map(|run| run.states.keys().next_back()).max().copied()
    }
}

impl State {
    /// Whether two states are the same, as far as their digests are known.
    fn equals(&self, other: &Self) -> bool {
        let length = self.digest.len().min(other.digest.len());
        length > 0 && self.digest.as_bytes()[..length] == other.digest.as_bytes()[..length]
    }
}

/// The distance of a node from its expected position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Displacement {
    /// The frame.
    pub(crate) frame: u64,
    /// The node with the largest distance, counted from 0.
    pub(crate) node: usize,
    /// The distance (m).
    pub(crate) distance: f64,
    /// The precision of the distance (m); 0 if it is exact.
    pub(crate) precision: f64,
}

/// The change of a run or body.
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

/// A run, or one of its several bodies, with unexpected states.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Moved {
    /// Name of the run, with that of the body.
    pub(crate) run: String,
    /// The change.
    pub(crate) change: Change,
    /// The first compared frame with another state.
    pub(crate) first: Option<u64>,
    /// The last compared frame before that, whose state is as expected.
    pub(crate) last_equal: Option<u64>,
    /// The expected and the actual number of nodes, if they differ.
    pub(crate) nodes: Option<[usize; 2]>,
    /// The largest displacement at the first frame with another state and known positions.
    pub(crate) displacement: Option<Displacement>,
    /// The largest displacement of all frames.
    pub(crate) largest: Option<Displacement>,
}

/// The runs that moved, and the runs on one side only. If a side has no known state, nothing has moved.
pub(super) fn moved(expected: &States, actual: &States) -> Vec<Moved> {
    if expected.last().is_none() || actual.last().is_none() {
        return Vec::new();
    }
    let lone = |run: &Run, change| Moved { run: run.name.clone(), change, ..Moved::default() };
    let gone = expected.runs.iter().filter(|run| actual.run(&run.name).is_none());
    let new = actual.runs.iter().filter(|run| expected.run(&run.name).is_none());
    let both = expected.runs.iter().filter_map(|run| Some((run, actual.run(&run.name)?)));
    let moved = both.filter_map(|(before, after)| moved_run([expected, actual], [before, after]));
    moved.chain(gone.map(|run| lone(run, Change::Gone))).chain(new.map(|run| lone(run, Change::New))).collect()
}

fn moved_run(sides: [&States; 2], [before, after]: [&Run; 2]) -> Option<Moved> {
    let known = before.states.iter().filter_map(|(&frame, state)| Some((frame, [state, after.states.get(&frame)?])));
    let (mut first, mut last_equal) = (None, None);
    let mut displacements: Vec<Displacement> = Vec::new();
    for (frame, [expected, actual]) in known {
        if !expected.equals(actual) {
            first = first.or(Some(frame));
            let positions = expected.positions.as_ref().zip(actual.positions.as_ref());
            let positions = positions.filter(|_| before.nodes == after.nodes);
            displacements.extend(positions.and_then(|(one, other)| displacement(frame, sides, [one, other])));
        } else if first.is_none() {
            last_equal = Some(frame);
        }
    }
    Some(Moved {
        run: before.name.clone(),
        change: Change::Moved,
        first: Some(first?),
        last_equal,
        nodes: (before.nodes != after.nodes).then_some([before.nodes, after.nodes]),
        displacement: displacements.first().copied(),
        // The first of equal maxima.
        largest: displacements.into_iter().reduce(|one, other| if other.distance > one.distance { other } else { one }),
    })
}

/// The largest displacement of the nodes that both sides know.
fn displacement(frame: u64, sides: [&States; 2], positions: [&[DVec3]; 2]) -> Option<Displacement> {
    let [one, other] = sides.map(|side| side.every);
    let nodes = (0..positions[0].len() * one).step_by(one).filter(|node| node % other == 0);
    let nodes: Vec<usize> = nodes.filter(|node| node / other < positions[1].len()).collect();
    let [before, after] =
        [0, 1].map(|at| -> Vec<DVec3> { nodes.iter().map(|node| positions[at][node / sides[at].every]).collect() });
    let farthest = nodes.iter().copied().zip(before.iter().zip(&after).map(|(before, after)| before.distance(*after)));
    let (node, distance) = farthest.reduce(|one, other| if other.1 > one.1 { other } else { one })?;
    // Rounding moves each coordinate by half a quantum at most.
    let precision = 0.5 * 3_f64.sqrt() * (sides[0].quantum + sides[1].quantum);
    Some(Displacement { frame, node, distance, precision })
}

impl fmt::Display for Displacement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { node, distance, precision, .. } = self;
        if *precision == 0.0 && *distance == 0.0 {
            f.write_str("no node, but velocities differ")
        } else if distance <= precision {
            // Both rounding errors can have the same direction.
            write!(f, "no node by more than {} (positions are recorded no finer)", quantity(2.0 * precision, "m"))
        } else {
            write!(f, "node {node} by {}", quantity(*distance, "m"))
        }
    }
}

impl fmt::Display for Moved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.run)?;
        match (self.change, self.first, self.last_equal) {
            (Change::Gone, ..) => return f.write_str(" is gone"),
            (Change::New, ..) => return f.write_str(" is new"),
            (Change::Moved, Some(first), Some(last)) if first > last + 1 => {
                write!(f, ", first between frames {} and {first}", last + 1)?;
            }
            (Change::Moved, first, _) => write!(f, ", first at frame {}", first.unwrap_or(0))?,
        }
        if let Some([before, after]) = self.nodes {
            return write!(f, ": {after} nodes instead of {before}");
        }
        let Some(near) = &self.displacement else { return Ok(()) };
        match self.first == Some(near.frame) {
            true => write!(f, ": {near}")?,
            false => write!(f, "; at frame {}, the next with recorded positions: {near}", near.frame)?,
        }
        let farther = self.largest.filter(|far| far.frame != near.frame && far.distance > far.precision);
        farther.map_or(Ok(()), |far| write!(f, "; farthest at frame {}: {far}", far.frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn states(quantum: f64, of: impl Fn(u64) -> (&'static str, Vec<f64>)) -> States {
        let state = |frame| {
            let (digest, places) = of(frame);
            let positions = Some(places.into_iter().map(|x| DVec3::X * x).collect());
            (frame, State { digest: digest.to_owned(), positions })
        };
        let nodes = of(0).1.len();
        let run = Run { name: "run".to_owned(), nodes, states: (0..4).map(state).collect() };
        States { runs: vec![run], every: 1, quantum }
    }

    fn words(one: &States, other: &States) -> Vec<String> {
        moved(one, other).iter().map(Moved::to_string).collect()
    }

    #[test]
    fn first_frame_node_and_distance_are_told() {
        let golden = states(1e-3, |_| ("aaaa", vec![0.0, 1.0]));
        assert_eq!(words(&golden, &states(0.0, |_| ("aaaaffff", vec![0.0, 1.0]))), [""; 0]);
        let later = states(0.0, |frame| match frame {
            0 | 1 => ("aaaa", vec![0.0, 1.0]),
            _ => ("bbbb", vec![0.0, 1.0 + 0.1 * (frame - 1) as f64]),
        });
        let told = "run, first at frame 2: node 1 by 100 mm; farthest at frame 3: node 1 by 200 mm";
        assert_eq!(words(&golden, &later), [told]);
        assert_eq!(moved(&golden, &later)[0].last_equal, Some(1));
        // Without recorded positions the next recorded ones are named, and without digests the frames between.
        let mut sparse = golden.clone();
        sparse.runs[0].states.get_mut(&2).expect("four frames").positions = None;
        sparse.runs[0].states.remove(&1);
        let told = "run, first between frames 1 and 2; at frame 3, the next with recorded positions: node 1 by 200 mm";
        assert_eq!(words(&sparse, &later), [told]);
        // Changes below the precision of the record have no distance.
        let hardly = words(&golden, &states(0.0, |_| ("bbbb", vec![1e-5, 1.0])));
        assert!(hardly[0].starts_with("run, first at frame 0: no node by more than 1.73 mm (positions"), "{hardly:?}");
        let velocities = words(&later, &states(0.0, |_| ("cccc", vec![0.0, 1.0])));
        assert!(velocities[0].starts_with("run, first at frame 0: no node, but velocities differ; "), "{velocities:?}");
    }

    #[test]
    fn runs_come_and_go_and_change_their_nodes() {
        let golden = states(0.0, |_| ("aa", vec![0.0]));
        let mut other = states(0.0, |_| ("bb", vec![0.0, 1.0]));
        assert_eq!(words(&golden, &other), ["run, first at frame 0: 2 nodes instead of 1"]);
        other.runs[0].name = "walk".into();
        assert_eq!(words(&golden, &other), ["run is gone", "walk is new"]);
        assert_eq!(words(&golden, &States::default()), [""; 0]);
        // An empty digest is no state.
        assert!(!State::default().equals(&State::default()));
    }

    /// Nodes that one side does not know are not compared.
    #[test]
    fn nodes_are_compared_with_themselves() {
        let places: Vec<f64> = (0..13).map(f64::from).collect();
        let known = |every: usize, digest: &'static str| {
            let mut side = states(0.0, |_| (digest, places.iter().copied().step_by(every).collect()));
            (side.every, side.runs[0].nodes) = (every, places.len());
            side
        };
        for (one, other) in [(1, 1), (2, 3), (3, 2), (1, 4), (4, 1)] {
            let (before, mut after) = (known(one, "aa"), known(other, "bb"));
            assert_eq!(moved(&before, &after)[0].largest.expect("known").distance, 0.0, "{one} {other}");
            let moved_node = 12 / other;
            let state = after.runs[0].states.get_mut(&2).expect("four frames");
            state.positions.as_mut().expect("known")[moved_node].x += 0.5;
            let found = moved(&before, &after)[0].largest.expect("known");
            assert_eq!((found.frame, found.node, found.distance), (2, 12, 0.5), "{one} {other}");
        }
    }
}
