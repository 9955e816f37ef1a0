//! Cantilevers of few cells: how much stiffer than Timoshenko's beam each model is, also if it is nearly incompressible, and how near to the
//! elastica under large loads; free modes and waves of the shape model beside their closed forms.

use super::balance::Forces;
use super::bar::Bar;
use super::theory::{elastica, timoshenko};
use super::{Elements, MENDED, MODELS, Model, decimals};
use crate::folder::Notes;
use crate::progress::Watch;
use crate::study::{Findings, Study};
use crate::table::{Cell, Table};
use glam::DVec3;
use localshape::sim::Material;
use rayon::prelude::*;
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
    fn name(&self) -> &'static str {
        "beam"
    }

    fn work(&self) -> u64 {
        (Self::kinds().count() * self.across.len() + self.bent.len()) as u64 + 1
    }

    fn measure(&self, watch: &Watch<'_>, _: &Notes) -> Option<Findings> {
        let results = measure(self, watch)?;
        Some(Findings {
            #[cfg(feature = "render")]
            pages: vec![("beam", results.page())],
            ..Findings::new(
                results.text(),
                [
                    ("beam", results.table()),
                    ("beam-elastica", results.elastica_table()),
                    ("beam-waves", results.waves_table()),
                ],
            )
        })
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
    let tips = bars.par_iter().map(|&((model, poisson), across)| {
        let one = watch(0).then(|| tip(model, poisson, across));
        one.filter(|_| watch(1))
    });
    let tips = tips.collect::<Option<_>>()?;
    let bent = study.bent.par_iter();
    let bent = bent.map(|model| watch(0).then(|| bend(model, study.along)).filter(|_| watch(1)));
    let bent = bent.collect::<Option<_>>()?;
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
        let found = bar.bent(model.as_ref(), load, bar.body.rest())?;
        Some(bar.tip(&found).x / timoshenko(*material, bar.length, bar.section, load))
    });
    Tip { model: *model, poisson, across, material: made.map(|(_, material)| material), ratio }
}

