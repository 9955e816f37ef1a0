//! The contents of a scene in words and numbers, as `check` prints them.

use super::{Run, Scene, SceneBody, stability};
use crate::reading::captions::{self, description, typed};
use crate::reading::words::{count, ends, list, several, short};
use crate::sim::geometry::bounds;
use crate::sim::stability::Stability;
use crate::sim::{Dimension, FrictionOf, Grip, Kernel, Motion, Obstacle, Shape};
use glam::DVec3;
use serde::Serialize;
use std::fmt;

/// The contents of a scene. It prints as a short table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneSummary {
    /// The scene's title.
    pub title: String,
    /// The scene's name.
    pub name: String,
    /// The digest of the scene's meaning.
    pub digest: String,
    /// The bodies in order.
    pub bodies: Vec<BodySummary>,
    /// Acceleration of gravity (m/s²): three coordinates in space, two in the plane.
    pub gravity: Vec<f64>,
    /// Simulated time (s).
    pub duration: f64,
    /// Number of frames, the first and the last included.
    pub frames: u64,
    /// Frames per second of simulated time (1/s).
    pub frames_per_second: f64,
    /// The cycle T = 2π√(m/k) of the lightest node and the stiffest run (s).
    pub cycle: f64,
    /// The runs in order.
    pub runs: Vec<RunSummary>,
    /// Each obstacle in a few words.
    pub obstacles: Vec<String>,
    /// The nodes of each body that each `[[hold]]` holds, in a few words.
    pub holds: Vec<String>,
    /// The nodes of each body that each `[[grab]]` drags, in a few words.
    pub grabs: Vec<String>,
    /// The picture in a few words.
    pub picture: String,
}

/// One body of a [`SceneSummary`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodySummary {
    /// The name; empty if it has none.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of elements.
    pub element_count: usize,
    /// Number of elements of each kind, such as `27 cubes`.
    pub elements: Vec<String>,
    /// Sides of the box around the body at rest (m): three in space, two in the plane.
    pub extent: Vec<f64>,
    /// Lowest and highest corner of the box around the body as it starts (m).
    pub start: [Vec<f64>; 2],
    /// Its mass (kg).
    pub mass: f64,
    /// Number of triangles of the fine surface that it carries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub carried: Option<usize>,
}

/// One run of a [`SceneSummary`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunSummary {
    /// The name.
    pub name: String,
    /// Its bodies with their models.
    pub parts: Vec<PartSummary>,
    /// Whether its states are recorded: what follows is then about nothing but the moments that it shows.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub recorded: bool,
    /// The integrator, as typed in a scene.
    pub integrator: String,
    /// The code that computes a step.
    pub kernel: Kernel,
    /// Time step (s).
    pub step: f64,
    /// The error allowed in each step of an integrator that chooses its steps, as a share of the body's size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Number of steps up to the last frame.
    pub steps: u64,
    /// The largest stable step (s), at rest; 0 if none is stable. Absent if steps have no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_step: Option<f64>,
    /// The body that limits this step. Absent for a run of one body, or without a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limited_by: Option<String>,
    /// The largest step (s) that is stable however far springs are stretched. Absent for models without springs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_stretched_step: Option<f64>,
    /// The approximate share of energy that each rebound adds. Absent unless the run is undamped and an obstacle has `e
    /// = 1`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rebound_gain: Option<f64>,
}

/// One body of a [`RunSummary`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartSummary {
    /// Its name; empty if it has none.
    pub body: String,
    /// The model with all parameters that change its result.
    pub model: String,
}

impl BodySummary {
    fn new(SceneBody { name, body, initial, .. }: &SceneBody) -> Self {
        let (low, high) = bounds(body.rest());
        let of_kind = |(number, name): (usize, &str)| format!("{} {name}", count(number as u128));
        Self {
            name: name.clone(),
            nodes: body.len(),
            element_count: body.elements().len(),
            elements: captions::elements(body).into_iter().map(of_kind).collect(),
            extent: coordinates(high - low, body.dimension()),
            start: corners(&initial.position, body.dimension()),
            mass: body.mass().iter().sum(),
            carried: body.carried().map(|carried| carried.triangles.len()),
        }
    }
}

