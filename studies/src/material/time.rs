//! Error against time: one beam with every model and resolution, the error of its end at rest, and the time of a simulated second.

use super::balance::{hold, rest_of};
use super::bar::Bar;
use super::{Elements, MENDED, MODELS, Model, STEPPING};
use crate::page::{Contents, Page, Plot};
use crate::spread::Spread;
use crate::study::{Findings, Study, Watch};
use crate::table::{Cell, Table, figure, or_dash};
use crate::turns::{kind_of_time, machine, seconds, take_turns};
use glam::DVec3;
use localshape::sim::model::ElasticModel;
use localshape::sim::stability::{Restraint, Stability};
use localshape::sim::{Grip, Integrator, Material, State, Stepping, Surroundings, World};
use std::sync::Arc;

/// The study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Time {
    /// Cells across the bars; they are as wide as deep.
    pub(crate) across: Vec<u32>,
    /// Cells across the two bars from which the reference is extrapolated.
    pub(crate) fine: [u32; 2],
    /// The number of turns of each bar, and elements times steps in a turn.
    pub(crate) rounds: u32,
    pub(crate) turn: u64,
}

/// Depth and width (m), length over depth, density (kg/m³) and material of the beam, and its load as `P L²/EI`.
const DEPTH: f64 = 0.1;
const SLENDERNESS: u32 = 8;
const DENSITY: f64 = 1000.0;
const MATERIAL: Material = Material { young: 1e6, poisson: 0.0 };
const LOAD: f64 = 2.0;
/// The integrator that is timed: the default of scenes.
const INTEGRATOR: Integrator = Integrator::SemiImplicitEuler;
/// The longest step of a model that steps itself, in shortest periods of a node. It is halved until the deflection at rest is as close as
/// this to that in small steps.
const LONGEST: f64 = 0.1;
const CLOSE: f64 = 0.01;
/// The errors for which a model is recommended.
const WANTED: [f64; 4] = [0.3, 0.1, 0.03, 0.01];

impl Time {
    pub(crate) fn usual() -> Self {
        Self { across: vec![1, 2, 3, 4], fine: [6, 8], rounds: 9, turn: 100_000 }
    }

    /// All models.
    fn models() -> impl Iterator<Item = &'static Model> {
        MODELS.iter().chain(&STEPPING)
    }
}

impl Study for Time {
    fn work(&self) -> u64 {
        (Self::models().count() * self.across.len()) as u64 * u64::from(1 + self.rounds) + 2
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self, watch)?;
        let (text, tables) = (results.text(), vec![("beam-time", results.table())]);
        Some(Findings { text, tables, page: Some(results.page()) })
    }
}

/// A model on one bar.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Timed {
    pub(crate) model: Model,
    pub(crate) across: u32,
    pub(crate) elements: usize,
    /// The deflection of the end over the length, and its relative distance from the reference.
    pub(crate) across_length: f64,
    pub(crate) error: f64,
    /// Half of the largest stable step, which `step = "auto"` would take, or that of a model that steps itself (s).
    pub(crate) step: f64,
    /// What [`Cantilever::softer`] has.
    pub(crate) softer: Vec<f64>,
    /// Time of a simulated second (s).
    pub(crate) time: Spread,
}

/// The findings on one machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    study: Time,
    /// The deflection of the end over the length that the material has.
    pub(crate) reference: f64,
    /// Model by model.
    pub(crate) timed: Vec<Timed>,
}

/// Measures with the rayon thread pool of the caller, which has one thread; `None` if `watch` stops it.
pub(crate) fn measure(study: &Time, watch: &Watch<'_>) -> Option<Results> {
    let corotational = MODELS.iter().find(|model| model.name == "corotational")?;
    let fine = study.fine.map(|across| Cantilever::new(corotational, across).filter(|_| watch(1)));
    let [Some(coarse), Some(fine)] = fine else { return None };
    let parts = study.fine.map(|across| f64::from(across * across));
    let reference = (parts[1] * fine.deflection - parts[0] * coarse.deflection) / (parts[1] - parts[0]);
    let mut beams = Vec::new();
    for model in Time::models() {
        for &across in &study.across {
            beams.extend(Cantilever::new(model, across).map(|beam| (*model, across, beam)));
            if !watch(1) {
                return None;
            }
        }
    }
    let mut worlds: Vec<_> = beams.iter().map(|(.., beam)| beam.world()).collect();
    let steps = |beam: &Cantilever| (study.turn / beam.bar.body.elements().len() as u64).max(1);
    // The first access to memory is not timed.
    worlds.iter_mut().for_each(|world| world.advance(1));
    let times = take_turns(worlds.len(), study.rounds, watch, |at| {
        let (.., beam) = &beams[at];
        seconds(|| worlds[at].advance(steps(beam))) / (steps(beam) as f64 * beam.step)
    })?;
    let timed = beams.into_iter().zip(times).map(|((model, across, beam), times)| Timed {
        model,
        across,
        elements: beam.bar.body.elements().len(),
        across_length: beam.deflection,
        error: (beam.deflection / reference - 1.0).abs(),
        step: beam.step,
        softer: beam.softer,
        time: Spread::of(times),
    });
    Some(Results { study: study.clone(), reference, timed: timed.collect() })
}

