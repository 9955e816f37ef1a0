//! The models under loads, at rest: what they do beside closed forms and the literature, for finer and finer cells.

mod bend;
mod column;
mod follower;
mod pull;
mod ring;
mod twist;
mod weight;

use crate::folder::Notes;
use crate::material::{MODELS, Model, decimals};
use crate::study::{Findings, Study, Watch, each};
use crate::table::{Cell, Table, or_dash};
use glam::DVec3;
use localshape::sim::model::ElasticModel;
use localshape::sim::{Body, Course, Crew, Equilibrium, Grip, Load, Loading, Motion, State, Surroundings, equilibrium};
use std::sync::Arc;

/// The study: each case with as many refinements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Loads {
    pub(crate) refined: u32,
}

/// A case, which has a closed form.
struct Case {
    name: &'static str,
    /// What is measured, with its source.
    what: &'static str,
    /// The measured value over that of the closed form after a number of refinements; `None` for a model that does not take the body, or has no
    /// state of rest.
    measure: fn(&Model, u32) -> Option<f64>,
    /// Whether springs take part, which are no material.
    with_springs: bool,
}

const CASES: [Case; 7] = [pull::CASE, twist::CASE, follower::CASE, bend::CASE, column::CASE, ring::CASE, weight::CASE];

impl Case {
    fn models(&self) -> impl Iterator<Item = &'static Model> {
        MODELS.iter().filter(|model| self.with_springs || !model.is_springs())
    }
}

impl Loads {
    pub(crate) const USUAL: Self = Self { refined: 3 };
}

impl Study for Loads {
    fn name(&self) -> &'static str {
        "load"
    }

    fn work(&self) -> u64 {
        CASES.iter().map(|case| case.models().count() as u64).sum::<u64>() * u64::from(self.refined)
    }

    fn measure(&self, watch: &Watch<'_>, _: &Notes) -> Option<Findings> {
        let results = measure(*self, watch)?;
        let rows = results.iter().map(|one| {
            [
                ("case", one.case.into()),
                ("model", one.model.name.into()),
                ("elements", one.model.elements.name(false).into()),
                ("refined", one.refined.into()),
                ("found/closed form", one.ratio.into()),
            ]
        });
        Some(Findings { text: text(*self, &results), tables: vec![("load", Table::of(rows))], page: None })
    }
}

/// What was measured with a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measured {
    pub(crate) case: &'static str,
    pub(crate) model: &'static Model,
    pub(crate) refined: u32,
    /// Over the value of the closed form.
    pub(crate) ratio: Option<f64>,
}

/// Measures on the thread pool of the caller; `None` if `watch` stops it.
pub(crate) fn measure(study: Loads, watch: &Watch<'_>) -> Option<Vec<Measured>> {
    let of_case = |case: &'static Case| case.models().map(move |model| (case, model));
    let levels = |(case, model)| (0..study.refined).map(move |refined| (case, model, refined));
    let all: Vec<(&Case, &Model, u32)> = CASES.iter().flat_map(of_case).flat_map(levels).collect();
    each(&all, watch, |&(case, model, refined)| Measured {
        case: case.name,
        model,
        refined,
        ratio: (case.measure)(model, refined),
    })
}

/// The results as text: a table for each case.
fn text(study: Loads, results: &[Measured]) -> String {
    let mut text = include_str!("text.md").to_owned();
    for case in &CASES {
        let row = |model: &&'static Model| {
            let of =
                |refined| results.iter().find(|one| (one.case, one.model, one.refined) == (case.name, *model, refined));
            let ratios: Vec<_> = (0..study.refined).map(|refined| of(refined).and_then(|one| one.ratio)).collect();
            let cells = ratios.iter().map(|&ratio| decimals(ratio, 5)).chain([order(&ratios)]);
            ratios.iter().any(Option::is_some).then(|| model.row(false, cells))
        };
        let models: Vec<_> = case.models().collect();
        let columns = (0..study.refined).map(|refined| format!("cells / {}", 1 << refined));
        let rows = models.iter().filter_map(row).collect();
        let table = Table::wide(&["model", "elements"], columns.chain(["order".to_owned()]), rows).markdown(2);
        text += &format!("\n## {}\n\n{}\n\n{table}\n", case.name, case.what);
    }
    text
}

/// The order of convergence by the last three values; a dash where they do not converge, or have done so to round-off.
fn order(ratios: &[Option<f64>]) -> Cell {
    const ROUND_OFF: f64 = 1e-6;
    let found = ratios.last_chunk().and_then(|&[coarse, middle, fine]| {
        let [before, after] = [middle? - coarse?, fine? - middle?];
        (before.abs() > ROUND_OFF && before / after > 1.0).then(|| libm::log2(before / after))
    });
    or_dash(found.map(|order| format!("{order:.1}")))
}

/// A body at rest whose nodes are `held`, under some loads.
fn at_rest(
    body: &Arc<Body>,
    model: &dyn ElasticModel,
    held: &[usize],
    loads: Vec<Arc<dyn Load>>,
) -> Option<Vec<DVec3>> {
    let nodes: Vec<_> = held.iter().map(|&node| node as u32).collect();
    let grip = Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still };
    let grips = if held.is_empty() { Vec::new() } else { vec![grip] };
    let around = Surroundings { grips, loads, ..Surroundings::default() };
    let start = State::at_rest(body.rest().to_vec());
    let found = equilibrium(&[(Arc::clone(body), model)], &start, &around, 1.0, Crew::default());
    found.ok().map(|Equilibrium { position, .. }| position)
}

/// Forces (N) of constant direction, one for each node.
fn dead(forces: Vec<DVec3>) -> Arc<dyn Load> {
    let (nodes, forces) = (0..).zip(forces).filter(|(_, force)| *force != DVec3::ZERO).unzip();
    Arc::new(Loading::dead(nodes, forces, Course::ALWAYS))
}
