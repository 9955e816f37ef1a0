//! Cook's membrane: a skew panel in the plane, held at its left side and sheared at its right one.
//!
//! R. Cook, "Improved two-dimensional finite element", Journal of the Structural Division 100, 1851 (1974). Corners at (0, 0), (48, 44),
//! (48, 60) and (0, 44); `E` = 1, `ν` = 1/3, unit thickness, plane stress, and a shear load of 1, uniform along the right side. Literature gives
//! the deflection of the middle of that side.

use super::balance::{dead, hold, rest_of};
use super::{Elements, MODELS, Model, decimals, moved};
use crate::page::{Contents, Page, Plot};
use crate::study::{Findings, Study, Watch, each};
use crate::table::{Cell, Table};
use glam::DVec3;
use localshape::sim::{Body, Material, Surroundings};
use std::sync::Arc;

/// The study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cook {
    /// Cells along each side, each number even and twice the one before.
    pub(crate) cells: Vec<u32>,
}

const MATERIAL: Material = Material { young: 1.0, poisson: 1.0 / 3.0 };
/// The deflection from many elements of several kinds, as most papers since P. Bergan and C. Felippa, Computer Methods in Applied Mechanics
/// and Engineering 50, 25 (1985), give it, such as J. Simo and M. Rifai, International Journal for Numerical Methods in Engineering 29, 1595
/// (1990).
const PRINTED: f64 = 23.96;
/// The load here: so small that all laws are linear.
const LOAD: f64 = 1e-6;

impl Cook {
    pub(crate) fn usual() -> Self {
        Self { cells: vec![2, 4, 8, 16, 32] }
    }

    /// The models that are a material with any `ν`.
    fn models() -> impl Iterator<Item = &'static Model> {
        MODELS.iter().filter(|model| !model.is_springs())
    }
}

impl Study for Cook {
    fn work(&self) -> u64 {
        (Self::models().count() * self.cells.len()) as u64
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self, watch)?;
        let (text, tables) = (results.text(), vec![("cook", results.table())]);
        Some(Findings { text, tables, page: Some(results.page()) })
    }
}

/// The deflection with a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Deflection {
    pub(crate) model: Model,
    pub(crate) cells: u32,
    /// Of the middle of the right side, for a load of 1; `None` without a balance.
    pub(crate) deflection: Option<f64>,
}

/// The findings, which do not depend on the machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    study: Cook,
    /// Model by model.
    pub(crate) deflections: Vec<Deflection>,
}

/// Measures on the thread pool of the caller; `None` if `watch` stops it.
pub(crate) fn measure(study: &Cook, watch: &Watch<'_>) -> Option<Results> {
    let pairs: Vec<_> = Cook::models().flat_map(|model| study.cells.iter().map(move |&cells| (model, cells))).collect();
    let deflections = each(&pairs, watch, |&(model, cells)| {
        let deflection = deflection(model, cells);
        Deflection { model: *model, cells, deflection }
    })?;
    Some(Results { study: study.clone(), deflections })
}

fn deflection(model: &Model, cells: u32) -> Option<f64> {
    let body = panel(model, cells);
    let made = model.on(&body, MATERIAL, 1.0)?;
    let held: Vec<_> = (0..body.len()).filter(|&node| body.rest()[node].x == 0.0).collect();
    let is_right = |rest: &DVec3| (rest.x - 48.0).abs() < 1e-9;
    let right: Vec<_> = (0..body.len()).filter(|&node| is_right(&body.rest()[node])).collect();
    let mut load = vec![DVec3::ZERO; body.len()];
    for (at, &node) in right.iter().enumerate() {
        let part = if at == 0 || at + 1 == right.len() { 0.5 } else { 1.0 };
        load[node] = DVec3::Y * (LOAD * part / f64::from(cells));
    }
    let around = Surroundings { grips: vec![hold(&held)], loads: vec![dead(load)], ..Surroundings::default() };
    let found = rest_of(&[(Arc::clone(&body), made.as_ref())], body.rest().to_vec(), &around, 1.0)?;
    let middle = right[right.len() / 2];
    Some((found[middle].y - body.rest()[middle].y) / LOAD)
}

/// The panel, by a bilinear map of a square block.
fn panel(model: &Model, cells: u32) -> Arc<Body> {
    let square = model.elements.block(&[cells; 2], 1.0, (0.0, 1), 1.0);
    let place = |rest: DVec3| {
        let [s, t] = [rest.x / f64::from(cells) + 0.5, rest.y / f64::from(cells)];
        DVec3::new(48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.0)
    };
    moved(&square, place)
}

impl Results {
    /// The deflections of a model, one for each number of cells.
    fn of<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = &'a Deflection> {
        self.deflections.iter().filter(move |one| one.model == *model)
    }

    /// The limit of the deflections of a model for many cells, from the last three, if they converge.
    fn limit(&self, model: &Model) -> Option<f64> {
        let all: Option<Vec<_>> = self.of(model).map(|one| one.deflection).collect();
        let &[coarse, middle, fine] = all.as_deref()?.last_chunk()?;
        // The corner at the upper left makes the convergence slower than 1/N².
        let rate = (middle - coarse) / (fine - middle);
        (rate > 1.2).then(|| fine + (fine - middle) / (rate - 1.0))
    }

    /// The results as text.
    fn text(&self) -> String {
        let columns = self.study.cells.iter().map(|cells| format!("N = {cells}")).chain(["*limit*".to_owned()]);
        let row = |model: &Model| {
            let found = self.of(model).map(|one| one.deflection).chain([self.limit(model)]);
            model.row(true, found.map(|number| decimals(number, 2)))
        };
        let off = |elements: Elements| {
            let shape = MODELS.iter().find(|model| model.elements == elements).and_then(|model| self.limit(model));
            shape.map_or_else(|| "unknown".to_owned(), |limit| format!("{:+.1} %", 100.0 * (limit / PRINTED - 1.0)))
        };
        format!(
            include_str!("cook.md"),
            printed = PRINTED,
            table = Table::wide(&["model", "elements"], columns, Cook::models().map(row).collect()).markdown(2),
            cells = off(Elements::Cells),
            simplices = off(Elements::Simplices),
        )
    }

    /// All numbers, with all digits.
    fn table(&self) -> Table {
        Table::of(self.deflections.iter().map(|one| {
            [
                ("model", one.model.name.into()),
                ("elements", one.model.elements.name(true).into()),
                ("cells_along_side", one.cells.into()),
                ("deflection", one.deflection.into()),
                ("literature", Cell::Given(PRINTED)),
            ]
        }))
    }

    /// Errors against the number of cells.
    fn page(&self) -> Page {
        let plot = |elements: Elements| {
            let point = |one: &Deflection| Some([f64::from(one.cells), (one.deflection? / PRINTED - 1.0).abs()]);
            let of_elements = Cook::models().filter(|model| model.elements == elements);
            Plot {
                name: elements.name(true).to_owned(),
                axes: ["cells along a side, N", "error of the deflection"],
                curves: of_elements.map(|model| model.curve(self.of(model).filter_map(point))).collect(),
                slopes: None,
            }
        };
        Page {
            title: "Cook's membrane: error against cells".to_owned(),
            caption: vec![format!(
                "The deflection beside {PRINTED}, the number in the literature (E = 1, ν = 1/3, load 1)."
            )],
            contents: Contents::Plots(Elements::ALL.map(plot).into()),
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/cook.rs"]
mod tests;
