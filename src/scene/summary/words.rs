//! The contents of a scene in words.

use super::{BodySummary, PartSummary, RunSummary, SceneSummary, coordinates};
use crate::reading::captions::{quantity, typed};
use crate::reading::words::{count, ends, list, several, short};
use crate::scene::{AtRest, Probe, Region, Rest, Run, Scene, SceneBody};
use crate::sim::{Course, Dimension, FrictionOf, Kernel, Load, Loading, Motion, Obstacle, Pull, Shape, Turning};
use glam::DVec3;
use std::fmt;
use std::ops::Range;

impl Scene {
    /// The nodes of each body that are held or dragged, and when.
    pub(super) fn constraints(&self, held: bool) -> Vec<String> {
        self.of_each_body(|run, own, body| {
            let wanted = run.grips.iter().filter(|grip| (grip.motion == Motion::Still) == held);
            let words = wanted.filter_map(|grip| {
                let nodes = own_nodes(&grip.nodes, own);
                let span = span(grip.from, grip.until, self.duration);
                (!nodes.is_empty()).then(|| format!("{} {span}", nodes_in_words(&nodes, body)))
            });
            words.collect()
        })
    }

    /// The loads on each body, and when.
    pub(super) fn loads_in_words(&self) -> Vec<String> {
        self.of_each_body(|run, own, body| {
            let words = run.loads.iter().filter_map(|load| {
                let nodes = own_nodes(load.nodes().unwrap_or_default(), own);
                let Course { during, keys, .. } = load.course();
                let span = span(during.start, during.end, self.duration);
                let rise = match keys[..] {
                    [] => String::new(),
                    [[_, first], [end, last]] if first == 0.0 && last == 1.0 && end > during.end => {
                        ", never whole".to_owned()
                    }
                    [[_, first], [end, last]] if first == 0.0 && last == 1.0 => {
                        format!(", whole from {} s on", short(end))
                    }
                    _ => format!(", with shares at {} times", keys.len()),
                };
                let words = || format!("{} {span}{rise}", describe_load(load, &nodes, body, self.dimension()));
                (!nodes.is_empty()).then(words)
            });
            words.collect()
        })
    }

    /// The nodes of each probe.
    pub(super) fn probes_in_words(&self) -> Vec<String> {
        let one = |probe: &Probe| {
            let nodes = probe.nodes.iter().map(Vec::len).sum::<usize>();
            format!("{}: {}", probe.name, several(nodes as u64, "node"))
        };
        self.probes.iter().map(one).collect()
    }

    /// What is said of each body of the first simulated run that has it: constraints and loads are the same in all runs.
    fn of_each_body(&self, say: impl Fn(&Run, &Range<usize>, &str) -> Vec<String>) -> Vec<String> {
        let of_body = |(at, body): (usize, &SceneBody)| {
            let place = |run: &'_ Run| run.of.iter().position(|&other| other == at);
            let mut simulated = self.runs.iter().filter(|run| run.recording.is_none());
            let (run, place) = simulated.find_map(|run| Some((run, place(run)?)))?;
            Some(say(run, &run.bodies.nodes(place), &body.name))
        };
        self.bodies.iter().enumerate().filter_map(of_body).flatten().collect()
    }

    /// The picture in a few words.
    pub(super) fn picture(&self) -> String {
        let view = &self.view;
        let [width, height] = view.size;
        let panels = match (self.runs.len(), view.columns) {
            (1, _) => "one panel".to_owned(),
            (runs, None) => format!("{runs} panels"),
            (runs, Some(columns)) if columns >= runs => format!("{runs} panels in a row"),
            (runs, Some(columns)) => format!("{runs} panels, {columns} in a row"),
        };
        let from = match self.dimension() {
            Dimension::Plane => "from the front".to_owned(),
            Dimension::Space => {
                let [across, up] = [view.camera.azimuth, view.camera.elevation].map(|angle| angle.to_degrees().round());
                let side = if across < 0.0 { "left" } else { "right" };
                let height = if up < 0.0 { "down" } else { "up" };
                let turned = if view.camera.turns { " or from where obstacles hide less" } else { "" };
                format!("from {}° {side} and {}° {height}{turned}", across.abs(), up.abs())
            }
        };
        let theme = typed(&view.look.theme);
        let distance = match view.camera.follow {
            true => ", following the body".to_owned(),
            false => format!(", {} m away", short(view.camera.distance)),
        };
        format!("{width} × {height} px, {theme}, {panels}, seen {from}{distance}")
    }
}

