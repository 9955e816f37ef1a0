//! Cantilevers of few cells: how much stiffer than Timoshenko's beam each model is, also if it is nearly incompressible, and how near to the
//! elastica under large loads; free modes and waves of the shape model beside their closed forms.

use super::balance::{linear_forces, still};
use super::bar::Bar;
use super::theory::{elastica, timoshenko};
use super::{Elements, MENDED, MODELS, Model, decimals};
use crate::page::{Contents, Page, Plot};
use crate::study::{Findings, Study, Watch, each};
use crate::table::{Cell, Table};
use glam::DVec3;
use localshape::sim::Material;
use std::f64::consts::PI;

/// The study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Beam {
    /// Cells across the bars of which small deflections are measured.
    pub(crate) across: Vec<u32>,
    /// Cells along the bar that bends as an elastica, and the models that bend it.
    pub(crate) along: u32,
    pub(crate) bent: &'static [Model],
}

/// Length over depth of the bars of which small deflections are measured.
const SLENDERNESS: u32 = 8;
/// Cells across the bar that bends as an elastica.
const THICK: u32 = 2;
/// Side of a cell (m), and the material. They leave all results as they are, which are relative.
const SIDE: f64 = 0.1;
const MATERIAL: Material = Material { young: 2e5, poisson: 0.0 };

/// Poisson's ratios of the bars of which small deflections are measured. That of springs is not free.
const POISSON: [f64; 3] = [0.0, 0.3, 0.49];

/// `P L²/EI`, and deflections across and along over the length, as printed by K. Mattiasson, International Journal for Numerical Methods
/// in Engineering 17, 145 (1981), table 1.
const MATTIASSON: [(f64, Option<[f64; 2]>); 5] = [
    (0.5, None),
    (1.0, Some([0.30172, 0.05643])),
    (2.0, Some([0.49346, 0.16064])),
    (5.0, Some([0.71379, 0.38763])),
    (10.0, Some([0.81061, 0.55500])),
];

impl Beam {
    pub(crate) fn usual() -> Self {
        Self { across: (1..=8).collect(), along: 32, bent: &MODELS }
    }

    /// Models with each Poisson's ratio that they take.
    fn kinds() -> impl Iterator<Item = (&'static Model, f64)> {
        let takes = |&(model, poisson): &(&Model, f64)| poisson == 0.0 || !model.is_springs();
        MODELS.iter().flat_map(|model| POISSON.map(|poisson| (model, poisson))).filter(takes)
    }
}

impl Study for Beam {
    fn work(&self) -> u64 {
        (Self::kinds().count() * self.across.len() + self.bent.len()) as u64 + 1
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self, watch)?;
        let tables = vec![
            ("beam", results.table()),
            ("beam-elastica", results.elastica_table()),
            ("beam-waves", results.waves_table()),
        ];
        Some(Findings { text: results.text(), tables, page: Some(results.page()) })
    }
}

/// A small deflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tip {
    pub(crate) model: Model,
    /// As given to all models.
    pub(crate) poisson: f64,
    pub(crate) across: u32,
    /// The material that the model is on this bar; `None` if it does not take the bar, or has no balance.
    pub(crate) material: Option<Material>,
    /// The deflection over Timoshenko's for that material.
    pub(crate) ratio: Option<f64>,
}

/// Large deflections, one for each load of [`MATTIASSON`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bent {
    pub(crate) model: Model,
    /// Across and along, over the length; `None` without a balance.
    pub(crate) ends: Vec<Option<[f64; 2]>>,
}

/// A motion of the shape model with a closed form.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wave {
    pub(crate) name: &'static str,
    pub(crate) formula: &'static str,
    pub(crate) bending: &'static str,
    /// The greatest deviation of the forces from `−m ω² u`, relative to the greatest of these.
    pub(crate) error: f64,
}

/// The findings, which do not depend on the machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    study: Beam,
    /// Model by model.
    pub(crate) tips: Vec<Tip>,
    pub(crate) bent: Vec<Bent>,
    pub(crate) waves: Vec<Wave>,
}

/// Measures on the thread pool of the caller; `None` if `watch` stops it.
pub(crate) fn measure(study: &Beam, watch: &Watch<'_>) -> Option<Results> {
    let bars: Vec<_> = Beam::kinds().flat_map(|kind| study.across.iter().map(move |&across| (kind, across))).collect();
    let tips = each(&bars, watch, |&((model, poisson), across)| tip(model, poisson, across))?;
    let bent = each(study.bent, watch, |model| bend(model, study.along))?;
    let waves = waves();
    watch(1).then(|| Results { study: study.clone(), tips, bent, waves })
}

