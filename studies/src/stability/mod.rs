//! Outcomes of a scene's runs for stiffnesses over decades and steps up to beyond the predicted limit: a map for each run.
//!
//! The stiffness of a run is multiplied, and its damping so that the damping ratio stays. Then the predicted limit is
//! proportional to `1/√k`, and a row of the map is the same share of it for every stiffness. Faster impacts have
//! multiplied initial velocities, and gravity multiplied by the square. Outcomes have the same bits on every machine;
//! the cells of a map are simulated in parallel.

mod page;
mod text;

use crate::study::{Findings, Study, Watch, built_in, each};
use localshape::Scene;
use localshape::scene::{Run, description};
use localshape::sim::model::{ElasticModel, ModelParameters};
use localshape::sim::stability::{Restraint, Stability as Limit};
use localshape::sim::{Diagnostic, Status};
use std::sync::Arc;
use text::short;

/// The study.
#[derive(Clone, Debug)]
pub(crate) struct Stability {
    pub(crate) scene: Scene,
    /// Factors of the stiffness of all runs.
    stiffnesses: Vec<f64>,
    /// Steps, as shares of the predicted limit.
    shares: Vec<f64>,
    /// Factors of the speed of impacts.
    speeds: Vec<f64>,
    /// Factors of the damping ratio.
    dampings: Vec<f64>,
}

impl Study for Stability {
    /// The number of cells of all maps.
    fn work(&self) -> u64 {
        let runs = self.scene.runs.iter().filter(|run| run.tolerance.is_none()).count();
        (runs * self.stiffnesses.len() * self.shares.len() * self.speeds.len() * self.dampings.len()) as u64
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self, watch)?;
        let (text, tables) = (results.text(), vec![("stability", results.table())]);
        Some(Findings { text, tables, page: Some(results.page()) })
    }
}

impl Stability {
    /// A grid that takes a few minutes for the built-in scene.
    pub(crate) fn usual(scene: Scene) -> Self {
        Self::new(scene, 4, 12, vec![1.0], vec![1.0])
    }

    /// A finer grid, slower and faster impacts, no damping and more.
    pub(crate) fn full(scene: Scene) -> Self {
        Self::new(scene, 8, 24, vec![0.5, 1.0, 2.0], vec![0.0, 1.0, 3.0])
    }

    /// `columns` in each decade of stiffness, from a tenth to a hundred times that of the scene, and `rows` up to 1.2 times the limit,
    /// which lies between two of them.
    fn new(scene: Scene, columns: u32, rows: u32, speeds: Vec<f64>, dampings: Vec<f64>) -> Self {
        let decades = |at: u32| f64::from(at) / f64::from(columns) - 1.0;
        Self {
            scene,
            stiffnesses: (0..=3 * columns).map(|at| libm::exp10(decades(at))).collect(),
            shares: (0..rows).map(|at| 1.2 * (f64::from(at) + 0.5) / f64::from(rows)).collect(),
            speeds,
            dampings,
        }
    }
}

/// The default scene: the fall of Fig. 4(b), with the models of the paper and three integrators, or with these models and the default
/// integrator.
pub(crate) fn usual(models: &[String]) -> Scene {
    let model = |kind: &str| format!("model = {{ kind = '{kind}, stiffness = 1e4, damping_ratio = 0.1 }}");
    let (shape, springs) = (model("shape-based'"), model("mass-spring', springs = 'edges+one-diagonal'"));
    let of_paper = ["semi-implicit-euler", "velocity-verlet", "runge-kutta"].into_iter().flat_map(|integrator| {
        let run = |name: &str, model: &str| {
            format!("{{ name = '{name}, {integrator}', integrator = '{integrator}', {model} }}")
        };
        [run("Local shape", &shape), run("Mass-spring", &springs)]
    });
    let of_models = models.iter().map(|kind| {
        format!("{{ name = '{kind}', model = {} }}", crate::models::Alike::constant(1e4, 0.05).typed(kind, 0.1))
    });
    let runs: Vec<_> = if models.is_empty() { of_paper.collect() } else { of_models.collect() };
    let text = format!(
        "title = '3×3×3 cubes that hit a floor after a fall of 5 m'
        gravity = [0, -9.8, 0]
        time.duration = 2
        body = {{ lattice = {{ cells = [3, 3, 3], side = 0.1 }}, velocity = [0, -9.899495, 0], lowest = 0, \
            rotation = {{ axis = [1, 0, 1], angle = 0.028284 }} }}
        obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3, friction_of = 'velocity' }}]
        run = [{}]",
        runs.join(",\n")
    );
    built_in(&text, "fall")
}