/// The beam with a model.
struct Cantilever {
    bar: Bar,
    model: Arc<dyn ElasticModel>,
    held: Grip,
    step: f64,
    /// Of its end under the load, over its length.
    deflection: f64,
    /// The excess of the deflection at rest over that in small steps, for [`LONGEST`] and its halves, of a model that steps itself.
    softer: Vec<f64>,
}

impl Cantilever {
    /// A beam of cells across its depth and width; `None` if the model does not take it or has no balance.
    fn new(model: &Model, across: u32) -> Option<Self> {
        let side = DEPTH / f64::from(across);
        let bar = Bar::new(model.elements, [across, across, SLENDERNESS * across], side, DENSITY);
        let (mut made, is) = bar.model(model, MATERIAL)?;
        if model.is_springs() {
            // Springs with which the beam, when it is pulled, has the modulus of the material.
            let material = Material { young: MATERIAL.young * MATERIAL.young / is.young, ..MATERIAL };
            made = bar.model(model, material)?.0;
        }
        let load = LOAD * bar.rigidity(MATERIAL) / (bar.length * bar.length);
        // A model that steps itself rests where the shape model does in small steps.
        let twin = Model { kind: "shape-based", ..*model };
        let resting = if model.kind == "xpbd" { bar.model(&twin, MATERIAL)?.0 } else { Arc::clone(&made) };
        let position = bar.bent(resting.as_ref(), DVec3::X * load, bar.body.rest().to_vec())?;
        let held = hold(&bar.ends[0]);
        let restraint =
            Restraint { grips: std::slice::from_ref(&held), duration: f64::INFINITY, ..Restraint::default() };
        let stability = Stability::of(&bar.body, made.as_ref(), INTEGRATOR, restraint);
        let (step, deflection) = (Stability::SHARE * stability.largest, bar.tip(&position).x / bar.length);
        let mut beam = Self { bar, model: made, held, step, deflection, softer: Vec::new() };
        if beam.model.projection(&beam.bar.body).is_some() {
            beam.settle(load, position)?;
        }
        Some(beam)
    }

    /// The step of a model that steps itself, and its deflection in such steps, from that in small ones.
    fn settle(&mut self, load: f64, mut position: Vec<DVec3>) -> Option<()> {
        let small = self.deflection;
        self.step = LONGEST * self.model.properties(&self.bar.body).shortest_period(&self.bar.body);
        loop {
            let parts = [(Arc::clone(&self.bar.body), self.model.as_ref())];
            position = rest_of(&parts, position, &self.bar.under(DVec3::X * load), self.step)?;
            self.deflection = self.bar.tip(&position).x / self.bar.length;
            self.softer.push(self.deflection / small - 1.0);
            if self.softer.last()?.abs() < CLOSE {
                return Some(());
            }
            self.step *= 0.5;
        }
    }

    /// The beam as it begins to hang, by its own weight in place of the load, which changes no time.
    fn world(&self) -> World {
        let around = Surroundings { gravity: DVec3::X, grips: vec![self.held.clone()], ..Surroundings::default() };
        let start = State::at_rest(self.bar.body.rest().to_vec());
        World::new(&self.bar.body, start, self.model.as_ref(), around, Stepping::new(INTEGRATOR, self.step))
    }
}

impl Results {
    /// The results as text.
    fn text(&self) -> String {
        format!(
            include_str!("time.md"),
            slenderness = SLENDERNESS,
            load = LOAD,
            reference = self.reference,
            coarse = self.study.fine[0],
            fine = self.study.fine[1],
            kind_of_time = kind_of_time(),
            machine = machine(),
            rounds = self.study.rounds,
            depth = 1e3 * DEPTH,
            young = 1e-6 * MATERIAL.young,
            density = DENSITY,
            recommended = self.recommended().markdown(2),
            runs = self.runs().markdown(2),
            close = 100.0 * CLOSE,
            steps = self.steps_table().markdown(2),
        )
    }