fn tip(model: &Model, poisson: f64, across: u32) -> Tip {
    /// `P L²/EI`.
    const LOAD: f64 = 1e-6;
    let bar = Bar::new(model.elements, [across, 1, SLENDERNESS * across], SIDE, 1.0);
    let made = bar.model(model, Material { poisson, ..MATERIAL });
    let ratio = made.as_ref().and_then(|(model, material)| {
        let load = LOAD * bar.rigidity(*material) / (bar.length * bar.length);
        let found = bar.bent(model.as_ref(), DVec3::X * load, bar.body.rest().to_vec())?;
        Some(bar.tip(&found).x / timoshenko(*material, bar.length, bar.section, load))
    });
    Tip { model: *model, poisson, across, material: made.map(|(_, material)| material), ratio }
}

fn bend(model: &Model, along: u32) -> Bent {
    let bar = Bar::new(model.elements, [THICK, THICK, along], SIDE, 1.0);
    let Some((made, material)) = bar.model(model, MATERIAL) else {
        return Bent { model: *model, ends: vec![None; MATTIASSON.len()] };
    };
    // Each balance starts from the one before.
    let mut position = Some(bar.body.rest().to_vec());
    let end = |&(load, _): &(f64, Option<[f64; 2]>)| {
        let load = DVec3::X * (load * bar.rigidity(material) / (bar.length * bar.length));
        position = position.take().and_then(|start| bar.bent(made.as_ref(), load, start));
        let moved = bar.tip(position.as_ref()?) / bar.length;
        Some([moved.x, -moved.z])
    };
    Bent { model: *model, ends: MATTIASSON.iter().map(end).collect() }
}

/// The modes along free columns of one cube across, and waves along an axis inside a lattice, with three factors of bending.
fn waves() -> Vec<Wave> {
    let shapes = MODELS.iter().zip(["1", "1/2", "1/3"]);
    shapes
        .flat_map(|(model, bending)| {
            let modes = [1, 2, 5, 8].map(|cells| modes(model, cells)).into_iter().fold(0.0, f64::max);
            let [pressure, shear] =
                [(DVec3::Z, 8.0), (DVec3::X, 4.0)].map(|(along, share)| plane_waves(model, along, share));
            [
                ("free column of N cubes, mode j", "√(2k/m) sin(jπ / 2(N + 1))", modes),
                ("plane wave of pressure", "√(8k/m) sin(qa/2)", pressure),
                ("plane wave of shear", "√(4k/m) sin(qa/2)", shear),
            ]
            .map(|(name, formula, error)| Wave { name, formula, bending, error })
        })
        .collect()
}

/// The greatest relative error of the modes of a free column.
fn modes(model: &Model, cells: u32) -> f64 {
    let bottom = -0.5 * (f64::from(cells) * SIDE);
    let phases = (1..=cells).map(|mode| f64::from(mode) * PI / f64::from(cells + 1));
    let shape = |phase: f64, at: DVec3| DVec3::Z * libm::cos(phase * (libm::round((at.z - bottom) / SIDE) + 0.5));
    off(model, [1, 1, cells], 2.0, phases, shape, |_| true)
}

/// The greatest relative error of plane waves along z.
fn plane_waves(model: &Model, along: DVec3, share: f64) -> f64 {
    let shape = |phase: f64, at: DVec3| along * libm::cos(phase * (at.z / SIDE) + 0.3);
    let is_inside = |at: DVec3| at.z.abs() < 4.0 * SIDE && at.x.abs() < 0.5 * SIDE && (at.y - SIDE).abs() < 0.5 * SIDE;
    off(model, [2, 2, 9], share, [0.1, 1.0, 2.0, PI].into_iter(), shape, is_inside)
}

/// `k = E a/2` (N/m).
const STIFFNESS: f64 = 0.5 * MATERIAL.young * SIDE;

