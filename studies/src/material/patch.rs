//! The patch test: an irregular block whose surface is strained uniformly, and how far its inside stays from that strain.
//!
//! In a uniform material the inside follows (B. Irons, A. Razzaque, "Experience with the patch test for convergence of finite elements", in
//! A. Aziz (ed.), "The mathematical foundations of the finite element method", 1972, 557; R. Taylor and others, "The patch test: a condition
//! for assessing FEM convergence", International Journal for Numerical Methods in Engineering 22, 39 (1986)).

use super::balance::{hold, rest_of};
use super::{MODELS, Model};
use crate::study::{Findings, Study, Watch, each};
use crate::table::{Cell, Table, or_dash};
use glam::{DMat3, DVec3};
use localshape::sim::geometry::{bounds, volumes_at_rest};
use localshape::sim::model::{ElasticModel, Scratch};
use localshape::sim::{Body, Dimension, Material, Nodes, Surroundings};
use std::sync::Arc;

/// The study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Cells along each side.
    pub(crate) cells: u32,
    /// The number of irregular blocks for each disturbance.
    pub(crate) blocks: u32,
}

/// Disturbances of the nodes, as `irregular` in scenes, and Poisson's ratios.
const IRREGULAR: [f64; 4] = [0.0, 0.1, 0.2, 0.3];
const POISSON: [f64; 2] = [0.0, 0.3];
/// Side of a cell (m), and Young's modulus (Pa). They leave all results as they are, which are relative.
const SIDE: f64 = 0.1;
const YOUNG: f64 = 2e5;
/// A miss below this share is round-off.
const ROUND_OFF: f64 = 1e-9;

impl Patch {
    pub(crate) fn usual() -> Self {
        Self { cells: 4, blocks: 5 }
    }
}

impl Study for Patch {
    fn work(&self) -> u64 {
        (MODELS.len() * POISSON.len() * IRREGULAR.len()) as u64
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self, watch)?;
        Some(Findings { text: results.text(), tables: vec![("patch", results.table())], page: None })
    }
}

/// The outcome of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Missed {
    pub(crate) model: Model,
    pub(crate) poisson: f64,
    pub(crate) irregular: f64,
    /// The RMS distance of the nodes inside from the uniform strain, over the strain times the side; `None` without a balance.
    pub(crate) miss: Option<f64>,
    /// The mean energy over that of the material in uniform strain, less 1.
    pub(crate) energy: Option<f64>,
}

/// The findings, which do not depend on the machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    study: Patch,
    pub(crate) missed: Vec<Missed>,
}

/// Measures on the thread pool of the caller; `None` if `watch` stops it.
pub(crate) fn measure(study: &Patch, watch: &Watch<'_>) -> Option<Results> {
    let all = MODELS.iter().flat_map(|model| POISSON.iter().map(move |&poisson| (model, poisson)));
    let all: Vec<_> = all.flat_map(|(model, poisson)| IRREGULAR.map(|irregular| (model, poisson, irregular))).collect();
    let missed = each(&all, watch, |&(model, poisson, irregular)| study.missed(model, poisson, irregular))?;
    Some(Results { study: study.clone(), missed })
}

/// A strain of every kind, of size 1.
fn strain() -> DMat3 {
    let strain = DMat3::from_cols_array(&[0.5, 0.3, -0.2, 0.3, -0.4, 0.25, -0.2, 0.25, 0.3]);
    strain * (1.0 / libm::sqrt(squares(strain)))
}

fn squares(map: DMat3) -> f64 {
    map.to_cols_array().iter().map(|entry| entry * entry).sum()
}

impl Patch {
    fn missed(&self, model: &Model, poisson: f64, irregular: f64) -> Missed {
        let material = Material { young: YOUNG, poisson };
        let found: Option<Vec<_>> =
            (1..=self.blocks).map(|seed| self.one(model, material, (irregular, seed))).collect();
        let mean =
            |of: fn(&[f64; 2]) -> f64| found.as_ref().map(|all| all.iter().map(of).sum::<f64>() / all.len() as f64);
        let miss = mean(|one| one[0]).map(libm::sqrt);
        Missed { model: *model, poisson, irregular, miss, energy: mean(|one| one[1]) }
    }