    /// The fastest runs for some errors.
    fn recommended(&self) -> Table {
        let rows = WANTED.into_iter().filter_map(|wanted| {
            let named =
                |one: &Timed| format!("`{}`, {}, N = {}", one.model.name, one.model.elements.name(false), one.across);
            let fastest = |of: &dyn Fn(&Timed) -> bool| {
                let good = self.timed.iter().filter(|one| of(one) && self.from(one).all(|finer| finer.error <= wanted));
                good.min_by(|one, other| one.time.median.total_cmp(&other.time.median))
            };
            let shown =
                |one: Option<&Timed>| [or_dash(one.map(named)), one.map(|one| figure(1e3 * one.time.median)).into()];
            let [best, time] = shown(Some(fastest(&|_| true)?));
            let [elements, of_elements] = shown(fastest(&|one| !one.model.name.starts_with("shape-based")));
            let error = format!("{} %", 100.0 * wanted);
            Some([
                ("error", error.into()),
                ("fastest", best),
                ("ms", time),
                ("without the shape model", elements),
                ("ms ", of_elements),
            ])
        });
        Table::of(rows)
    }

    fn runs(&self) -> Table {
        let row = |one: &Timed| {
            [
                ("model", format!("`{}`", one.model.name).into()),
                ("elements", one.model.elements.name(false).into()),
                ("N", one.across.into()),
                ("number", one.elements.into()),
                ("error", format!("{:.1} %", 100.0 * one.error).into()),
                ("ΔT (µs)", figure(1e6 * one.step).into()),
                ("time of 1 s (ms)", figure(1e3 * one.time.median).into()),
            ]
        };
        Table::of(self.timed.iter().map(row))
    }

    /// What longer steps change, of the model that steps itself.
    fn steps_table(&self) -> Table {
        let stepped = || self.timed.iter().filter(|one| !one.softer.is_empty());
        let most = stepped().map(|one| one.softer.len()).max().unwrap_or(0);
        let columns = (0..most).map(|halved| format!("ΔT = T/{}", f64::from(1 << halved) / LONGEST));
        let row = |one: &Timed| -> Vec<Cell> {
            let named: [Cell; 2] = [one.model.elements.name(false).into(), one.across.into()];
            let shown =
                |at: usize| one.softer.get(at).map_or_else(String::new, |softer| format!("{:.1} %", 100.0 * softer));
            named.into_iter().chain((0..most).map(|at| shown(at).into())).collect()
        };
        Table::wide(&["elements", "N"], columns, stepped().map(row).collect())
    }

    /// A run, and those of its model with more cells.
    fn from<'a>(&'a self, one: &'a Timed) -> impl Iterator<Item = &'a Timed> {
        self.timed.iter().filter(|other| other.model == one.model && other.across >= one.across)
    }

    /// All numbers, with all digits.
    fn table(&self) -> Table {
        Table::of(self.timed.iter().map(|one| {
            [
                ("model", one.model.name.into()),
                ("elements", one.model.elements.name(false).into()),
                ("cells_across", one.across.into()),
                ("number", one.elements.into()),
                ("deflection_over_length", one.across_length.into()),
                ("error", one.error.into()),
                ("step_s", one.step.into()),
                ("s_median", one.time.median.into()),
                ("s_lower", one.time.lower.into()),
                ("s_upper", one.time.upper.into()),
                ("s_least", one.time.least.into()),
            ]
        }))
    }

    /// Errors against times.
    fn page(&self) -> Page {
        let plot = |name: &str, is_shown: &dyn Fn(&Model) -> bool| {
            let line = |model: &Model| {
                let of_model = self.timed.iter().filter(|one| one.model == *model);
                model.curve(of_model.map(|one| [1e3 * one.time.median, one.error]))
            };
            let axes = ["time of a simulated second (ms)", "error of the deflection"];
            let curves = Time::models().filter(|model| is_shown(model)).map(line).collect();
            Plot { name: name.to_owned(), axes, curves, slopes: None }
        };
        let is_of_cells = |model: &Model| model.elements == Elements::Cells;
        let is_usual = |model: &Model| matches!(model.kind, "shape-based" | "linear" | "corotational" | "neo-hookean");
        let plots = vec![
            plot("hexahedra: shape model and finite elements", &|model| is_of_cells(model) && is_usual(model)),
            plot("hexahedra: other models, and the best of these", &|model| {
                is_of_cells(model) && (!is_usual(model) || model.name == MENDED)
            }),
            plot("tetrahedra", &|model| !is_of_cells(model)),
        ];
        Page {
            title: "A beam: error against time".to_owned(),
            caption: vec![
                format!(
                    "Each dot is a bar of N×N×{SLENDERNESS}N cells, N from 1, under a load with P L²/EI = {LOAD}; ν = 0."
                ),
                format!("Times on one thread of {}.", machine()),
            ],
            contents: Contents::Plots(plots),
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/beam_time.rs"]
mod tests;
