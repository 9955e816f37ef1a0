//! What is measured of single things of a scene: forces of what acts on bodies, and displacements of named nodes.

use super::{Run, Scene};
use crate::look::{Measure, PlotOf};
use crate::sim::{Motion, Obstacle, Reaction, Source};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Nodes with a name, whose displacement is measured.
#[derive(Clone, Debug)]
pub struct Probe {
    /// Its name, unique in its scene.
    pub name: String,
    /// The nodes of each body of the scene, in rising order.
    pub nodes: Vec<Vec<u32>>,
}

/// The names of the last of the numbers of [`Scene::displaced`].
pub(crate) const SIZES: [&str; 3] = ["mean", "least", "greatest"];

/// What a chart shows of one thing at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// The value; that of nodes is their mean.
    pub value: f64,
    /// The least and the greatest value of nodes.
    pub range: [f64; 2],
    /// The displacement on the axis to the right (m).
    pub against: f64,
}

/// Measures what a chart shows of a thing in a run.
#[derive(Debug)]
pub(crate) struct Meter<'a> {
    plot: Measure,
    exerting: Vec<Source>,
    /// The only body of the run on which it is exerted.
    on: Option<usize>,
    moved: Option<Moved<'a>>,
    against: Option<Moved<'a>>,
    along: Option<DVec3>,
}

/// What has a displacement.
#[derive(Debug)]
enum Moved<'a> {
    /// Nodes of a run with the places from which they count (m).
    Nodes(Vec<(usize, DVec3)>),
    Obstacle(&'a Obstacle),
}

impl Moved<'_> {
    /// The displacement of each node from where it is placed, or that of the pivot of an obstacle since the start (m).
    fn ways(&self, time: f64, position: &[DVec3]) -> Vec<DVec3> {
        match self {
            Self::Nodes(nodes) => {
                nodes.iter().map(|&(node, start)| position.get(node).map_or(DVec3::NAN, |&at| at - start)).collect()
            }
            Self::Obstacle(obstacle) => vec![obstacle.pose(time).shift - obstacle.pose(0.0).shift],
        }
    }
}

impl<'a> Meter<'a> {
    /// A meter for a chart of a run of a scene.
    pub(crate) fn new(scene: &'a Scene, run: &Run, of: &PlotOf) -> Self {
        let named = |name: &String| run.of.iter().position(|&body| scene.bodies[body].name == *name);
        let on = of.on.as_ref().map(named);
        Self {
            plot: of.plot,
            // A run without the body has no such force.
            exerting: if on == Some(None) { Vec::new() } else { scene.sources(run, &of.of) },
            on: on.flatten(),
            moved: scene.moved(run, &of.of),
            against: of.against.as_ref().and_then(|name| scene.moved(run, name)),
            along: scene.along(of),
        }
    }

    /// What is measured at a time (s) with nodes at positions (m), under the forces of the last interval; NaN if it is not known.
    pub(crate) fn read(&self, time: f64, position: &[DVec3], forces: &[Reaction]) -> Reading {
        let size = |vector: DVec3| self.along.map_or_else(|| vector.length(), |along| vector.dot(along));
        let ways = |moved: &Option<Moved<'_>>| moved.as_ref().map_or_else(Vec::new, |moved| moved.ways(time, position));
        let all: Vec<f64> = match self.plot {
            Measure::Displacement => ways(&self.moved).into_iter().map(size).collect(),
            _ if self.exerting.is_empty() || forces.is_empty() => vec![size(DVec3::NAN)],
            force => {
                let [exerted, torque] = sum(forces.iter().filter(|one| self.exerting.contains(&one.from)), self.on);
                vec![size(if force == Measure::Force { exerted } else { torque })]
            }
        };
        let range = [all.iter().copied().reduce(f64::min), all.iter().copied().reduce(f64::max)];
        let against = ways(&self.against);
        Reading {
            value: all.iter().sum::<f64>() / all.len() as f64,
            range: range.map(|end| end.unwrap_or(f64::NAN)),
            against: size(against.iter().sum::<DVec3>() / against.len() as f64),
        }
    }
}

/// The sums of forces (N) and of torques (N m) on a body, or on all.
fn sum<'a>(forces: impl Iterator<Item = &'a Reaction>, on: Option<usize>) -> [DVec3; 2] {
    let found = forces.filter(|one| on.is_none_or(|on| one.on == on));
    found.fold([DVec3::ZERO; 2], |[force, torque], one| [force + one.force, torque + one.torque])
}