impl RunSummary {
    /// The energy that rebounds add to a run, in words; `None` if it is little.
    fn rebounds(&self) -> Option<String> {
        const LITTLE: f64 = 1e-4;
        let gain = self.rebound_gain.filter(|&gain| gain > LITTLE)?;
        let step = self.step * (LITTLE / gain).sqrt();
        let percent = |share: f64| short((1e4 * share).round() / 100.0);
        Some(format!(
            "undamped, e = 1: each rebound adds about {} % to the energy; {} % with a step of {} s",
            percent(gain),
            percent(LITTLE),
            short(step)
        ))
    }

    /// The largest stable step of a run in words, and the run's share of it.
    fn stability(&self) -> String {
        let part =
            |limit: f64| format!("{} s ({} % used)", short(limit), short((1000.0 * self.step / limit).round() / 10.0));
        match self.largest_step {
            None => "stable with any step".to_owned(),
            Some(0.0) => format!("no step is stable: {} needs damping", self.integrator),
            Some(largest) => {
                let stretched =
                    self.largest_stretched_step.map(|limit| format!(", {} with stretched springs", part(limit)));
                let of = self.limited_by.as_ref().map_or_else(String::new, |body| format!(" of {body}"));
                format!("largest stable step {}{of}{}", part(largest), stretched.unwrap_or_default())
            }
        }
    }
}

/// An obstacle in words.
pub(super) fn describe(obstacle: &Obstacle, dimension: Dimension) -> String {
    let vector = |point: DVec3| vector(&coordinates(point, dimension));
    let shape = match obstacle.shape {
        Shape::Floor { normal, height } => format!("floor at {} m along {}", short(height), vector(normal)),
        Shape::Plate { point, normal } => format!("plate at {} m, facing {}", vector(point), vector(normal)),
        Shape::Sphere { centre, radius } => format!("sphere at {} m, radius {} m", vector(centre), short(radius)),
        Shape::Capsule { from, to, radius } => {
            format!("capsule from {} to {} m, radius {} m", vector(from), vector(to), short(radius))
        }
        Shape::Box { centre, half, .. } => format!("box at {} m, sides {} m", vector(centre), vector(2.0 * half)),
    };
    let (e, friction) = (short(obstacle.restitution), short(obstacle.friction));
    let of = match obstacle.friction_of {
        FrictionOf::Path => String::new(),
        FrictionOf::Velocity => " on velocities only".to_owned(),
    };
    format!("{shape}, e = {e}, μ = {friction}{of}{}", path(&obstacle.motion))
}

/// The words for the motion of an obstacle.
fn path(motion: &Motion) -> String {
    match motion {
        Motion::Still => String::new(),
        Motion::Keys { keys, repeat, .. } => {
            let last = keys.last().map_or(0.0, |key| key.time);
            let again = if *repeat { ", repeating" } else { "" };
            format!(", moving along {} keys until {} s{again}", keys.len(), short(last))
        }
        Motion::Swing { period, .. } => format!(", swinging once in {} s", short(*period)),
        Motion::Along(_) => ", moving".to_owned(),
    }
}

