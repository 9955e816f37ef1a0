//! The models as materials: bars, irregular blocks and a membrane in balance under loads, beside closed forms and the literature.
//!
//! A model is named as in a scene, with the elements that it takes, and gets the same material as all others. Balances are those of the
//! simulation, so that any model with a potential can join with one line in [`MODELS`].

mod balance;
mod bar;
mod beam;
mod cook;
mod patch;
mod rod;
mod theory;
mod time;

pub(crate) use balance::{Parts, hold, rest_of};
pub(crate) use bar::Bar;
pub(crate) use beam::Beam;
pub(crate) use cook::Cook;
pub(crate) use patch::Patch;
pub(crate) use rod::{Rod, SQUARE};
pub(crate) use time::Time;

use crate::models::{self, Alike};
use crate::page::Line;
use crate::table::{Cell, or_dash};
use glam::DVec3;
use localshape::scene::Cells;
use localshape::sim::model::{ElasticModel, shape_based};
use localshape::sim::{Body, Material};
use localshape::{BodyBuilder, Lattice, Limits, Scene};
use std::sync::Arc;

/// A model by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Model {
    /// Its name in tables, without its elements.
    pub(crate) name: &'static str,
    /// As in a scene.
    pub(crate) kind: &'static str,
    /// A further key and its value.
    pub(crate) more: Option<[&'static str; 2]>,
    pub(crate) elements: Elements,
}

/// Elements of a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Elements {
    /// Hexahedra, in the plane quadrilaterals.
    Cells,
    /// Tetrahedra, in the plane triangles.
    Simplices,
}

/// The models with forces, which have a balance; the paper's first.
pub(crate) static MODELS: [Model; 15] = [
    of_cells("shape-based"),
    of_cells("shape-based").with("shape-based, bending 1/2", ["bending", "1/2"]),
    of_cells("shape-based").with(MENDED, ["bending", "1/3"]),
    of_cells("linear"),
    of_cells("corotational"),
    of_cells("neo-hookean"),
    of_cells("metric"),
    of_cells("mass-spring"),
    of_cells("mass-spring").with("mass-spring, all", ["springs", "all"]),
    of_cells("limited-springs"),
    of_cells("volume-springs"),
    of_simplices("shape-based"),
    of_simplices("linear"),
    of_simplices("corotational"),
    of_simplices("neo-hookean"),
];

/// The model that steps itself, with the energy of the shape model.
pub(crate) static STEPPING: [Model; 2] = [of_cells("xpbd"), of_simplices("xpbd")];

/// The shape model that bends like its material.
const MENDED: &str = "shape-based, bending 1/3";

/// A model by its kind alone, for hexahedra.
pub(crate) const fn of_cells(kind: &'static str) -> Model {
    Model { name: kind, kind, more: None, elements: Elements::Cells }
}

const fn of_simplices(kind: &'static str) -> Model {
    Model { elements: Elements::Simplices, ..of_cells(kind) }
}

impl Model {
    /// The same model with another name and a further key.
    pub(crate) const fn with(self, name: &'static str, more: [&'static str; 2]) -> Self {
        Self { name, more: Some(more), ..self }
    }

    /// A row of a table: its name and its elements, then other cells.
    pub(crate) fn row(&self, is_flat: bool, cells: impl IntoIterator<Item = Cell>) -> Vec<Cell> {
        let names: [Cell; 2] = [format!("`{}`", self.name).into(), self.elements.name(is_flat).into()];
        names.into_iter().chain(cells).collect()
    }

    /// A curve of a plot.
    fn curve(&self, points: impl Iterator<Item = [f64; 2]>) -> Line {
        let family = self.kind.to_owned();
        Line { name: self.name.to_owned(), family, is_strong: self.name == MENDED, points: points.collect() }
    }

    /// Whether `E` and `ν` follow from springs and from the body, in place of a material with any of them.
    pub(crate) fn is_springs(&self) -> bool {
        models::is_springs(self.kind)
    }

    /// The model of a material on a body of cells with a side (m). `None` for a model that does not take this body.
    pub(crate) fn on(&self, body: &Body, material: Material, side: f64) -> Option<Arc<dyn ElasticModel>> {
        Alike::material(material, 0.5 * side).model(body, self.kind, 0.0, self.more)
    }
}

impl Elements {
    const ALL: [Self; 2] = [Self::Cells, Self::Simplices];

    /// The name of the elements in space and in the plane.
    pub(crate) fn name(self, is_flat: bool) -> &'static str {
        match (self, is_flat) {
            (Self::Cells, false) => "hexahedra",
            (Self::Cells, true) => "quadrilaterals",
            (Self::Simplices, false) => "tetrahedra",
            (Self::Simplices, true) => "triangles",
        }
    }

    /// A block of cells of a side (m), disturbed as `irregular` in scenes, with a density (kg/m³).
    pub(crate) fn block(self, cells: &[u32], side: f64, (irregular, seed): (f64, u32), density: f64) -> Arc<Body> {
        let elements = match (self, cells.len()) {
            (Self::Cells, _) => Cells::Cells,
            (Self::Simplices, 2) => Cells::Triangles,
            (Self::Simplices, _) => Cells::Tetrahedra,
        };
        let block = Lattice::new(cells.to_vec(), side).elements(elements).irregular(irregular).seed(seed);
        let scene = Scene::builder("block", BodyBuilder::lattice(block).density(density))
            .run("any", shape_based::Parameters::new(1.0))
            .build(&Limits::default())
            .unwrap_or_else(|error| panic!("a block without mistakes: {error}"));
        Arc::clone(&scene.bodies[0].body)
    }
}

/// A body with its nodes at other places, with the same masses.
pub(crate) fn moved(body: &Body, place: impl Fn(DVec3) -> DVec3) -> Arc<Body> {
    let moved = Body::builder(body.rest().iter().copied().map(place).collect()).dimension(body.dimension());
    let moved = moved.elements(body.elements().clone()).masses(body.mass().to_vec()).build();
    Arc::new(moved.expect("a body as before"))
}

/// The mean of the displacements of some nodes (m).
fn mean_shift(body: &Body, position: &[DVec3], nodes: &[usize]) -> DVec3 {
    nodes.iter().map(|&node| position[node] - body.rest()[node]).sum::<DVec3>() / nodes.len() as f64
}

/// A number with some decimals, or a dash. What is rounded to zero has no sign.
pub(crate) fn decimals(number: Option<f64>, decimals: usize) -> Cell {
    let text = |number: f64| {
        let text = format!("{number:.decimals$}");
        if text.trim_start_matches(['-', '0', '.']).is_empty() { text.replace('-', "") } else { text }
    };
    or_dash(number.map(text))
}