/// The forces of a moment in a run, of all that exerts some.
#[derive(Debug)]
pub(crate) struct Forces<'a> {
    /// Each name with the forces of what has it, body after body.
    named: Vec<(&'a str, Vec<&'a Reaction>)>,
}

impl<'a> Forces<'a> {
    /// None are known without a run or if there are no `forces`.
    pub(crate) fn new(scene: &'a Scene, run: Option<&Run>, forces: &'a [Reaction]) -> Self {
        let mut by: HashMap<Source, Vec<&Reaction>> = HashMap::new();
        forces.iter().for_each(|one| by.entry(one.from).or_default().push(one));
        let of = |source: Source| by.get(&source).into_iter().flatten().copied();
        let sources = |name| run.map_or_else(Vec::new, |run| scene.sources(run, name));
        let named = scene.exerting().into_iter().map(|name| (name, sources(name).into_iter().flat_map(of).collect()));
        Self { named: named.collect() }
    }

    /// The force (N) and the torque about the origin (N m) of each thing on a body, or on all; NaN where they are not known.
    pub(crate) fn on(&self, on: Option<usize>) -> impl Iterator<Item = (&'a str, [DVec3; 2])> {
        let of = move |all: &[&Reaction]| if all.is_empty() { [DVec3::NAN; 2] } else { sum(all.iter().copied(), on) };
        self.named.iter().map(move |(name, all)| (*name, of(all)))
    }
}

impl Scene {
    /// The names of what exerts forces: obstacles, constraints and, if there are several, bodies.
    pub(crate) fn exerting(&self) -> Vec<&str> {
        // A constraint on several bodies is one for each of them.
        let mut grips: Vec<&str> = self.runs.iter().flat_map(|run| &run.grip_names).map(String::as_str).collect();
        grips.sort_unstable_by_key(|name| (name.starts_with("grab"), name.len(), *name));
        grips.dedup();
        let bodies = self.bodies.iter().filter(|_| self.bodies.len() > 1).map(|body| body.name.as_str());
        self.obstacle_names.iter().map(String::as_str).chain(grips).chain(bodies).collect()
    }

    /// What has a name among that in a run.
    pub(crate) fn sources(&self, run: &Run, name: &str) -> Vec<Source> {
        if let Some(at) = self.obstacle_names.iter().position(|other| other == name) {
            return vec![Source::Obstacle(at)];
        }
        let grips = (0..).zip(&run.grip_names).filter(|(_, other)| *other == name).map(|(at, _)| Source::Grip(at));
        let own = (0..).zip(&run.of).filter(|&(_, &of)| self.bodies.len() > 1 && self.bodies[of].name == name);
        grips.chain(own.map(|(at, _)| Source::Body(at))).collect()
    }

    /// The names of what has a displacement: probes, constraints and obstacles.
    pub(crate) fn moving(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.probes.iter().map(|probe| probe.name.as_str()).collect();
        names.extend(self.exerting().into_iter().filter(|name| self.bodies.iter().all(|body| body.name != *name)));
        names
    }

