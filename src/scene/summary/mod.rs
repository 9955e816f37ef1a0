//! The contents of a scene in words and numbers, as `check` prints them.

mod words;

use super::{AtRest, Rest, Run, Scene, SceneBody};
use crate::reading::captions::{self, description, typed};
use crate::reading::words::count;
use crate::sim::geometry::bounds;
use crate::sim::stability::Stability;
use crate::sim::{Dimension, Kernel};
use glam::DVec3;
use serde::Serialize;

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
    /// Damping in proportion to masses (1/s).
    pub mass_damping: f64,
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
    /// The loads on each body in a few words.
    pub loads: Vec<String>,
    /// The nodes of each probe in a few words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<String>,
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
    /// The way (m) by which it was moved apart from what it overlapped. Absent if it was not moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub separated: Option<Vec<f64>>,
    /// Its mass (kg).
    pub mass: f64,
    /// Number of triangles of the fine surface that it carries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub carried: Option<usize>,
    /// Each region with a material of its own in a few words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<String>,
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
    /// How near to rest it starts. Absent if it does not start at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest: Option<Rest>,
    /// When it comes to rest. Absent if the scene does not end then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub comes_to_rest: Option<AtRest>,
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
    fn new(of: &SceneBody) -> Self {
        let SceneBody { name, body, initial, separated, .. } = of;
        let (low, high) = bounds(body.rest());
        let of_kind = |(number, name): (usize, &str)| format!("{} {name}", count(number as u128));
        Self {
            name: name.clone(),
            nodes: body.len(),
            element_count: body.elements().len(),
            elements: captions::elements(body).into_iter().map(of_kind).collect(),
            extent: coordinates(high - low, body.dimension()),
            start: corners(&initial.position, body.dimension()),
            separated: (*separated != DVec3::ZERO).then(|| coordinates(*separated, body.dimension())),
            mass: body.mass().iter().sum(),
            carried: body.carried().map(|carried| carried.triangles.len()),
            regions: of.regions.iter().map(|region| words::region(region, body.dimension())).collect(),
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
                rest: run.rest,
                comes_to_rest: run.comes_to_rest,
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
            mass_damping: self.mass_damping,
            duration: self.duration,
            frames: last.saturating_add(1),
            frames_per_second: self.frames_per_second,
            cycle: self.cycle(),
            runs: self.runs.iter().enumerate().map(run).collect(),
            obstacles: self.obstacles.iter().map(|one| words::describe(one, self.dimension())).collect(),
            holds: self.constraints(true),
            grabs: self.constraints(false),
            loads: self.loads_in_words(),
            probes: self.probes_in_words(),
            picture: self.picture(),
        }
    }

    /// The cycle T = 2π√(m/k) of the lightest node and the stiffest run (s), infinite if all runs are recorded. Steps may be
    /// fractions of it.
    pub fn cycle(&self) -> f64 {
        self.runs.iter().map(Run::shortest_period).fold(f64::INFINITY, f64::min)
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
    let clean = |at: f64| if at.abs() <= round_off { 0.0 } else { at };
    [low, high].map(|corner| coordinates(corner, dimension).into_iter().map(clean).collect())
}