/// The greatest deviation of the forces of shapes, which follow from phases and places, from `−m ω²` times them, relative to it. `m ω²` is
/// a share of `k sin²(φ/2)`.
fn off(
    model: &Model,
    cells: [u32; 3],
    share: f64,
    phases: impl Iterator<Item = f64>,
    shape: impl Fn(f64, DVec3) -> DVec3,
    counts: impl Fn(DVec3) -> bool,
) -> f64 {
    let body = Elements::Cells.block(&cells, SIDE, (0.0, 1), 1.0);
    let made = model.on(&body, MATERIAL, SIDE).expect("a lattice of cubes");
    let mut world = still(&body, made.as_ref(), body.rest().to_vec());
    let of_phase = |phase: f64| {
        let sine = libm::sin(0.5 * phase);
        let expected = share * STIFFNESS * sine * sine;
        let shape: Vec<_> = body.rest().iter().map(|&at| shape(phase, at)).collect();
        let found = linear_forces(&mut world, &body, &shape, 1e-3 * SIDE);
        let nodes = found.iter().zip(&shape).zip(body.rest()).filter(|(_, at)| counts(**at));
        nodes.map(|((&force, &shape), _)| (force + shape * expected).length() / expected).fold(0.0, f64::max)
    };
    phases.map(of_phase).fold(0.0, f64::max)
}

/// A row of a table: names, then numbers with some decimals.
fn row_of(names: [&str; 2], numbers: impl Iterator<Item = Option<f64>>, places: usize) -> Vec<Cell> {
    names.map(Cell::from).into_iter().chain(numbers.map(|number| decimals(number, places))).collect()
}

