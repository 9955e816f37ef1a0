//! The body and its initial state.

use super::lists::{Lists, check_count, check_exclusive};
use super::mesh::Made as MadeMesh;
use super::motion::axis;
use super::{Beside, Place, direction, elements, mass, mesh, vector};
use crate::reading::captions::typed;
use crate::reading::collector::{Collector, PathPart, key_path, written};
use crate::reading::words::quoted;
use crate::scene::file::{BodyFile, Cells, Coordinates, FillKind, Lattice, SideFile, StartShape};
use crate::scene::generate::{Generator, Made, brought_to_start};
use crate::scene::limits::BodySize;
use crate::sim::geometry::relative_stiffness;
use crate::sim::{Body, Carried, Dimension, IndexLists, Solids, State};
use glam::DVec3;
use localshape_mesh::{Cage, Filled, Group};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A body, its initial state, and the other settings of its table.
#[derive(Debug)]
pub(super) struct ResolvedBody {
    /// Empty if it has none.
    pub(super) name: String,
    pub(super) body: Arc<Body>,
    /// The initial state.
    pub(super) initial: State,
    /// Springs listed by hand.
    pub(super) springs: Option<Vec<[u32; 2]>>,
    /// Mean length of the elements' edges (m).
    pub(super) side: f64,
    /// Whether this length is the side of a lattice's cells.
    pub(super) has_cells: bool,
    /// Sets of nodes with a name.
    pub(super) groups: Vec<Group>,
}

impl ResolvedBody {
    /// The body in messages.
    pub(super) fn in_words(&self) -> String {
        in_words(&self.name)
    }
}

/// A body with this name in messages.
pub(super) fn in_words(name: &str) -> String {
    if name.is_empty() { "the body".to_owned() } else { format!("the body {}", quoted(name)) }
}

/// A body as typed, with the lists of its own file.
#[derive(Debug)]
pub(super) struct TypedBody<'a> {
    file: &'a BodyFile,
    place: Place,
    content: Content<'a>,
    /// Whether keys were left out because of mistakes, or lists have some.
    flawed: bool,
}

/// The nodes and elements of a body before it is made.
#[derive(Debug)]
enum Content<'a> {
    Generated(Generator<'a>),
    Listed(Box<Lists>, Vec<Group>),
    /// A surface with the elements that fill it, and the length of their edges (m).
    Filled(Box<Filled>, f64),
}

impl<'a> TypedBody<'a> {
    /// The body of a table; `None` if it has no nodes and elements. Points with another number of coordinates are
    /// reported. `flawed` tells whether keys were left out because of mistakes. `beside` is the content of the body's
    /// file. A surface is filled with at most so many elements.
    pub(super) fn new(
        file: &'a BodyFile,
        beside: Option<Beside>,
        place: Place,
        flawed: bool,
        most: u64,
        report: &mut Collector<'_>,
    ) -> Option<Self> {
        let before = report.total();
        let content = match Generator::of(file) {
            Some(generator) => Content::Generated(generator),
            None if file.file.is_some() || file.mesh.is_some() => match beside? {
                Beside::Lists(lists) => Content::Listed(lists, Vec::new()),
                Beside::Mesh(read) => match mesh::make(read, file, &place, flawed, most, report)? {
                    MadeMesh::Cells(lists, groups) => Content::Listed(lists, groups),
                    MadeMesh::Filled(filled, side) => Content::Filled(filled, side),
                },
            },
            None => Content::Listed(Box::new(Lists::typed(file, &place, report)?), Vec::new()),
        };
        Some(Self { file, place, content, flawed: flawed || report.total() > before })
    }

    /// Whether the body is in the plane or in space, by the first coordinates given.
    pub(super) fn dimension(&self) -> Dimension {
        match &self.content {
            Content::Generated(generator) => generator.dimension(),
            Content::Listed(lists, _) => lists.dimension,
            Content::Filled(..) => Dimension::Space,
        }
    }

    /// The number of elements that fill a surface.
    pub(super) fn filled(&self) -> u64 {
        if let Content::Filled(filled, _) = &self.content { filled.cage.elements.len() as u64 } else { 0 }
    }

    /// Its size before it is made.
    pub(super) fn size(&self) -> BodySize {
        match &self.content {
            Content::Generated(generator) => generator.size(),
            Content::Listed(lists, _) => {
                let springs = lists.springs.as_ref().map(|springs| springs.len() as u128);
                BodySize { springs, ..size_of(&lists.nodes, &lists.elements) }
            }
            Content::Filled(filled, _) => size_of(&filled.cage.nodes, &filled.cage.elements),
        }
    }

