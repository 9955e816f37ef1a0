//! Kinematic constraints: nodes held and dragged.

use super::nodes::select;
use super::{KeyPath, motion};
use crate::reading::collector::{Collector, key_path, written};
use crate::scene::SceneBody;
use crate::scene::file::{GrabFile, HoldFile};
use crate::sim::{Assembly, Grip, Motion};
use std::collections::BTreeMap;

/// A constraint: its place in the scene, nodes of its bodies, when they are held, and how they move.
#[derive(Debug)]
pub(super) struct SceneGrip {
    path: KeyPath,
    /// The holder of the nodes, such as "held by `hold[0]`".
    holder: String,
    /// The nodes of each body of the scene, in rising order.
    nodes: Vec<Vec<u32>>,
    /// Start (s).
    from: f64,
    /// End (s).
    until: f64,
    motion: Motion,
}

impl SceneGrip {
    /// The constraints in a run of some of the bodies: one for each body that has nodes in it. So bodies do not depend on each
    /// other: gripped nodes turn about their own centre, and a body moves as it does alone, to the last bit.
    pub(super) fn in_run<'a>(&'a self, of: &'a [usize], bodies: &'a Assembly) -> impl Iterator<Item = (Grip, String)> {
        of.iter().enumerate().filter_map(|(at, &body)| {
            let first = bodies.nodes(at).start as u32;
            let nodes: Vec<u32> = self.nodes[body].iter().map(|node| first + node).collect();
            let Self { from, until, ref motion, .. } = *self;
            (!nodes.is_empty()).then(|| (Grip { nodes, from, until, motion: motion.clone() }, written(&self.path)))
        })
    }
}

/// The constraints, `hold` first, or `None` after reporting every mistake in them.
pub(super) fn resolve(
    holds: &[Option<HoldFile>],
    grabs: &[Option<GrabFile>],
    bodies: &[SceneBody],
    report: &mut Collector<'_>,
) -> Option<Vec<SceneGrip>> {
    let mut all: Vec<SceneGrip> = Vec::new();
    let dimension = bodies.first()?.body.dimension();
    for (at, typed) in holds.iter().enumerate() {
        let Some(typed) = typed else { continue };
        let path = key_path!["hold", at].to_vec();
        let until = typed.until.unwrap_or(f64::INFINITY);
        let nodes = select(typed.body.as_deref(), Some(&typed.nodes), bodies, (&path, "nodes"), report);
        if until <= typed.from {
            let message = format!("`hold[{at}]` ends at {until} s, not later than it begins at {} s", typed.from);
            report.at(&key_path![path; "until"], message, None);
        } else if let Some(nodes) = nodes {
            let holder = format!("held by `hold[{at}]`");
            all.push(SceneGrip { path, holder, nodes, from: typed.from, until, motion: Motion::Still });
        }
    }
    for (at, typed) in grabs.iter().enumerate() {
        let Some(typed) = typed else { continue };
        let grab = key_path!["grab", at].to_vec();
        let nodes = select(typed.body.as_deref(), Some(&typed.nodes), bodies, (&grab, "nodes"), report);
        let path = key_path![grab; "path"];
        if typed.path.repeat {
            let message = format!("`grab[{at}].path` repeats, so the nodes would never be released");
            report.at_key(&key_path![path; "repeat"], message, "remove `repeat`".to_owned());
            continue;
        }
        let motion = motion::keys(&typed.path, dimension, &path, report);
        let [from, until] =
            [typed.path.keys.first(), typed.path.keys.last()].map(|key| key.map_or(0.0, |key| key.time));
        if typed.path.keys.len() == 1 {
            let message =
                format!("`grab[{at}].path` has a single key: nodes grabbed at {from} s would be released at once");
            report.at(&path, message, "add a key, or write [[hold]] for nodes that stay where they are");
        } else if let (Some(nodes), Some(motion)) = (nodes, motion) {
            let holder = format!("grabbed by `grab[{at}]`");
            all.push(SceneGrip { path: grab, holder, nodes, from, until, motion });
        }
    }
    check_overlaps(&all, bodies, report);
    (all.len() == holds.len() + grabs.len()).then_some(all)
}

/// Reports constraints that are shorter than a time step (s), which would have no effect.
pub(super) fn check_steps(
    holds: &[Option<HoldFile>],
    grabs: &[Option<GrabFile>],
    step: f64,
    report: &mut Collector<'_>,
) {
    for (at, hold) in holds.iter().enumerate() {
        let until = hold.as_ref().and_then(|hold| Some((hold.until?, hold.from)));
        if let Some((until, from)) = until.filter(|(until, from)| (0.0..step).contains(&(until - from))) {
            let message = format!("`hold[{at}]` lasts {:.3e} s, but a time step takes {step:.3e} s", until - from);
            let help = "make it longer, or it holds nothing".to_owned();
            report.at(&key_path!["hold", at, "until"], message, help);
        }
    }
    for (at, grab) in grabs.iter().enumerate() {
        let path = key_path!["grab", at, "path"];
        grab.iter().for_each(|grab| motion::check_steps(&grab.path, step, &path, report));
    }
}

/// Reports nodes in two constraints at the same time.
fn check_overlaps(all: &[SceneGrip], bodies: &[SceneBody], report: &mut Collector<'_>) {
    let mut holders: BTreeMap<(usize, u32), Vec<usize>> = BTreeMap::new();
    for (at, grip) in all.iter().enumerate() {
        let nodes = grip.nodes.iter().enumerate().flat_map(|(body, nodes)| nodes.iter().map(move |&node| (body, node)));
        nodes.for_each(|node| holders.entry(node).or_default().push(at));
    }
    // One node is enough: others of the same two constraints have the same cause.
    let mut clashes: BTreeMap<[usize; 2], (usize, u32)> = BTreeMap::new();
    for (node, mut grips) in holders {
        let time = |grip: usize| (all[grip].from, all[grip].until);
        grips.sort_by(|&a, &b| time(a).0.total_cmp(&time(b).0));
        // A constraint that begins before another ends, begins before the last one ends.
        let mut last = grips[0];
        for &grip in &grips[1..] {
            if time(grip).0 < time(last).1 {
                clashes.entry([grip.max(last), grip.min(last)]).or_insert(node);
            }
            if time(grip).1 > time(last).1 {
                last = grip;
            }
        }
    }
    for ([second, first], (body, node)) in clashes {
        let (one, two) = (&all[first], &all[second]);
        let (from, until) = (one.from.max(two.from), one.until.min(two.until));
        let until = if until.is_finite() { format!("until {until} s") } else { "on".into() };
        // Only one of several bodies needs a name.
        let of = if bodies.len() == 1 { String::new() } else { format!(" of {}", bodies[body].in_words()) };
        let held = format!("{} and {} at once", one.holder, two.holder);
        let message = format!("node {node}{of} is {held}, from {from} s {until}");
        let help = "assign each node to one of them at a time".to_owned();
        report.at(&key_path![two.path; "nodes"], message, help);
    }
}