    /// What has a name among that in a run; `None` without nodes in it.
    fn moved(&self, run: &Run, name: &str) -> Option<Moved<'_>> {
        if let Some(at) = self.obstacle_names.iter().position(|other| other == name) {
            return Some(Moved::Obstacle(&self.obstacles[at]));
        }
        let probe = self.probes.iter().find(|probe| probe.name == name);
        let grips = run.grips.iter().zip(&run.grip_names).filter(|(_, other)| *other == name);
        let nodes: Vec<usize> = match probe {
            Some(probe) => (0..run.of.len()).flat_map(|at| probe.in_body(run, at)).collect(),
            None => grips.flat_map(|(grip, _)| &grip.nodes).map(|&node| node as usize).collect(),
        };
        let start = |node: usize| (node, run.placed()[node]);
        (!nodes.is_empty()).then(|| Moved::Nodes(nodes.into_iter().map(start).collect()))
    }

    /// The direction along which a chart counts; `None` for magnitudes, or if it has none.
    pub(crate) fn along(&self, of: &PlotOf) -> Option<DVec3> {
        if let Some(typed) = &of.along {
            let [x, y, z] = std::array::from_fn(|axis| typed.0.get(axis).copied().unwrap_or_default());
            return DVec3::new(x, y, z).try_normalize();
        }
        let name = of.against.as_ref()?;
        let grips = self.runs.iter().flat_map(|run| run.grip_names.iter().zip(&run.grips));
        let obstacles = self.obstacle_names.iter().zip(&self.obstacles);
        let mut motions =
            obstacles.map(|(name, one)| (name, &one.motion)).chain(grips.map(|(name, one)| (name, &one.motion)));
        farthest(motions.find(|(other, _)| *other == name)?.1).try_normalize()
    }

    /// The mean displacement of the nodes of a probe in a body of a run, or in all, with nodes at positions (m), then the mean, the least and the
    /// greatest of their distances from where they are placed (m); NaN without nodes.
    pub(crate) fn displaced(&self, run: &Run, probe: &Probe, on: Option<usize>, position: &[DVec3]) -> [f64; 6] {
        let bodies = on.map_or(0..run.of.len(), |on| on..on + 1);
        let ways = bodies.flat_map(|at| probe.in_body(run, at)).map(|node| position[node] - run.placed()[node]);
        let ways: Vec<DVec3> = ways.collect();
        let mean = ways.iter().sum::<DVec3>() / ways.len() as f64;
        let lengths = || ways.iter().map(|way| way.length());
        let [least, most] = [lengths().reduce(f64::min), lengths().reduce(f64::max)].map(|end| end.unwrap_or(f64::NAN));
        [mean.x, mean.y, mean.z, lengths().sum::<f64>() / ways.len() as f64, least, most]
    }

    /// Magnitudes of single things by their names: of forces and torques on all bodies of a run, if they are known, and of displacements
    /// of probes.
    pub(crate) fn magnitudes(&self, run: &Run, forces: &[Reaction], displaced: &[[f64; 6]]) -> Vec<(String, f64)> {
        let of_probe = |(probe, displaced): (&Probe, &[f64; 6])| {
            let sizes = SIZES.into_iter().zip(&displaced[3..]);
            sizes.map(|(key, &size)| (format!("displacement of {}_{key}", probe.name), size)).collect::<Vec<_>>()
        };
        let forces = (!forces.is_empty()).then(|| Forces::new(self, Some(run), forces));
        let of_sources = forces.iter().flat_map(|forces| forces.on(None)).flat_map(|(name, sums)| named(name, sums));
        of_sources.chain(self.probes.iter().zip(displaced).flat_map(of_probe)).collect()
    }

    /// The magnitudes of force and torque between each two bodies of a run that touch, with their names.
    pub(crate) fn between(&self, run: &Run, forces: &[Reaction]) -> Vec<(String, f64)> {
        let name = |body: usize| &self.bodies[run.of[body]].name;
        let of_pair = |one: &Reaction| {
            let Source::Body(from) = one.from else { return None };
            // That on the other body is the opposite.
            let is_first = from < one.on && one.force != DVec3::ZERO;
            is_first.then(|| named(&format!("{} on {}", name(from), name(one.on)), [one.force, one.torque]))
        };
        forces.iter().filter_map(of_pair).flatten().collect()
    }

    /// The displacements of all probes, in all bodies of a run together and, if there are several, in each.
    pub(crate) fn all_displaced(&self, run: &Run, position: &[DVec3]) -> Vec<[f64; 6]> {
        if position.is_empty() {
            return Vec::new();
        }
        let bodies = if run.of.len() > 1 { run.of.len() } else { 0 };
        let parts = std::iter::once(None).chain((0..bodies).map(Some));
        parts.flat_map(|on| self.probes.iter().map(move |probe| self.displaced(run, probe, on, position))).collect()
    }
}

impl Probe {
    /// Its nodes in a body of a run, counted over all bodies.
    fn in_body<'a>(&'a self, run: &'a Run, at: usize) -> impl Iterator<Item = usize> + 'a {
        let first = run.bodies.nodes(at).start;
        self.nodes.get(run.of[at]).into_iter().flatten().map(move |&node| first + node as usize)
    }
}

/// The magnitudes of the force and the torque of a thing.
fn named(thing: &str, sums: [DVec3; 2]) -> [(String, f64); 2] {
    let [force, torque] = sums.map(DVec3::length);
    [(format!("force of {thing}"), force), (format!("torque of {thing}"), torque)]
}

/// The way from the start of a motion to the farthest point of it (m); zero if it does not move, or along a path of the caller's own.
fn farthest(motion: &Motion) -> DVec3 {
    match motion {
        Motion::Still | Motion::Along(_) => DVec3::ZERO,
        Motion::Keys { keys, .. } => {
            let ways = keys.iter().map(|key| key.offset.shift - keys[0].offset.shift);
            // The first of equals.
            ways.fold(DVec3::ZERO, |far, way| if way.length() > far.length() { way } else { far })
        }
        Motion::Swing { amplitude, .. } => amplitude.shift,
    }
}