    /// How to make it smaller.
    pub(super) fn less(&self) -> &'static str {
        match self.content {
            Content::Generated(Generator::Lattice(_)) => "use fewer cells",
            Content::Generated(Generator::Polygon(_) | Generator::Fan(_)) => "use fewer sides",
            Content::Generated(Generator::Disc(_)) => "use fewer rings or sectors",
            Content::Generated(Generator::Bars(_)) => "use fewer bars",
            Content::Listed(..) => "use fewer nodes",
            Content::Filled(..) => "fill it with fewer `cells`, or a larger `side`",
        }
    }

    /// Reports that it is too large.
    pub(super) fn too_large(&self, message: String, help: String, report: &mut Collector<'_>) {
        let at = |keys: &[&'static str]| {
            self.place.iter().copied().chain(keys.iter().map(|&key| PathPart::Key(key))).collect::<Vec<_>>()
        };
        let path = match &self.content {
            Content::Generated(Generator::Lattice(_)) => at(&["lattice", "cells"]),
            Content::Generated(Generator::Polygon(_)) => at(&["polygon", "sides"]),
            Content::Generated(Generator::Fan(_)) => at(&["fan", "sides"]),
            Content::Generated(Generator::Disc(_)) => at(&["disc"]),
            Content::Generated(Generator::Bars(_)) => at(&["bars", "count"]),
            Content::Filled(..) => at(&["fill"]),
            Content::Listed(lists, _) => match &lists.source.file {
                Some((name, place)) => return report.at(place, format!("`{name}`: {message}"), help),
                None => return report.at_key(&at(&["nodes"]), message, help),
            },
        };
        report.at(&path, message, help);
    }

    /// Reports mistakes in settings of a body that is too large to be made.
    pub(super) fn check(&self, report: &mut Collector<'_>) {
        if let Content::Generated(generator) = self.content {
            check_generator(generator, &self.place, report);
            check_start(self.file, &self.place, generator.dimension(), report);
        }
    }

    /// The body, or `None` after reporting every mistake in it.
    pub(super) fn resolve(self, report: &mut Collector<'_>) -> Option<ResolvedBody> {
        let Self { file, place, content, flawed } = self;
        match content {
            Content::Generated(generator) => generated(file, generator, &place, report),
            Content::Listed(lists, groups) => Some(ResolvedBody { groups, ..listed(file, *lists, flawed, report)? }),
            Content::Filled(of, side) => filled(file, *of, side, &place, report),
        }
    }
}

/// A generated body.
fn generated(
    file: &BodyFile,
    generator: Generator<'_>,
    place: &Place,
    report: &mut Collector<'_>,
) -> Option<ResolvedBody> {
    let before = report.total();
    let dimension = generator.dimension();
    let along = check_generator(generator, place, report);
    let Made { nodes: rest, elements } = generator.make(along?);
    let count = rest.len();
    let mut body = Body::new(dimension, rest, vec![1.0; count], elements, solids(file), None);
    let mass = mass::resolve(file, &body, None, place, report);
    let initial = start(file, place, body.rest.clone(), None, dimension, report);
    if report.total() > before {
        return None;
    }
    body.mass = mass?;
    let body = Arc::new(body);
    let of_cells = generator.side();
    let side = of_cells.unwrap_or_else(|| elements::mean_edge(&body));
    let name = file.name.clone().unwrap_or_default();
    let has_cells = of_cells.is_some();
    Some(ResolvedBody { name, body, initial, springs: None, side, has_cells, groups: Vec::new() })
}

/// A surface with the elements that fill it, whose edges have a length (m).
fn filled(file: &BodyFile, of: Filled, side: f64, place: &Place, report: &mut Collector<'_>) -> Option<ResolvedBody> {
    let before = report.total();
    let Filled { cage: Cage { nodes, elements, filled, convex, groups, volumes, overlap }, surface, weights, .. } = of;
    let solids = if convex { Solids::Convex } else { Solids::Ordered };
    let measures = surface.measures();
    let count = nodes.len();
    let mut body = Body::new(Dimension::Space, nodes, vec![1.0; count], elements, solids, None);
    body.fill = filled;
    // Cubes are all alike.
    let is_alike = file.fill.as_ref().is_none_or(|fill| fill.with == FillKind::Cubes);
    body.stiffness = (!is_alike).then(|| relative_stiffness(&body, side));
    body.carried = Some(Arc::new(Carried { rest: surface.points, triangles: surface.triangles, weights }));
    let mass = mass::resolve(file, &body, volumes, place, report);
    let initial = start(file, place, body.rest.clone(), None, Dimension::Space, report);
    if report.total() > before {
        return None;
    }
    body.mass = mass?;
    if let Some(density) = file.density
        && measures.closed
    {
        // Tetrahedra and polyhedra fill it a little more or less, but its mass is that of its own volume, where shells count once.
        let found: f64 = body.mass.iter().sum();
        body.mass.iter_mut().for_each(|mass| *mass *= density * (measures.volume - overlap) / found);
    }
    let name = file.name.clone().unwrap_or_default();
    let body = Arc::new(body);
    Some(ResolvedBody { name, body, initial, springs: None, side, has_cells: false, groups })
}

