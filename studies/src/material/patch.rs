//! The patch test: an irregular block whose surface is strained uniformly, and how far its inside stays from that strain.
//!
//! In a uniform material the inside follows (B. Irons, A. Razzaque, "Experience with the patch test for convergence of finite elements", in
//! A. Aziz (ed.), "The mathematical foundations of the finite element method", 1972, 557; R. Taylor and others, "The patch test: a condition
//! for assessing FEM convergence", International Journal for Numerical Methods in Engineering 22, 39 (1986)).

use super::balance::{Forces, balance};
use super::{MODELS, Model};
use crate::folder::Notes;
use crate::progress::Watch;
use crate::study::{Findings, Study};
use crate::table::{Cell, Table};
use glam::{DMat3, DVec3};
use localshape::sim::geometry::volumes_at_rest;
use localshape::sim::{Dimension, Material};
use rayon::prelude::*;

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
    fn name(&self) -> &'static str {
        "patch"
    }

    fn work(&self) -> u64 {
        (MODELS.len() * POISSON.len() * IRREGULAR.len()) as u64
    }

    fn measure(&self, watch: &Watch<'_>, _: &Notes) -> Option<Findings> {
        let results = measure(self, watch)?;
        Some(Findings::new(results.text(), [("patch", results.table())]))
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
    let missed = all.par_iter().map(|&(model, poisson, irregular)| {
        let one = watch(0).then(|| study.missed(model, poisson, irregular));
        one.filter(|_| watch(1))
    });
    Some(Results { study: study.clone(), missed: missed.collect::<Option<_>>()? })
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
        let (low, high) = body
            .rest()
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &at| (low.min(at), high.max(at)));
        let held: Vec<_> =
            body.rest().iter().map(|&rest| [(rest - low).min(high - rest).min_element() < 1e-6 * SIDE; 3]).collect();
        let load = vec![DVec3::ZERO; body.len()];
        let found = balance(&body, made.as_ref(), &load, &held, &uniform)?;
        let inside = || found.iter().zip(&uniform).zip(&held).filter(|(_, held)| !held[0]);
        let squares_of_miss: f64 = inside().map(|((found, uniform), _)| found.distance_squared(*uniform)).sum();
        let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
        let density = material.shear() * squares(strain) + 0.5 * material.lame(Dimension::Space) * trace * trace;
        let expected = density * SIZE * SIZE * volumes_at_rest(&body).iter().sum::<f64>();
        let energy = Forces::new(&body, made.as_ref(), &found).energy(&found)?;
        let unit = SIZE * SIDE;
        Some([squares_of_miss / (inside().count() as f64 * unit * unit), energy / expected - 1.0])
    }
}

impl Results {
    /// The results as text.
    fn text(&self) -> String {
        let Patch { cells, blocks } = self.study;
        let mut text = format!(
            "# Patch test\n\n\
            A block of {cells}×{cells}×{cells} cells has its nodes disturbed at random, as by `irregular` in scenes. All nodes on its surface are \
            placed as in a uniform strain of all six components; those inside are free. In a uniform material they follow. The first table \
            has their RMS distance from the uniform strain, in strains times sides; *0* is round-off. The second has the excess of the \
            energy over that of the material. Both are means of {blocks} blocks.\n",
        );
        for (poisson, of) in POISSON.iter().flat_map(|&poisson| [(poisson, true), (poisson, false)]) {
            let rows: Vec<_> = MODELS.iter().filter_map(|model| self.row(model, poisson, of)).collect();
            let what = if of { "Miss" } else { "Energy" };
            let heads = ["model", "elements"].map(str::to_owned).into_iter();
            let heads = heads.chain(IRREGULAR.map(|irregular| format!("irregular = {irregular}"))).collect();
            text += &format!("\n{what}, ν = {poisson}:\n\n{}", Table { heads, rows }.markdown(2));
        }
        let passes = |model: &&Model| {
            let mut all = self.missed.iter().filter(|one| one.model == **model);
            all.all(|one| one.miss.is_some_and(|miss| miss < ROUND_OFF))
        };
        let name = |model: &Model| format!("`{}` on {}", model.name, model.elements.name(false));
        let pass: Vec<_> = MODELS.iter().filter(passes).map(name).collect();
        text += &format!("\nIt is passed by {}; the others fail it.\n", pass.join(", "));
        text += "\nAn element of the shape model resists as its material only if its nodes spread alike in all directions. A displaced node makes \
            its elements stiffer along some axes and softer along others, so that their forces do not balance in a uniform strain. Of \
            tetrahedra only regular ones are such elements, which most are not even on a regular lattice: hence the energy there. Take \
            regular hexahedra, or finite elements where cells are irregular. The metric at the corners of a cell is exact for \
            parallelepipeds, and off by little for other cells. Springs pass on a regular lattice, too. `xpbd` has the energy of `shape-based`, \
            and the same balance.\n";
        text
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
            number.map_or_else(|| "–".to_owned(), shown).into()
        };
        Some(model.names(false).into_iter().chain(self.missed.iter().filter(is_row).map(cell)).collect())
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
