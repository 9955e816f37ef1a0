//! The models as materials: bars, irregular blocks and a membrane in balance under loads, beside closed forms and the literature.
//!
//! A model is named as in a scene, with the elements that it takes, and gets the same material as all others. Balances are found by
//! Newton's method from the forces alone, so that any model can join with one line in [`MODELS`].

mod balance;
mod bar;
mod beam;
mod cook;
mod patch;
mod theory;
mod time;

pub(crate) use beam::Beam;
pub(crate) use cook::Cook;
pub(crate) use patch::Patch;
pub(crate) use time::Time;

use crate::table::Cell;
use glam::DVec3;
use localshape::scene::Cells;
use localshape::sim::model::{ElasticModel, ModelParameters, shape_based};
use localshape::sim::{Body, Material};
use localshape::{BodyBuilder, Lattice, Limits, Scene};
use serde_json::json;
use std::sync::Arc;

/// A model by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Model {
    /// Its name in tables, without its elements.
    name: &'static str,
    /// As in a scene (JSON), without its material.
    parameters: &'static str,
    /// What it takes in place of a material, if it cannot be one.
    kind: Kind,
    elements: Elements,
    /// The number of its colour in plots.
    family: usize,
}

/// What a model can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A material with any `E` and `ν`.
    Material,
    /// Springs with a stiffness: `E` and `ν` follow from the springs and from the body.
    Springs,
}

/// Elements of a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Elements {
    /// Hexahedra, in the plane quadrilaterals.
    Cells,
    /// Tetrahedra, in the plane triangles.
    Simplices,
}

/// The paper's model first.
pub(crate) static MODELS: [Model; 12] = [
    of_cells("shape-based", r#"{ "kind": "shape-based" }"#, 0),
    of_cells("shape-based, bending 1/2", r#"{ "kind": "shape-based", "bending": "1/2" }"#, 0),
    of_cells(MENDED, r#"{ "kind": "shape-based", "bending": "1/3" }"#, 0),
    of_cells("linear", r#"{ "kind": "linear" }"#, 1),
    of_cells("corotational", r#"{ "kind": "corotational" }"#, 1),
    of_cells("neo-hookean", r#"{ "kind": "neo-hookean" }"#, 1),
    Model { kind: Kind::Springs, ..of_cells("mass-spring", r#"{ "kind": "mass-spring" }"#, 3) },
    Model { kind: Kind::Springs, ..of_cells("mass-spring, all", r#"{ "kind": "mass-spring", "springs": "all" }"#, 3) },
    of_simplices("shape-based", r#"{ "kind": "shape-based" }"#, 0),
    of_simplices("linear", r#"{ "kind": "linear" }"#, 1),
    of_simplices("corotational", r#"{ "kind": "corotational" }"#, 1),
    of_simplices("neo-hookean", r#"{ "kind": "neo-hookean" }"#, 1),
];

/// The shape model that bends like its material.
const MENDED: &str = "shape-based, bending 1/3";

const fn of_cells(name: &'static str, parameters: &'static str, family: usize) -> Model {
    Model { name, parameters, kind: Kind::Material, elements: Elements::Cells, family }
}

const fn of_simplices(name: &'static str, parameters: &'static str, family: usize) -> Model {
    Model { elements: Elements::Simplices, ..of_cells(name, parameters, family) }
}

impl Model {
    /// Its name and its elements, for tables.
    fn names(&self, is_flat: bool) -> [Cell; 2] {
        [format!("`{}`", self.name).into(), self.elements.name(is_flat).into()]
    }

    /// The model of a material on a body; springs take a stiffness of `E` times a length (m) in its place. `None` for a model that does not
    /// take this body.
    fn on(&self, body: &Body, material: Material, length: f64) -> Option<Arc<dyn ElasticModel>> {
        let mut typed: serde_json::Value = serde_json::from_str(self.parameters).expect("a table");
        match self.kind {
            Kind::Material => {
                typed["young"] = json!(material.young);
                if material.poisson != 0.0 {
                    typed["poisson"] = json!(material.poisson);
                }
            }
            Kind::Springs => typed["stiffness"] = json!(material.young * length),
        }
        let parameters: ModelParameters = serde_json::from_value(typed).expect("a model of scenes");
        parameters.resolve(body, None).ok()
    }
}

impl Elements {
    #[cfg(feature = "render")]
    const ALL: [Self; 2] = [Self::Cells, Self::Simplices];

    /// The name of the elements in space and in the plane.
    fn name(self, is_flat: bool) -> &'static str {
        match (self, is_flat) {
            (Self::Cells, false) => "hexahedra",
            (Self::Cells, true) => "quadrilaterals",
            (Self::Simplices, false) => "tetrahedra",
            (Self::Simplices, true) => "triangles",
        }
    }

    /// A block of cells of a side (m), disturbed as `irregular` in scenes, with a density (kg/m³).
    fn block(self, cells: &[u32], side: f64, (irregular, seed): (f64, u32), density: f64) -> Arc<Body> {
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

/// The mean of the displacements of some nodes (m).
fn mean_shift(body: &Body, position: &[DVec3], nodes: &[usize]) -> DVec3 {
    nodes.iter().map(|&node| position[node] - body.rest[node]).sum::<DVec3>() / nodes.len() as f64
}

/// A number with some decimals, or a dash.
fn decimals(number: Option<f64>, decimals: usize) -> Cell {
    number.map_or_else(|| "–".to_owned(), |number| format!("{number:.decimals$}")).into()
}

/// Curves, those that are the same but for a thousandth as one, with all their names.
#[cfg(feature = "render")]
fn joined(curves: impl IntoIterator<Item = crate::page::Line>) -> Vec<crate::page::Line> {
    const ALIKE: f64 = 1e-3;
    let mut all: Vec<crate::page::Line> = Vec::new();
    for curve in curves {
        let is_near = |(one, other): (&[f64; 2], &[f64; 2])| {
            (0..2).all(|axis| (one[axis] - other[axis]).abs() <= ALIKE * other[axis].abs())
        };
        let is_same = |other: &&mut crate::page::Line| {
            other.points.len() == curve.points.len() && curve.points.iter().zip(&other.points).all(is_near)
        };
        match all.iter_mut().find(is_same) {
            Some(same) => same.name += &format!(", {}", curve.name),
            None => all.push(curve),
        }
    }
    for one in &mut all {
        one.name = one.name.replace("linear, corotational, neo-hookean", "finite elements");
    }
    all
}