/// The size of a body with these nodes and elements.
fn size_of(nodes: &[DVec3], elements: &IndexLists) -> BodySize {
    let mut counts = BTreeMap::new();
    elements.iter().for_each(|list| *counts.entry(list.len()).or_default() += 1);
    BodySize::new(nodes.len() as u128, counts)
}

/// Checks of a generator that the schema cannot express. Returns the direction of bars; that of other generators has no
/// meaning.
fn check_generator(generator: Generator<'_>, place: &Place, report: &mut Collector<'_>) -> Option<DVec3> {
    let at = |key, inner| key_path![place; key, inner];
    match generator {
        Generator::Lattice(Lattice { cells, side, elements, .. }) => {
            let axes = cells.len();
            let wrong = match elements {
                Cells::Triangles if axes == 3 => Some(("triangles", "in space", "tetrahedra")),
                Cells::Tetrahedra if axes == 2 => Some(("tetrahedra", "in the plane", "triangles")),
                _ => None,
            };
            if let Some((typed, place, other)) = wrong {
                let ([typed, other], path) = ([typed, other].map(quoted), at("lattice", "elements"));
                let message =
                    format!("`{}` is {typed}, but the lattice is {place}: it has {axes} `cells`", written(&path));
                report.at(&path, message, format!("use {other}, or other `cells`"));
            }
            let sides = match side {
                SideFile::PerAxis(sides) => sides.len(),
                SideFile::Equal(_) => axes,
            };
            if sides != axes {
                let path = at("lattice", "side");
                let message = format!(
                    "`{}` has {sides} entries, and `cells` has {axes}; expected one for each axis",
                    written(&path)
                );
                report.at(&path, message, "or one number for all");
            }
            (wrong.is_none() && sides == axes).then_some(DVec3::X)
        }
        Generator::Bars(bars) => {
            let path = at("bars", "direction");
            let along = vector(&bars.direction, generator.dimension(), &path, report)?;
            direction(along, &path, report)
        }
        Generator::Polygon(_) | Generator::Fan(_) | Generator::Disc(_) => Some(DVec3::X),
    }
}

/// A body of listed nodes and elements.
fn listed(file: &BodyFile, lists: Lists, flawed: bool, report: &mut Collector<'_>) -> Option<ResolvedBody> {
    let before = report.total();
    let place = lists.source.body.clone();
    let solids = if file.convex { Solids::Convex } else { lists.solids };
    let dimension = lists.dimension;
    elements::check(&lists, solids, flawed, report);
    let count = lists.nodes.len();
    for (key, length) in [
        ("masses", lists.masses.as_ref().map(Vec::len)),
        ("positions", lists.positions.as_ref().map(Vec::len)),
        ("velocities", lists.velocities.as_ref().map(Vec::len)),
    ] {
        length.into_iter().for_each(|length| check_count(&lists.source, key, length, count, report));
    }
    if file.file.is_some() {
        for (key, typed) in [("mass", file.mass), ("density", file.density), ("mass_total", file.mass_total)] {
            check_exclusive(&lists, lists.masses.is_some() && typed.is_some(), key, "masses", report);
        }
        let both = lists.velocities.is_some() && file.velocity.is_some();
        check_exclusive(&lists, both, "velocity", "velocities", report);
        check_exclusive(&lists, lists.positions.is_some() && file.start.is_some(), "start", "positions", report);
    }
    let Lists { nodes: rest, elements, springs, faces, positions, velocities, masses, .. } = lists;
    let initial = start(file, &place, positions.unwrap_or_else(|| rest.clone()), velocities, dimension, report);
    if flawed || report.total() > before || elements.is_empty() {
        return None;
    }
    let is_listed = masses.is_some();
    let mass = masses.unwrap_or_else(|| vec![1.0; count]);
    let mut body = Body::new(dimension, rest, mass, elements, solids, faces.as_ref());
    if !is_listed {
        body.mass = mass::resolve(file, &body, None, &place, report)?;
    }
    let body = Arc::new(body);
    let side = elements::mean_edge(&body);
    let name = file.name.clone().unwrap_or_default();
    Some(ResolvedBody { name, body, initial, springs, side, has_cells: false, groups: Vec::new() })
}