/// The nodes of a body among some nodes of a run, counted from its first.
fn own_nodes(nodes: &[u32], own: &Range<usize>) -> Vec<usize> {
    let nodes = nodes.iter().map(|&node| node as usize).filter(|node| own.contains(node));
    nodes.map(|node| node - own.start).collect()
}

/// Some nodes of a body in words.
fn nodes_in_words(nodes: &[usize], body: &str) -> String {
    let nodes = match nodes {
        [only] => format!("node {only}"),
        several => format!("{} nodes", count(several.len() as u128)),
    };
    let of = if body.is_empty() { String::new() } else { format!(" of {body}") };
    nodes + &of
}

/// A span of time in words.
fn span(from: f64, until: f64, duration: f64) -> String {
    let end = if until.is_finite() { format!("until {} s", short(until)) } else { "on".into() };
    let note = if from >= duration && duration > 0.0 { " (after the end of the scene)" } else { "" };
    format!("from {} s {end}{note}", short(from))
}

/// A load on nodes of a body in words, at its full share.
fn describe_load(load: &Loading, nodes: &[usize], body: &str, dimension: Dimension) -> String {
    let nodes = nodes_in_words(nodes, body);
    let areas = if dimension == Dimension::Plane { ("side", "N/m") } else { ("face", "Pa") };
    match load.pull() {
        Pull::Dead(forces) => {
            let sum = vector(&coordinates(forces.iter().sum(), dimension));
            format!("force {sum} N on {nodes}")
        }
        Pull::Torque(torque, _) if dimension == Dimension::Plane => {
            format!("torque {} N m on {nodes}", short(torque.z))
        }
        Pull::Torque(torque, _) => format!("torque {} N m on {nodes}", vector(&coordinates(*torque, dimension))),
        Pull::Centrifugal(Turning { rate, about, .. }) => {
            let about = vector(&coordinates(*about, dimension));
            format!("centrifugal at {} rad/s about {about} m on {nodes}", short(rate.length()))
        }
        Pull::Pressure(pressure, faces) => {
            let (faces, (side, unit)) = (faces.len() as u64, areas);
            format!("pressure {} {unit} on {} with {nodes}", short(*pressure), several(faces, side))
        }
        Pull::CarriedPressure(pressure, triangles, _) => {
            let triangles = several(triangles.len() as u64, "triangle");
            format!("pressure {} Pa on {triangles} that {nodes} carry", short(*pressure))
        }
    }
}

/// A region of a body in words.
pub(super) fn region(Region { name, elements, modulus, density }: &Region, dimension: Dimension) -> String {
    let unit = if dimension == Dimension::Plane { "kg/m²" } else { "kg/m³" };
    let modulus = modulus.map_or_else(String::new, |modulus| format!(", stiffness × {}", short(modulus)));
    let density = density.map_or_else(String::new, |density| format!(", {} {unit}", short(density)));
    format!("{name}: {}{modulus}{density}", several(elements.len() as u64, "element"))
}

/// A name before the words about it; nothing without a name.
fn titled(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!("{name}: ") }
}

fn vector(coordinates: &[f64]) -> String {
    let numbers: Vec<_> = coordinates.iter().map(|&number| short(number)).collect();
    format!("({})", numbers.join(", "))
}

impl BodySummary {
    /// Writes lines, each with a name.
    fn write(&self, line: &mut impl FnMut(&str, &str) -> fmt::Result) -> fmt::Result {
        let extent: Vec<_> = self.extent.iter().map(|&side| short(side)).collect();
        let (extent, nodes) = (extent.join(" × "), count(self.nodes as u128));
        let kinds = list(&self.elements, "and", |words| words.into());
        let elements = match self.elements.len() {
            1 => kinds,
            _ => format!("{} elements ({kinds})", count(self.element_count as u128)),
        };
        let name = titled(&self.name);
        let carried = self.carried.map(|triangles| format!(", carrying {} triangles", count(triangles as u128)));
        let (mass, carried) = (short(self.mass), carried.unwrap_or_default());
        line("body", &format!("{name}{nodes} nodes, {elements}, {extent} m, {mass} kg{carried}"))?;
        let [low, high] = &self.start;
        // Users copy regions of nodes from it, so it holds all nodes.
        let ranges: Vec<_> = low.iter().zip(high).map(|(&low, &high)| ends([low, high])).collect();
        let corner = |at: usize| ranges.iter().map(|range| &*range[at]).collect::<Vec<_>>().join(", ");
        line("start", &format!("between ({}) and ({}) m", corner(0), corner(1)))?;
        if let Some(way) = &self.separated {
            line("", &format!("moved by {} m, apart from what it overlapped", vector(way)))?;
        }
        self.regions.iter().try_for_each(|region| line("region", region))
    }
}