    /// The mean square of the miss of one block, and the excess of its energy.
    fn one(&self, model: &Model, material: Material, disturbed: (f64, u32)) -> Option<[f64; 2]> {
        /// The size of the strain.
        const SIZE: f64 = 1e-3;
        let body = model.elements.block(&[self.cells; 3], SIDE, disturbed, 1.0);
        let made = model.on(&body, material, SIDE)?;
        let strain = strain();
        let place = |&rest: &DVec3| rest + strain * rest * SIZE;
        let uniform: Vec<_> = body.rest().iter().map(place).collect();
        let (low, high) = bounds(body.rest());
        let is_outer = |&rest: &DVec3| (rest - low).min(high - rest).min_element() < 1e-6 * SIDE;
        let (held, inside): (Vec<_>, Vec<_>) = (0..body.len()).partition(|&node| is_outer(&body.rest()[node]));
        let around = Surroundings { grips: vec![hold(&held)], ..Surroundings::default() };
        let found = rest_of(&[(Arc::clone(&body), made.as_ref())], uniform.clone(), &around, 1.0)?;
        let squares_of_miss: f64 = inside.iter().map(|&node| found[node].distance_squared(uniform[node])).sum();
        let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
        let density = material.shear() * squares(strain) + 0.5 * material.lame(Dimension::Space) * trace * trace;
        let expected = density * SIZE * SIZE * volumes_at_rest(&body).iter().sum::<f64>();
        let energy = energy(&body, made.as_ref(), &found)?;
        let unit = SIZE * SIDE;
        Some([squares_of_miss / (inside.len() as f64 * unit * unit), energy / expected - 1.0])
    }
}

/// The elastic energy (J) of a body at rest, with the memory that goes with its forces; `None` for a model without one.
fn energy(body: &Arc<Body>, model: &dyn ElasticModel, position: &[DVec3]) -> Option<f64> {
    let (forces, memory, mut on_nodes) =
        (model.prepare(body), model.start(body, position), vec![DVec3::ZERO; body.len()]);
    let (mut next, still) = (memory.clone(), on_nodes.clone());
    let at = Nodes { position, velocity: &still };
    forces.add_forces(at, &memory, &mut next, &mut Scratch::default(), &mut on_nodes);
    forces.report(at, &next, &mut |_, _, _| ()).energy
}

impl Results {
    /// The results as text.
    fn text(&self) -> String {
        let passes = |model: &&Model| {
            let mut all = self.missed.iter().filter(|one| one.model == **model);
            all.all(|one| one.miss.is_some_and(|miss| miss < ROUND_OFF))
        };
        let name = |model: &Model| format!("`{}` on {}", model.name, model.elements.name(false));
        let passed: Vec<_> = MODELS.iter().filter(passes).map(name).collect();
        let tables = POISSON.map(|poisson| [true, false].map(|is_miss| self.outcomes(poisson, is_miss)).join("\n\n"));
        let Patch { cells, blocks } = self.study;
        let (passed, tables) = (passed.join(", "), tables.join("\n\n"));
        format!(include_str!("patch.md"), cells = cells, blocks = blocks, tables = tables, passed = passed)
    }

    /// The misses or the energies of all models, below a heading.
    fn outcomes(&self, poisson: f64, is_miss: bool) -> String {
        let rows = MODELS.iter().filter_map(|model| self.row(model, poisson, is_miss)).collect();
        let table =
            Table::wide(&["model", "elements"], IRREGULAR.map(|irregular| format!("irregular = {irregular}")), rows);
        format!("{}, ν = {poisson}:\n\n{}", if is_miss { "Miss" } else { "Energy" }, table.markdown(2))
    }

    fn row(&self, model: &Model, poisson: f64, is_miss: bool) -> Option<Vec<Cell>> {
        let is_row = |one: &&Missed| one.model == *model && one.poisson == poisson;
        // Springs have no material with which their energy could be compared.
        if model.is_springs() && (poisson > 0.0 || !is_miss) {
            return None;
        }
        let cell = |one: &Missed| -> Cell {
            let number = if is_miss { one.miss } else { one.energy };
            let shown = |number: f64| match is_miss {
                true if number < ROUND_OFF => "*0*".to_owned(),
                true if number < 5e-4 => "< 0.001".to_owned(),
                true => format!("{number:.3}"),
                false => format!("{:+.1} %", 100.0 * number).replace("-0.0", "+0.0"),
            };
            or_dash(number.map(shown))
        };
        Some(model.row(false, self.missed.iter().filter(is_row).map(cell)))
    }

    /// All numbers, with all digits.
    fn table(&self) -> Table {
        Table::of(self.missed.iter().map(|one| {
            [
                ("model", one.model.name.into()),
                ("elements", one.model.elements.name(false).into()),
                ("poisson", Cell::Given(one.poisson)),
                ("irregular", Cell::Given(one.irregular)),
                ("miss_rms", one.miss.into()),
                ("energy_excess", one.energy.into()),
            ]
        }))
    }
}

#[cfg(test)]
#[path = "../../tests/inside/patch.rs"]
mod tests;
