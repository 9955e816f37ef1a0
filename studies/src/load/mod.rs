//! The models under loads, at rest: what they do beside closed forms and the literature, for finer and finer cells.

mod bend;
mod column;
mod follower;
mod pull;
mod ring;
mod twist;
mod weight;

use crate::material::{Bar, MODELS, Model, Parts, decimals, hold, rest_of};
use crate::study::{Findings, Study, Watch, each};
use crate::table::Table;
use glam::DVec3;
use localshape::sim::model::ElasticModel;
use localshape::sim::{Body, Integrator, Load, Moment, Source, State, Stepping, Surroundings, World};
use std::sync::Arc;

/// The study: each case with as many numbers of refinements, but not more than it allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Loads {
    pub(crate) most: u32,
}

/// A case, which has a closed form.
struct Case {
    name: &'static str,
    /// What is measured, with its source.
    what: &'static str,
    /// The measured value over that of the closed form after a number of refinements; `None` for a model that does not take the body, or has no
    /// state of rest.
    measure: fn(&Model, u32) -> Option<f64>,
    /// How many numbers of refinements are measured.
    levels: u32,
    /// Whether springs take part, which are no material.
    with_springs: bool,
}

const CASES: [Case; 9] = [
    pull::STRETCHED,
    pull::PRESSED,
    twist::CASE,
    follower::CASE,
    bend::CASE,
    column::CASE,
    ring::CASE,
    weight::STACK,
    weight::SCALE,
];

impl Case {
    fn models(&self) -> impl Iterator<Item = &'static Model> {
        MODELS.iter().filter(|model| self.with_springs || !model.is_springs())
    }
}

impl Loads {
    pub(crate) const USUAL: Self = Self { most: 3 };
}

impl Study for Loads {
    fn work(&self) -> u64 {
        let of = |case: &Case| case.models().count() as u64 * u64::from(case.levels.min(self.most));
        CASES.iter().map(of).sum()
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(*self, watch)?;
        Some(Findings { text: text(*self, &results), tables: vec![("load", table(&results))], page: None })
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
    let levels =
        |(case, model): (&'static Case, _)| (0..case.levels.min(study.most)).map(move |refined| (case, model, refined));
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
    let mut tables = String::new();
    for case in &CASES {
        let levels = case.levels.min(study.most);
        let row = |model: &'static Model| {
            let of_row = results.iter().filter(|one| (one.case, one.model) == (case.name, model));
            let ratios: Vec<_> = of_row.map(|one| one.ratio).collect();
            let cells = ratios.iter().map(|&ratio| decimals(ratio, 5)).chain([decimals(order(&ratios), 1)]);
            ratios.iter().any(Option::is_some).then(|| model.row(false, cells))
        };
        let columns = (0..levels).map(|refined| format!("cells / {}", 1 << refined));
        let rows = case.models().filter_map(row).collect();
        let table = Table::wide(&["model", "elements"], columns.chain(["order".to_owned()]), rows).markdown(2);
        tables += &format!("\n## {}\n\n{}\n\n{table}\n", case.name, case.what);
    }
    let DVec3 { x, y, z } = bend::end();
    format!(include_str!("text.md"), end = format!("({x:.2}, {y:.2}, {z:.2})"), tables = tables)
}

/// All numbers, with all digits.
fn table(results: &[Measured]) -> Table {
    Table::of(results.iter().map(|one| {
        [
            ("case", one.case.into()),
            ("model", one.model.name.into()),
            ("elements", one.model.elements.name(false).into()),
            ("refined", one.refined.into()),
            ("found_over_closed_form", one.ratio.into()),
        ]
    }))
}

/// The order with which the last error fell; `None` where it did not, changed its sign, or is small.
fn order(ratios: &[Option<f64>]) -> Option<f64> {
    const SMALL: f64 = 1e-3;
    let &[before, after] = ratios.last_chunk()?;
    let [before, after] = [before? - 1.0, after? - 1.0];
    let falls = before.abs() > after.abs().max(SMALL) && before * after > 0.0;
    falls.then(|| libm::log2(before / after))
}

/// A bar of 20 : 1 with a side of 1 m.
fn slender(model: &Model, refined: u32) -> Bar {
    let across = 1 << refined;
    Bar::new(model.elements, [across, across, 20 * across], 1.0 / f64::from(across), 1.0)
}

/// A body at rest whose nodes are `held`, under some loads.
fn at_rest(
    body: &Arc<Body>,
    model: &dyn ElasticModel,
    held: &[usize],
    loads: Vec<Arc<dyn Load>>,
) -> Option<Vec<DVec3>> {
    let grips = if held.is_empty() { Vec::new() } else { vec![hold(held)] };
    let around = Surroundings { grips, loads, ..Surroundings::default() };
    rest_of(&[(Arc::clone(body), model)], body.rest().to_vec(), &around, 1.0)
}

/// The mean force (N) of each obstacle and hold, on one body after the other, over some steps from rest.
fn reactions(parts: &Parts<'_>, position: Vec<DVec3>, around: Surroundings, steps: u64) -> Option<Vec<DVec3>> {
    let period = |(body, model): &(Arc<Body>, &dyn ElasticModel)| model.properties(body).shortest_period(body);
    let step = parts.iter().map(period).fold(f64::INFINITY, f64::min) / 50.0;
    let stepping = Stepping::new(Integrator::SemiImplicitEuler, step);
    let mut world = World::of_parts(parts, State::at_rest(position), around, stepping);
    world.keep_reactions(Moment::at(steps as f64 * step));
    world.advance(steps);
    let outside = world.reactions()?.into_iter().filter(|one| !matches!(one.from, Source::Body(_)));
    Some(outside.map(|one| one.force).collect())
}

#[cfg(test)]
#[path = "../../tests/inside/load.rs"]
mod tests;