/// A number of a material, with its name.
type Modulus = (&'static str, fn(Material) -> f64);

impl Results {
    /// The results as text.
    fn text(&self) -> String {
        let lacks = |kind: &str| {
            let of_cells = MODELS.iter().find(|model| model.name == kind);
            let finest = of_cells.and_then(|model| self.of(model, POISSON[2]).last()?.ratio);
            finest.map_or_else(|| "an unknown part".to_owned(), |ratio| format!("{:.0} %", 100.0 * (1.0 - ratio)))
        };
        let with = |&poisson: &f64| format!("ν = {poisson}:\n\n{}", self.tips_table(poisson).markdown(2));
        let row = |wave: &Wave| {
            [
                ("motion", wave.name.into()),
                ("frequency", format!("`{}`", wave.formula).into()),
                ("β", wave.bending.into()),
                ("error", format!("{:.0e}", wave.error).into()),
            ]
        };
        format!(
            include_str!("beam.md"),
            slenderness = SLENDERNESS,
            small = self.tips_table(0.0).markdown(2),
            springs = self.springs_table().markdown(2),
            other_ratios = POISSON[1..].iter().map(with).collect::<Vec<_>>().join("\n\n"),
            most = POISSON[2],
            linear = lacks("linear"),
            metric = lacks("metric"),
            shapes = lacks("shape-based"),
            thick = THICK,
            along = self.study.along,
            across_length = self.bent_table(0).markdown(2),
            along_length = self.bent_table(1).markdown(2),
            mended = MENDED,
            within =
                self.farthest_from_elastica().map_or_else(|| "–".to_owned(), |part| format!("{:.1} %", 100.0 * part)),
            waves = Table::of(self.waves.iter().map(row)).markdown(3),
        )
    }

    /// The greatest relative error of the large deflections of [`MENDED`].
    fn farthest_from_elastica(&self) -> Option<f64> {
        let mended = self.bent.iter().find(|one| one.model.name == MENDED)?;
        let errors = mended.ends.iter().zip(MATTIASSON).flat_map(|(end, (load, _))| {
            let exact = elastica(load);
            [0, 1].map(|axis| end.map_or(f64::NAN, |end| (end[axis] / exact[axis] - 1.0).abs()))
        });
        Some(errors.fold(0.0, |most: f64, error| if error <= most { most } else { error }))
    }

    /// The tips of a model with a Poisson's ratio, one for each number of cells.
    fn of<'a>(&'a self, model: &'a Model, poisson: f64) -> impl Iterator<Item = &'a Tip> {
        self.tips.iter().filter(move |tip| tip.model == *model && tip.poisson == poisson)
    }

    fn tips_table(&self, poisson: f64) -> Table {
        let models = Beam::kinds().filter(|kind| kind.1 == poisson);
        let row =
            |(model, _): (&Model, f64)| model.row(false, self.of(model, poisson).map(|tip| decimals(tip.ratio, 4)));
        let formula = |(name, bending): (&str, f64)| {
            let ratio = |&across: &u32| 1.0 / (1.0 + (3.0 * bending - 1.0) / f64::from(across * across));
            row_of([&format!("*formula, β = {name}*"), ""], self.study.across.iter().map(ratio).map(Some), 4)
        };
        let formulas = [("1", 1.0), ("1/2", 0.5), ("1/3", 1.0 / 3.0)].map(formula);
        let formulas = formulas.into_iter().filter(|_| poisson == 0.0);
        Table::wide(&["model", "elements"], self.columns(), models.map(row).chain(formulas).collect())
    }

    /// The headings of columns with a number for each number of cells.
    fn columns(&self) -> impl Iterator<Item = String> {
        self.study.across.iter().map(|across| format!("N = {across}"))
    }

    fn springs_table(&self) -> Table {
        let springs = MODELS.iter().filter(|model| model.is_springs());
        let row = |(model, (name, of)): (&Model, Modulus)| {
            row_of([&format!("`{}`", model.name), name], self.of(model, 0.0).map(|tip| tip.material.map(of)), 4)
        };
        let moduli: [Modulus; 2] = [("E a/k", |one| 2.0 * one.young / MATERIAL.young), ("ν", |one| one.poisson)];
        let rows = springs.flat_map(|model| moduli.map(|of| (model, of))).map(row).collect();
        Table::wide(&["springs", "modulus"], self.columns(), rows)
    }

    fn bent_table(&self, axis: usize) -> Table {
        let exact = MATTIASSON.iter().map(|&(load, _)| Some(elastica(load)[axis]));
        let printed = MATTIASSON.iter().map(|&(_, printed)| Some(printed?[axis]));
        let theory = [row_of(["*elastica*", ""], exact, 5), row_of(["*Mattiasson 1981*", ""], printed, 5)];
        let ends = |one: &Bent| one.model.row(false, one.ends.iter().map(|end| decimals(end.map(|end| end[axis]), 5)));
        let columns = MATTIASSON.map(|(load, _)| format!("P L²/EI = {load}"));
        let rows = theory.into_iter().chain(self.bent.iter().map(ends)).collect();
        Table::wide(&[["w/L", "u/L"][axis], "elements"], columns, rows)
    }

    /// All small deflections, with all digits.
    fn table(&self) -> Table {
        Table::of(self.tips.iter().map(|tip| {
            [
                ("model", tip.model.name.into()),
                ("elements", tip.model.elements.name(false).into()),
                ("cells_across", tip.across.into()),
                ("young_ratio", tip.material.map(|material| material.young / MATERIAL.young).into()),
                ("poisson", tip.material.map(|material| material.poisson).into()),
                ("over_timoshenko", tip.ratio.into()),
            ]
        }))
    }

    /// All large deflections, with all digits.
    fn elastica_table(&self) -> Table {
        let ends =
            self.bent.iter().flat_map(|one| one.ends.iter().zip(MATTIASSON).map(move |(end, at)| (one, end, at)));
        Table::of(ends.map(|(one, end, (load, printed))| {
            let exact = elastica(load);
            [
                ("model", one.model.name.into()),
                ("elements", one.model.elements.name(false).into()),
                ("load", Cell::Given(load)),
                ("across", end.map(|end| end[0]).into()),
                ("along", end.map(|end| end[1]).into()),
                ("elastica_across", exact[0].into()),
                ("elastica_along", exact[1].into()),
                ("mattiasson_across", printed.map_or(Cell::Empty, |printed| Cell::Given(printed[0]))),
                ("mattiasson_along", printed.map_or(Cell::Empty, |printed| Cell::Given(printed[1]))),
            ]
        }))
    }

    /// The errors of modes and waves.
    fn waves_table(&self) -> Table {
        Table::of(self.waves.iter().map(|wave| {
            [
                ("motion", wave.name.into()),
                ("frequency", wave.formula.into()),
                ("bending", wave.bending.into()),
                ("error", wave.error.into()),
            ]
        }))
    }

    /// The errors of small deflections against the number of cells.
    fn page(&self) -> Page {
        let plot = |poisson: f64, elements: Elements| {
            let shown = Beam::kinds().filter(|kind| kind.0.elements == elements && kind.1 == poisson);
            let point = |tip: &Tip| Some([f64::from(tip.across), (tip.ratio? - 1.0).abs()]);
            Plot {
                name: format!("{}, ν = {poisson}", elements.name(false)),
                axes: ["cells across, N", "error of the deflection"],
                curves: shown.map(|(model, _)| model.curve(self.of(model, poisson).filter_map(point))).collect(),
                slopes: None,
            }
        };
        let plots = [POISSON[0], POISSON[2]].map(|poisson| Elements::ALL.map(|elements| plot(poisson, elements)));
        Page {
            title: "The end of a cantilever: error against cells across".to_owned(),
            caption: vec![format!(
                "The deflection under a small load, beside Timoshenko's; the bar is {SLENDERNESS} times as long as deep."
            )],
            contents: Contents::Plots(plots.into_iter().flatten().collect()),
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/beam.rs"]
mod tests;