impl Scene {
    /// The contents of the scene.
    pub fn summary(&self) -> SceneSummary {
        let coordinates = |vector| coordinates(vector, self.dimension());
        let last = self.last_frame();
        let run = |(at, run): (usize, &Run)| {
            let (Stability { largest, stretched }, limiting) = self.stability(at);
            let part = |(place, &body): (usize, &usize)| {
                let SceneBody { name, body, .. } = &self.bodies[body];
                let model = match &run.recording {
                    Some(recording) => recording.description(),
                    None => description(&*run.models[place], body),
                };
                PartSummary { body: name.clone(), model }
            };
            RunSummary {
                name: run.name.clone(),
                parts: run.of.iter().enumerate().map(part).collect(),
                recorded: run.recording.is_some(),
                integrator: typed(&run.integrator),
                kernel: run.kernel,
                step: run.step,
                tolerance: run.tolerance,
                steps: self.frame_step(at, last),
                largest_step: largest.is_finite().then_some(largest),
                limited_by: limiting.map(str::to_owned),
                largest_stretched_step: stretched.filter(|limit| limit.is_finite()),
                rebound_gain: self.rebound_gain(at, largest),
            }
        };
        SceneSummary {
            title: self.title.clone(),
            name: self.name.clone(),
            digest: self.digest.clone(),
            bodies: self.bodies.iter().map(BodySummary::new).collect(),
            gravity: coordinates(self.gravity),
            duration: self.duration,
            frames: last.saturating_add(1),
            frames_per_second: self.frames_per_second,
            cycle: self.cycle(),
            runs: self.runs.iter().enumerate().map(run).collect(),
            obstacles: self.obstacles.iter().map(|one| describe(one, &coordinates)).collect(),
            holds: self.constraints(true),
            grabs: self.constraints(false),
            picture: self.picture(),
        }
    }

    /// The nodes of each body that are held or dragged, and when. A constraint is the same in all runs of a body.
    fn constraints(&self, held: bool) -> Vec<String> {
        let of_body = |(at, body): (usize, &SceneBody)| {
            let place = |run: &'_ Run| run.of.iter().position(|&other| other == at);
            let mut simulated = self.runs.iter().filter(|run| run.recording.is_none());
            let (run, place) = simulated.find_map(|run| Some((run, place(run)?)))?;
            let own = run.bodies.nodes(place);
            let wanted = run.grips.iter().filter(|grip| (grip.motion == Motion::Still) == held);
            let words = wanted.filter_map(|grip| {
                let nodes = grip.nodes.iter().map(|&node| node as usize).filter(|node| own.contains(node));
                let nodes: Vec<_> = nodes.map(|node| node - own.start).collect();
                (!nodes.is_empty()).then(|| constraint(&nodes, &body.name, grip, self.duration))
            });
            Some(words.collect::<Vec<_>>())
        };
        self.bodies.iter().enumerate().filter_map(of_body).flatten().collect()
    }

    /// The cycle T = 2π√(m/k) of the lightest node and the stiffest run (s), infinite if all runs are recorded. Steps may be
    /// fractions of it.
    pub fn cycle(&self) -> f64 {
        self.runs.iter().map(Run::shortest_period).fold(f64::INFINITY, f64::min)
    }