/// A run with one stiffness and one step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MapCell {
    /// The number of the run.
    pub(crate) run: usize,
    /// The stiffness over the mass of the lightest node (1/s²).
    pub(crate) rate: f64,
    /// The factors of the speed of impacts and of the damping ratio.
    pub(crate) speed: f64,
    pub(crate) damping: f64,
    /// The step as a share of the predicted limit, or of [`Axes::unit`] if there is none.
    pub(crate) share: f64,
    /// Time step (s).
    pub(crate) step: f64,
    /// The number of elements that are turned over at the end; `None` if it diverged.
    pub(crate) turned_over: Option<usize>,
}

/// The common values of the cells of a run with one damping ratio.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axes {
    pub(crate) run: usize,
    pub(crate) damping: f64,
    /// `k/m` of the scene (1/s²).
    pub(crate) rate: f64,
    /// The predicted limit for this `k/m` (s), or a π-th of the cycle T for integrators without a limit: the limit of
    /// semi-implicit Euler for a single element.
    pub(crate) unit: f64,
    /// The predicted limit, if there is one, as a share of T.
    pub(crate) limit: Option<f64>,
    /// The limit for arbitrarily stretched springs, as a share of the other one.
    pub(crate) stretched: Option<f64>,
}

impl Axes {
    fn new(scene: &Scene, run: usize, damping: f64) -> Option<Self> {
        let mut scene = scene.clone();
        let model = scaled(&scene.runs[run], 1.0, damping)?;
        scene.runs[run].models[0] = model;
        let one = &scene.runs[run];
        let (model, body) = (one.models[0].as_ref(), one.body());
        let properties = model.properties(body);
        let cycle = properties.shortest_period(body);
        let restraint = Restraint { grips: &one.grips, duration: scene.duration, mass_damping: scene.mass_damping };
        let predicted = Limit::of(body, model, one.integrator, restraint);
        let limit = (predicted.largest > 0.0 && predicted.largest.is_finite()).then_some(predicted.largest);
        Some(Self {
            run,
            damping,
            rate: properties.stiffness / body.lightest(),
            unit: limit.unwrap_or(cycle * std::f64::consts::FRAC_1_PI),
            limit: limit.map(|limit| limit / cycle),
            stretched: limit.and_then(|limit| Some(predicted.stretched? / limit)),
        })
    }
}

/// The findings.
#[derive(Clone, Debug)]
pub(crate) struct Results {
    study: Stability,
    pub(crate) axes: Vec<Axes>,
    /// In the order of the axes, speeds, stiffnesses and shares.
    pub(crate) cells: Vec<MapCell>,
}

/// Simulates the cells with the rayon thread pool of the caller; `None` if `watch` stops it.
pub(crate) fn measure(study: &Stability, watch: &Watch<'_>) -> Option<Results> {
    let Stability { scene, stiffnesses, shares, speeds, dampings } = study;
    let studied = (0..scene.runs.len()).filter(|&run| scene.runs[run].tolerance.is_none());
    let of_run = |run: usize| dampings.iter().filter_map(move |&damping| Axes::new(scene, run, damping));
    let axes: Vec<Axes> = studied.flat_map(of_run).collect();
    let columns = axes.iter().flat_map(|axes| speeds.iter().map(move |&speed| (axes, speed)));
    let columns = columns.flat_map(|(axes, speed)| stiffnesses.iter().map(move |&stiffness| (axes, speed, stiffness)));
    let cell = |(axes, speed, stiffness): (&Axes, f64, f64), share: f64| MapCell {
        run: axes.run,
        rate: axes.rate * stiffness,
        speed,
        damping: axes.damping,
        share,
        step: share * axes.unit / stiffness.sqrt(),
        turned_over: None,
    };
    let mut cells: Vec<_> = columns.flat_map(|column| shares.iter().map(move |&share| cell(column, share))).collect();
    let found = each(&cells, watch, |cell| turned_over(scene, cell, watch))?;
    for (cell, found) in cells.iter_mut().zip(found) {
        cell.turned_over = found?;
    }
    Some(Results { study: study.clone(), axes, cells })
}