fn bend(model: &Model, along: u32) -> Bent {
    /// The load grows by at most this (`P L²/EI`), and each balance starts from the one before.
    const MOST: f64 = 2.5;
    let bar = Bar::new(model.elements, [THICK, THICK, along], SIDE, 1.0);
    let Some((made, material)) = bar.model(model, MATERIAL) else {
        return Bent { model: *model, ends: vec![None; MATTIASSON.len()] };
    };
    let (mut position, mut before) = (Some(bar.body.rest().to_vec()), 0.0);
    let end = |&(load, _): &(f64, Option<[f64; 2]>)| {
        let parts = libm::ceil((load - before) / MOST) as u32;
        for part in 1..=parts {
            let load = before + (load - before) * f64::from(part) / f64::from(parts);
            let load = load * bar.rigidity(material) / (bar.length * bar.length);
            position = position.as_ref().and_then(|start| bar.bent(made.as_ref(), load, start));
        }
        before = load;
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
    let (forces, bar) = forces(model, [1, 1, cells]);
    let bottom = -0.5 * bar.length;
    let error = |mode: u32| {
        let phase = f64::from(mode) * PI / f64::from(cells + 1);
        let sine = libm::sin(0.5 * phase);
        let shape = |rest: &DVec3| DVec3::Z * libm::cos(phase * (libm::round((rest.z - bottom) / SIDE) + 0.5));
        (shape_of(&bar, shape), 2.0 * STIFFNESS * sine * sine)
    };
    off(forces, &bar, (1..=cells).map(error), 1e-3 * SIDE, |_| true)
}

/// The greatest relative error of plane waves along z.
fn plane_waves(model: &Model, along: DVec3, share: f64) -> f64 {
    let (forces, bar) = forces(model, [2, 2, 9]);
    let wave = |phase: f64| {
        let sine = libm::sin(0.5 * phase);
        (shape_of(&bar, |rest| along * libm::cos(phase * (rest.z / SIDE) + 0.3)), share * STIFFNESS * sine * sine)
    };
    let is_inside = |rest: &DVec3| rest.z.abs() < 0.5 * bar.length - 0.5 * SIDE && rest.x.abs() < 0.5 * SIDE;
    let is_inside = |rest: &DVec3| is_inside(rest) && (rest.y - SIDE).abs() < 0.5 * SIDE;
    off(forces, &bar, [0.1, 1.0, 2.0, PI].into_iter().map(wave), 1e-3 * SIDE, is_inside)
}

/// `k = E a/2` (N/m).
const STIFFNESS: f64 = 0.5 * MATERIAL.young * SIDE;

fn forces(model: &Model, cells: [u32; 3]) -> (Forces, Bar) {
    let bar = Bar::new(Elements::Cells, cells, SIDE, 1.0);
    let made = model.on(&bar.body, MATERIAL, SIDE).expect("a lattice of cubes");
    (Forces::new(&bar.body, made.as_ref(), bar.body.rest()), bar)
}

fn shape_of(bar: &Bar, shape: impl Fn(&DVec3) -> DVec3) -> Vec<DVec3> {
    bar.body.rest().iter().map(shape).collect()
}

/// The greatest deviation of the forces of shapes from `−m ω²` times them, with `m ω²` (N/m) for each, relative to it.
fn off(
    mut forces: Forces,
    bar: &Bar,
    shapes: impl Iterator<Item = (Vec<DVec3>, f64)>,
    amplitude: f64,
    counts: impl Fn(&DVec3) -> bool,
) -> f64 {
    let of_shape = |(shape, expected): (Vec<DVec3>, f64)| {
        let found = forces.linear(&bar.body, &shape, amplitude);
        let nodes = found.iter().zip(&shape).zip(bar.body.rest()).filter(|(_, rest)| counts(rest));
        nodes.map(|((&force, &shape), _)| (force + shape * expected).length() / expected).fold(0.0, f64::max)
    };
    shapes.map(of_shape).fold(0.0, f64::max)
}

/// A number of a material, with its name.
type Modulus = (&'static str, fn(Material) -> f64);

impl Results {
    /// The results as text.
    fn text(&self) -> String {
        let mut text = format!(
            "# Beams\n\n\
            ## Small deflections\n\n\
            The deflection of the end of a cantilever over that of Timoshenko's theory: the bar is N cells deep and one wide, {SLENDERNESS} \
            times as long as deep, and has a small load on its end (ν = 0). A number below 1 means that the bar is too stiff. The rows in \
            italics are `1/(1 + (3β − 1)/N²)`, which the shape model follows with its factor β of bending. Finite elements of hexahedra \
            follow it with β = 1/2, and the metric at their corners with β = 3/2. Of the five tetrahedra of a cell only the one in the \
            middle is regular; the others are no isotropic material to the shape model, so that its bars of tetrahedra converge to another \
            modulus.\n\n",
        );
        text += &self.tips_table(0.0).markdown(2);
        text += "\nSprings are no material. Their moduli are those that one measures by pulling the same bar; `E` is relative to `k/a`. \
            Neither is free: both depend on the arrangement of the springs and on the cells across, because springs on the surface have \
            no neighbours to share with. So do the deflections, which the theory of a uniform material does not describe.\n\n";
        text += &self.springs_table().markdown(2);
        text += "\n`xpbd` has the energy of `shape-based`, and bends like it in small steps; [another page](beam-time.md#steps-of-xpbd) measures \
            what longer ones change.\n\
            \n## Nearly incompressible bars\n\n\
            The same for other Poisson's ratios. The clamp lets no section contract, which the theory leaves out and makes bars stiffer by up to \
            about a percent.\n";
        for &poisson in &POISSON[1..] {
            text += &format!("\nν = {poisson}:\n\n{}", self.tips_table(poisson).markdown(2));
        }
        let lacks = |kind: &str| {
            let of_cells = MODELS.iter().find(|model| model.name == kind);
            let finest = of_cells.and_then(|model| self.of(model, POISSON[2]).last()?.ratio);
            finest.map_or_else(|| "an unknown part".to_owned(), |ratio| format!("{:.0} %", 100.0 * (1.0 - ratio)))
        };
        text += &format!(
            "\nAt ν = {} finite elements lock: a cell that bends cannot contract on one side alone, and resists the change of volume at each point \
            of its integration, at its corners most. With the most cells hexahedra still lack {} of the deflection, and `metric` lacks {}. \
            The shape model resists the change of the volume of a whole cell, which bending leaves as it is, and lacks {}. That is why a \
            bar of one cell has β alone to bend with, and β = 1/3 is too soft by 1 + ν there; from two cells on it is right.\n",
            POISSON[2],
            lacks("linear"),
            lacks("metric"),
            lacks("shape-based"),
        );
        text += &format!(
            "\n## Large deflections\n\n\
            A bar of {THICK}×{THICK}×{} cells under a load `P` that keeps its direction: the displacement of its end across over its length, \
            and along in the second table. The elastica is integrated here; the row below has the numbers that Mattiasson printed in 1981. \
            Springs have the `E` that one measures by pulling the bar.\n",
            self.study.along
        );
        for axis in [0, 1] {
            text += &format!("\n{}", self.bent_table(axis).markdown(2));
        }
        let worst = |model: &Bent| {
            let errors = model.ends.iter().zip(MATTIASSON).flat_map(|(end, (load, _))| {
                let exact = elastica(load);
                [0, 1].map(|axis| end.map_or(f64::NAN, |end| (end[axis] / exact[axis] - 1.0).abs()))
            });
            errors.fold(0.0, |most: f64, error| if error <= most { most } else { error })
        };
        if let Some(mended) = self.bent.iter().find(|one| one.model.name == MENDED) {
            text += &format!("\n`{MENDED}` is within {:.1} % of the elastica.\n", 100.0 * worst(mended));
        }
        text += "\n## Modes and waves\n\n\
            Frequencies of the shape model from its forces, beside their closed forms: `m` is the mass of a node, `a` the side of a cube, \
            `q` the wave number along an axis. The error is the greatest of all modes of columns of 1, 2, 5 and 8 cubes, and of waves with \
            `qa` from 0.1 to π.\n\n";
        let row = |wave: &Wave| {
            [
                ("motion", wave.name.into()),
                ("frequency", format!("`{}`", wave.formula).into()),
                ("β", wave.bending.into()),
                ("error", format!("{:.0e}", wave.error).into()),
            ]
        };
        text += &Table::of(self.waves.iter().map(row)).markdown(3);
        text
    }

    /// The tips of a model with a Poisson's ratio, one for each number of cells.
    fn of<'a>(&'a self, model: &'a Model, poisson: f64) -> impl Iterator<Item = &'a Tip> {
        self.tips.iter().filter(move |tip| tip.model == *model && tip.poisson == poisson)
    }

    fn tips_table(&self, poisson: f64) -> Table {
        let heads = ["model", "elements"].map(str::to_owned).into_iter();
        let heads = heads.chain(self.study.across.iter().map(|across| format!("N = {across}"))).collect();
        let models = Beam::kinds().filter(|kind| kind.1 == poisson);
        let row = |(model, _): (&Model, f64)| {
            let ratios = self.of(model, poisson).map(|tip| decimals(tip.ratio, 4));
            model.names(false).into_iter().chain(ratios).collect::<Vec<Cell>>()
        };
        let formula = |(name, bending): (&str, f64)| {
            let ratio =
                |&across: &u32| decimals(Some(1.0 / (1.0 + (3.0 * bending - 1.0) / f64::from(across * across))), 4);
            let named: [Cell; 2] = [format!("*{name}*").into(), "".into()];
            named.into_iter().chain(self.study.across.iter().map(ratio)).collect::<Vec<Cell>>()
        };
        let formulas =
            [("formula, β = 1", 1.0), ("formula, β = 1/2", 0.5), ("formula, β = 1/3", 1.0 / 3.0)].map(formula);
        let formulas = formulas.into_iter().filter(|_| poisson == 0.0);
        Table { heads, rows: models.map(row).chain(formulas).collect() }
    }

    fn springs_table(&self) -> Table {
        let heads = ["springs", "modulus"].map(str::to_owned).into_iter();
        let heads = heads.chain(self.study.across.iter().map(|across| format!("N = {across}"))).collect();
        let springs = MODELS.iter().filter(|model| model.is_springs());
        let row = |(model, (name, of)): (&Model, Modulus)| {
            let named: [Cell; 2] = [format!("`{}`", model.name).into(), name.into()];
            named.into_iter().chain(self.of(model, 0.0).map(|tip| decimals(tip.material.map(of), 4))).collect()
        };
        let moduli: [Modulus; 2] = [("E a/k", |one| 2.0 * one.young / MATERIAL.young), ("ν", |one| one.poisson)];
        let rows = springs.flat_map(|model| moduli.map(|of| (model, of))).map(row).collect();
        Table { heads, rows }
    }

    fn bent_table(&self, axis: usize) -> Table {
        let name = ["w/L", "u/L"][axis];
        let heads = [name.to_owned(), "elements".to_owned()].into_iter();
        let heads = heads.chain(MATTIASSON.map(|(load, _)| format!("P L²/EI = {load}"))).collect();
        let row = |name: String, elements: &str, numbers: Vec<Option<f64>>| -> Vec<Cell> {
            let named: [Cell; 2] = [name.into(), elements.into()];
            named.into_iter().chain(numbers.into_iter().map(|number| decimals(number, 5))).collect()
        };
        let exact = MATTIASSON.iter().map(|&(load, _)| Some(elastica(load)[axis])).collect();
        let printed = MATTIASSON.iter().map(|&(_, printed)| printed.map(|printed| printed[axis])).collect();
        let theory = [row("*elastica*".into(), "", exact), row("*Mattiasson 1981*".into(), "", printed)];
        let models = self.bent.iter().map(|one| {
            let ends = one.ends.iter().map(|end| end.map(|end| end[axis])).collect();
            row(format!("`{}`", one.model.name), one.model.elements.name(false), ends)
        });
        Table { heads, rows: theory.into_iter().chain(models).collect() }
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
    #[cfg(feature = "render")]
    fn page(&self) -> crate::page::Page {
        use crate::page::{Contents, Line, Page, Plot};
        let plot = |poisson: f64, elements: Elements| {
            let shown = Beam::kinds().filter(|kind| kind.0.elements == elements && kind.1 == poisson);
            let line = |(model, _): (&Model, f64)| Line {
                name: model.name.to_owned(),
                family: model.family(),
                is_strong: model.name == MENDED,
                points: self
                    .of(model, poisson)
                    .filter_map(|tip| Some([f64::from(tip.across), (tip.ratio? - 1.0).abs()]))
                    .collect(),
            };
            Plot {
                name: format!("{}, ν = {poisson}", elements.name(false)),
                axes: ["cells across, N".to_owned(), "error of the deflection".to_owned()],
                curves: super::joined(shown.map(line)),
                slopes: None,
            }
        };
        Page {
            title: "The end of a cantilever: error against cells across".to_owned(),
            caption: vec![format!(
                "The deflection under a small load, beside Timoshenko's; the bar is {SLENDERNESS} times as long as deep."
            )],
            columns: 2,
            contents: Contents::Plots(
                [POISSON[0], POISSON[2]]
                    .iter()
                    .flat_map(|&poisson| Elements::ALL.map(|elements| plot(poisson, elements)))
                    .collect(),
            ),
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/beam.rs"]
mod tests;