    fn picture(&self) -> String {
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
                format!("from {}° {side} and {}° {height}", across.abs(), up.abs())
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

/// The coordinates of a vector: three in space, two in the plane.
fn coordinates(vector: DVec3, dimension: Dimension) -> Vec<f64> {
    let axes = if dimension == Dimension::Plane { 2 } else { 3 };
    vector.to_array()[..axes].to_vec()
}

/// Lowest and highest corner of the box around points (m), without round-off beside zero.
pub(super) fn corners(points: &[DVec3], dimension: Dimension) -> [Vec<f64>; 2] {
    let (low, high) = bounds(points);
    let round_off = 1e-12 * low.abs().max(high.abs()).max_element();
    let axes = if dimension == Dimension::Plane { 2 } else { 3 };
    [low, high].map(|corner| {
        let coordinates = corner.to_array().into_iter().take(axes);
        coordinates.map(|at| if at.abs() <= round_off { 0.0 } else { at }).collect()
    })
}

/// An obstacle in words.
fn describe(obstacle: &Obstacle, coordinates: &impl Fn(DVec3) -> Vec<f64>) -> String {
    let vector = |point: DVec3| vector(&coordinates(point));
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

/// A kinematic constraint on nodes of a body in words.
fn constraint(nodes: &[usize], body: &str, grip: &Grip, duration: f64) -> String {
    let nodes = match nodes {
        [only] => format!("node {only}"),
        several => format!("{} nodes", count(several.len() as u128)),
    };
    let of = if body.is_empty() { String::new() } else { format!(" of {body}") };
    let until = if grip.until.is_finite() { format!("until {} s", short(grip.until)) } else { "on".into() };
    let note = if grip.from >= duration && duration > 0.0 { " (after the end of the scene)" } else { "" };
    format!("{nodes}{of} from {} s {until}{note}", short(grip.from))
}

/// A name before what it has; nothing without a name.
fn titled(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!("{name}: ") }
}

fn vector(coordinates: &[f64]) -> String {
    let numbers: Vec<_> = coordinates.iter().map(|&number| short(number)).collect();
    format!("({})", numbers.join(", "))
}

impl fmt::Display for SceneSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, text: &str| writeln!(f, "  {name:<9} {text}");
        line("scene", &format!("{} ({})", self.title, self.name))?;
        for body in &self.bodies {
            let extent: Vec<_> = body.extent.iter().map(|&side| short(side)).collect();
            let (extent, nodes) = (extent.join(" × "), count(body.nodes as u128));
            let kinds = list(&body.elements, "and", |words| words.into());
            let elements = match body.elements.len() {
                1 => kinds,
                _ => format!("{} elements ({kinds})", count(body.element_count as u128)),
            };
            let name = titled(&body.name);
            let carried = body.carried.map(|triangles| format!(", carrying {} triangles", count(triangles as u128)));
            let (mass, carried) = (short(body.mass), carried.unwrap_or_default());
            line("body", &format!("{name}{nodes} nodes, {elements}, {extent} m, {mass} kg{carried}"))?;
            let [low, high] = &body.start;
            // Users copy regions of nodes from it, so it holds all nodes.
            let ranges: Vec<_> = low.iter().zip(high).map(|(&low, &high)| ends([low, high])).collect();
            let corner = |at: usize| ranges.iter().map(|range| &*range[at]).collect::<Vec<_>>().join(", ");
            line("start", &format!("between ({}) and ({}) m", corner(0), corner(1)))?;
        }
        line("gravity", &format!("{} m/s²", vector(&self.gravity)))?;
        let (duration, rate) = (short(self.duration), short(self.frames_per_second));
        line("time", &format!("{duration} s, {} at {rate} per second", several(self.frames, "frame")))?;
        if self.cycle.is_finite() {
            line("cycle", &format!("T = {} s", short(self.cycle)))?;
        }
        for run in &self.runs {
            match (&self.bodies[..], &run.parts[..]) {
                ([_], [PartSummary { model, .. }]) => line("run", &format!("{}: {model}", run.name))?,
                _ => {
                    line("run", &run.name)?;
                    let part = |part: &PartSummary| line("", &format!("{}{}", titled(&part.body), part.model));
                    run.parts.iter().try_for_each(part)?;
                }
            }
            if run.recorded {
                continue;
            }
            let (step, part) = (short(run.step), short(self.cycle / run.step));
            let steps = count(run.steps.into());
            let kernel = if run.kernel == Kernel::Reference { ", kernel reference" } else { "" };
            let stepping = match run.tolerance {
                Some(tolerance) => format!("tolerance {tolerance:e}"),
                None => format!("ΔT = {step} s = T/{part}, {steps} steps"),
            };
            line("", &format!("{stepping}, {}{kernel}", run.integrator))?;
            if run.tolerance.is_none() {
                line("", &stability::in_words(run))?;
                stability::rebounds_in_words(run).iter().try_for_each(|text| line("", text))?;
            }
        }
        for obstacle in &self.obstacles {
            line("obstacle", obstacle)?;
        }
        for (name, constraints) in [("hold", &self.holds), ("grab", &self.grabs)] {
            constraints.iter().try_for_each(|constraint| line(name, constraint))?;
        }
        line("picture", &self.picture)?;
        write!(f, "  {:<9} {}", "digest", self.digest)
    }
}