/// The model of a run with its stiffness and its damping multiplied; `None` for a model of another program.
fn scaled(run: &Run, stiffness: f64, damping: f64) -> Option<Arc<dyn ElasticModel>> {
    let (model, body) = (&run.models[0], run.body());
    let parameters = ModelParameters::of(&model.properties(body).scaled(stiffness, damping))?;
    let springs = Some(model.springs()).filter(|springs| !springs.is_empty());
    parameters.resolve(body, springs).ok()
}

/// Simulates a cell, until it diverges, and tells how many elements are then turned over; the outer `None` if `watch` stops it.
fn turned_over(scene: &Scene, cell: &MapCell, watch: &Watch<'_>) -> Option<Option<usize>> {
    /// Steps between two checks.
    const STRETCH: u64 = 4096;
    let mut scene = scene.clone();
    scene.gravity *= cell.speed * cell.speed;
    let run = &mut scene.runs[cell.run];
    run.initial.velocity.iter_mut().for_each(|velocity| *velocity *= cell.speed);
    let stiffness = cell.rate * run.body().lightest() / run.models[0].properties(run.body()).stiffness;
    run.models[0] = scaled(run, stiffness, stiffness.sqrt() * cell.damping).expect("axes are of models that can be");
    run.step = cell.step;
    let mut world = scene.world(cell.run);
    let mut left = (scene.duration / cell.step).ceil() as u64;
    while left > 0 && world.status() == Status::Ok {
        world.advance(left.min(STRETCH));
        left = left.saturating_sub(STRETCH);
        if !watch(0) {
            return None;
        }
    }
    let count = || world.some_diagnostics(&[Diagnostic::TurnedOver]).turned_over;
    Some((world.status() == Status::Ok).then(count))
}

impl Results {
    /// The cells of axes with one speed of impacts, column by column.
    pub(crate) fn of<'a>(&'a self, axes: &'a Axes, speed: f64) -> impl Iterator<Item = &'a MapCell> {
        let is_of = move |cell: &&MapCell| cell.run == axes.run && cell.damping == axes.damping && cell.speed == speed;
        self.cells.iter().filter(is_of)
    }

    /// The axes with the speeds of their maps.
    pub(crate) fn maps(&self) -> impl Iterator<Item = (&Axes, f64)> {
        self.axes.iter().flat_map(|axes| self.study.speeds.iter().map(move |&speed| (axes, speed)))
    }

    /// The name of a map, its impacts and damping if the study has several, and the model.
    pub(crate) fn words(&self, axes: &Axes, speed: f64) -> [String; 3] {
        let run = &self.study.scene.runs[axes.run];
        let Stability { speeds, dampings, .. } = &self.study;
        let speed = (speeds.len() > 1).then(|| format!("impacts {} × as fast", short(speed)));
        let damping = (dampings.len() > 1).then(|| format!("{} × the damping", short(axes.damping)));
        let conditions: Vec<_> = speed.into_iter().chain(damping).collect();
        [run.name.clone(), conditions.join(", "), description(run.models[0].as_ref(), run.body())]
    }

    /// The largest share up to which every step, with every stiffness, has a good number of elements that are turned over; 0 for none.
    fn up_to(&self, axes: &Axes, speed: f64, is_good: impl Fn(Option<usize>) -> bool) -> f64 {
        let bad = self.of(axes, speed).filter(|cell| !is_good(cell.turned_over)).map(|cell| cell.share);
        let least = bad.fold(f64::INFINITY, f64::min);
        self.study.shares.iter().copied().filter(|&share| share < least).fold(0.0, f64::max)
    }
}

#[cfg(test)]
#[path = "../../tests/inside/stability.rs"]
mod tests;
