//! Kinematic constraints: nodes held and dragged.

use super::nodes::select;
use super::{Typed, motion};
use crate::reading::captions;
use crate::reading::collector::Here;
use crate::reading::words::several;
use crate::scene::SceneBody;
use crate::scene::file::{NodesFile, Side};
use crate::sim::{Assembly, Dimension, Grip, Motion};
use glam::DVec3;
use std::collections::BTreeMap;
use std::ops::Range;

/// A constraint: its place in the scene, nodes of its bodies, when they are held, and how they move.
#[derive(Debug)]
pub(super) struct SceneGrip<'s> {
    here: Here<'s>,
    /// The nodes of each body of the scene, in rising order.
    nodes: Vec<Vec<u32>>,
    /// Start (s).
    from: f64,
    /// End (s).
    until: f64,
    motion: Motion,
}

impl SceneGrip<'_> {
    /// Whether it holds a node of a body of the scene as long as an interval lasts (s).
    pub(super) fn holds(&self, (body, node): (usize, u32), during: &Range<f64>) -> bool {
        let covers = self.from <= during.start && during.end <= self.until;
        covers && self.nodes[body].binary_search(&node).is_ok()
    }

    /// The constraints in a run of some of the bodies: one for each body that has nodes in it. So bodies do not depend on each
    /// other: gripped nodes turn about their own centre, and a body moves as it does alone, to the last bit.
    pub(super) fn in_run<'a>(&'a self, of: &'a [usize], bodies: &'a Assembly) -> impl Iterator<Item = (Grip, String)> {
        of.iter().enumerate().filter_map(|(at, &body)| {
            let first = bodies.nodes(at).start as u32;
            let nodes: Vec<u32> = self.nodes[body].iter().map(|node| first + node).collect();
            let Self { from, until, ref motion, .. } = *self;
            (!nodes.is_empty()).then(|| (Grip { nodes, from, until, motion: motion.clone() }, self.here.to_string()))
        })
    }
}

/// The constraints, `hold` first, without those with mistakes, which are reported.
pub(super) fn resolve<'s>(scene: &Typed<'s>, bodies: &[SceneBody]) -> Vec<SceneGrip<'s>> {
    let mut all = Vec::new();
    for (here, typed) in scene.each("hold", &scene.file.hold) {
        let until = typed.until.unwrap_or(f64::INFINITY);
        let nodes = select(typed.body.as_deref(), Some(&typed.nodes), bodies, (&here, "nodes"));
        if until <= typed.from {
            let message = format!("`{here}` ends at {until} s, not later than it begins at {} s", typed.from);
            here.to("until").wrong(message, None);
        } else if let Some(nodes) = nodes {
            warn_of_hinges(&here, &typed.nodes, &nodes, bodies);
            all.push(SceneGrip { here, nodes, from: typed.from, until, motion: Motion::Still });
        }
    }
    for (here, typed) in scene.each("grab", &scene.file.grab) {
        let nodes = select(typed.body.as_deref(), Some(&typed.nodes), bodies, (&here, "nodes"));
        let path = here.to("path");
        if typed.path.repeat {
            let message = format!("`{path}` repeats, so the nodes would never be released");
            path.to("repeat").wrong_key(message, "remove `repeat`");
            continue;
        }
        let motion = motion::keys(&typed.path, bodies[0].body.dimension(), &path);
        let [from, until] =
            [typed.path.keys.first(), typed.path.keys.last()].map(|key| key.map_or(0.0, |key| key.time));
        if typed.path.keys.len() == 1 {
            let message = format!("`{path}` has a single key: nodes grabbed at {from} s would be released at once");
            path.wrong(message, "add a key, or write [[hold]] for nodes that stay where they are");
        } else if let (Some(nodes), Some(motion)) = (nodes, motion) {
            warn_of_hinges(&here, &typed.nodes, &nodes, bodies);
            all.push(SceneGrip { here, nodes, from, until, motion });
        }
    }
    check_overlaps(&all, bodies);
    all
}

/// Reports constraints that are shorter than a time step (s), which would have no effect.
pub(super) fn check_steps(scene: &Typed<'_>, step: f64) {
    for (here, hold) in scene.each("hold", &scene.file.hold) {
        let lasts = hold.until.map(|until| until - hold.from);
        if let Some(lasts) = lasts.filter(|lasts| (0.0..step).contains(lasts)) {
            let message = format!("`{here}` lasts {lasts:.3e} s, but a time step takes {step:.3e} s");
            here.to("until").wrong(message, "make it longer, or it holds nothing");
        }
    }
    scene
        .each("grab", &scene.file.grab)
        .for_each(|(here, grab)| motion::check_steps(&grab.path, step, &here.to("path")));
}

/// Warns of a side of a filled body in space on which all nodes lie on one line: the body turns about it, as its elements are too large for it.
fn warn_of_hinges(here: &Here<'_>, typed: &NodesFile, nodes: &[Vec<u32>], bodies: &[SceneBody]) {
    if !matches!(typed, NodesFile::Named(name) if Side::ALL.iter().any(|side| captions::typed(side) == *name)) {
        return;
    }
    let filled = bodies.iter().zip(nodes).filter(|(of, nodes)| of.body.carried().is_some() && !nodes.is_empty());
    for (of, nodes) in filled.filter(|(of, _)| of.body.dimension() == Dimension::Space) {
        let places = || nodes.iter().map(|&node| of.body.rest()[node as usize] - of.body.rest()[nodes[0] as usize]);
        let farthest = places().fold(DVec3::ZERO, |far, at| if at.length() > far.length() { at } else { far });
        let across = places().map(|at| at.cross(farthest.normalize_or_zero()).length()).fold(0.0, f64::max);
        if across < 1e-6 * of.body.extent() {
            let nodes = several(nodes.len() as u64, "node");
            let message = format!("`{here}` takes {nodes} of {}, on one line, about which it turns", of.in_words());
            here.to("nodes").warn(message, "fill it with smaller elements, or with cubes, or take the nodes in a box");
        }
    }
}

/// Reports nodes in two constraints at the same time.
fn check_overlaps(all: &[SceneGrip<'_>], bodies: &[SceneBody]) {
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
        let [first, second] = [one, two].map(|grip| match grip.motion {
            Motion::Still => format!("held by `{}`", grip.here),
            _ => format!("grabbed by `{}`", grip.here),
        });
        let message = format!("node {node}{of} is {first} and {second} at once, from {from} s {until}");
        two.here.to("nodes").wrong(message, "assign each node to one of them at a time");
    }
}