impl RunSummary {
    /// Writes lines, each with a name, of a run of this scene.
    fn write(&self, scene: &SceneSummary, line: &mut impl FnMut(&str, &str) -> fmt::Result) -> fmt::Result {
        match (&scene.bodies[..], &self.parts[..]) {
            ([_], [PartSummary { model, .. }]) => line("run", &format!("{}: {model}", self.name))?,
            _ => {
                line("run", &self.name)?;
                let part = |part: &PartSummary| line("", &format!("{}{}", titled(&part.body), part.model));
                self.parts.iter().try_for_each(part)?;
            }
        }
        if self.recorded {
            return Ok(());
        }
        let (step, part) = (short(self.step), short(scene.cycle / self.step));
        let steps = several(self.steps, "step");
        let kernel = if self.kernel == Kernel::Reference { ", kernel reference" } else { "" };
        let stepping = match self.tolerance {
            Some(tolerance) => format!("tolerance {tolerance:e}"),
            None => format!("ΔT = {step} s = T/{part}, {steps}"),
        };
        line("", &format!("{stepping}, {}{kernel}", self.integrator))?;
        if let Some(Rest { residual, evaluations }) = self.rest {
            let evaluations = several(evaluations, "evaluation");
            line("", &format!("starts at rest: {residual:.0e} of the load is left after {evaluations}"))?;
        }
        if let Some(AtRest { frame, kinetic_energy, residual }) = self.comes_to_rest {
            let time = short(frame as f64 / scene.frames_per_second);
            let energy = quantity(kinetic_energy, "J");
            line("", &format!("at rest from {time} s on: {energy} of motion and {residual:.0e} of the load are left"))?;
        }
        if self.tolerance.is_none() {
            line("", &self.stability())?;
            self.rebounds().iter().try_for_each(|text| line("", text))?;
        }
        Ok(())
    }
}

impl fmt::Display for SceneSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, text: &str| writeln!(f, "  {name:<9} {text}");
        line("scene", &format!("{} ({})", self.title, self.name))?;
        self.bodies.iter().try_for_each(|body| body.write(&mut line))?;
        line("gravity", &format!("{} m/s²", vector(&self.gravity)))?;
        if self.mass_damping > 0.0 {
            line("damping", &format!("of masses, α = {}/s", short(self.mass_damping)))?;
        }
        let (duration, rate) = (short(self.duration), short(self.frames_per_second));
        line("time", &format!("{duration} s, {} at {rate} per second", several(self.frames, "frame")))?;
        if self.cycle.is_finite() {
            line("cycle", &format!("T = {} s", short(self.cycle)))?;
        }
        self.runs.iter().try_for_each(|run| run.write(self, &mut line))?;
        for obstacle in &self.obstacles {
            line("obstacle", obstacle)?;
        }
        for (name, constraints) in
            [("hold", &self.holds), ("grab", &self.grabs), ("load", &self.loads), ("probe", &self.probes)]
        {
            constraints.iter().try_for_each(|constraint| line(name, constraint))?;
        }
        line("picture", &self.picture)?;
        write!(f, "  {:<9} {}", "digest", self.digest)
    }
}