/// The body of a recording, called like its run, with its state at the start.
pub(super) fn recorded(lists: Lists, name: String, start: State, report: &mut Collector<'_>) -> Option<ResolvedBody> {
    let made = listed(&BodyFile::default(), lists, false, report)?;
    Some(ResolvedBody { name, initial: start, ..made })
}

/// The interpretation of elements with four, five, six and eight nodes.
fn solids(file: &BodyFile) -> Solids {
    if file.convex { Solids::Convex } else { Solids::Ordered }
}

/// The initial positions and velocities of the body, from its listed positions (m) and velocities (m/s), if any.
fn start(
    file: &BodyFile,
    place: &Place,
    mut position: Vec<DVec3>,
    velocities: Option<Vec<DVec3>>,
    dimension: Dimension,
    report: &mut Collector<'_>,
) -> State {
    let (shape, turn, spin, offset, velocity) = check_start(file, place, dimension, report);
    if let Some((shape, direction, seed)) = shape {
        brought_to_start(&mut position, shape, direction, seed, dimension);
    }
    let mut velocity = velocities.unwrap_or_else(|| vec![velocity; position.len()]);
    if let Some((axis, angle)) = turn {
        let centre = position.iter().sum::<DVec3>() / position.len() as f64;
        position.iter_mut().for_each(|point| *point = centre + turned(*point - centre, axis, angle));
    }
    position.iter_mut().for_each(|point| *point += offset);
    if let Some(spin) = spin {
        let centre = position.iter().sum::<DVec3>() / position.len() as f64;
        velocity.iter_mut().zip(&position).for_each(|(velocity, &point)| *velocity += spin.cross(point - centre));
    }
    if let Some(height) = file.lowest {
        let lowest = position.iter().fold(f64::INFINITY, |lowest, point| lowest.min(point.y));
        // In this order the lowest node is exactly at the height that was typed.
        position.iter_mut().for_each(|point| point.y = height + (point.y - lowest));
    }
    State::new(position, velocity)
}

/// The start shape (with a unit direction and a seed), the rotation (unit axis, angle), the spin (rad/s), the
/// translation and the velocity. Settings with mistakes are reported and left out.
#[expect(clippy::type_complexity, reason = "the list of all settings of a start")]
fn check_start(
    file: &BodyFile,
    place: &Place,
    dimension: Dimension,
    report: &mut Collector<'_>,
) -> (Option<(StartShape, DVec3, u32)>, Option<(DVec3, f64)>, Option<DVec3>, DVec3, DVec3) {
    let shape = file.start.as_ref().and_then(|typed| {
        check_use(typed.shape, place, report);
        let path = key_path![place; "start", "direction"];
        let along = match &typed.direction {
            // Reported above.
            Some(_) if !typed.shape.has_direction() => DVec3::X,
            Some(along) => direction(vector(along, dimension, &path, report)?, &path, report)?,
            None => DVec3::X,
        };
        Some((typed.shape, along, typed.seed))
    });
    let turn = file.rotation.as_ref().and_then(|typed| {
        let path = key_path![place; "rotation"];
        Some((axis(typed.axis.as_ref(), dimension, &path, report)?, typed.angle))
    });
    let spin = file.spin.as_ref().and_then(|typed| {
        let path = key_path![place; "spin"];
        Some(axis(typed.axis.as_ref(), dimension, &path, report)? * typed.rate)
    });
    let mut optional = |typed: &Option<Coordinates>, key| match typed {
        Some(typed) => vector(typed, dimension, &key_path![place; key], report).unwrap_or_default(),
        None => DVec3::ZERO,
    };
    (shape, turn, spin, optional(&file.offset, "offset"), optional(&file.velocity, "velocity"))
}

/// Reports keys of a start that do not belong to its shape.
fn check_use(shape: StartShape, place: &Place, report: &mut Collector<'_>) {
    let about = [
        ("direction", shape.has_direction(), "lines, planes and mirror images"),
        ("seed", shape.is_random(), "clouds"),
    ];
    for (key, used, about) in about {
        let path = key_path![place; "start", key];
        if !used && report.is_typed(&path) {
            let message = format!("`{}` is about {about}, but the shape is {}", written(&path), quoted(&typed(&shape)));
            report.at_key(&path, message, "remove it, or use another shape");
        }
    }
}

/// A vector rotated about a unit axis (Rodrigues' formula), with the same bits on every machine.
fn turned(v: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let (sine, cosine) = libm::sincos(angle);
    v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_y_takes_z_to_x() {
        let turned = turned(DVec3::new(0.0, 2.0, 1.0), DVec3::Y, std::f64::consts::FRAC_PI_2);
        assert!(turned.distance(DVec3::new(1.0, 2.0, 0.0)) < 1e-15, "{turned}");
    }
}
