//! A body from its table: its nodes and elements, masses and initial state.

use super::lists::Lists;
use super::motion::axis;
use super::table::{BodyTable, Content};
use super::{Typed, direction, elements, mass, mesh, regions, vector};
use crate::reading::captions::typed;
use crate::reading::collector::Here;
use crate::reading::words::quoted;
use crate::scene::SceneBody;
use crate::scene::file::{BodyFile, Cells, Coordinates, FillKind, Lattice, SideFile, StartShape};
use crate::scene::generate::{Generator, Made, brought_to_start};
use crate::scene::limits::BodySize;
use crate::sim::geometry::relative_stiffness;
use crate::sim::{Body, Carried, Dimension, IndexLists, Solids, State};
use glam::DVec3;
use localshape_mesh::{Cage, Filled};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A body whose nodes and elements are known, before it is made.
#[derive(Debug)]
pub(super) struct TypedBody<'a> {
    table: BodyTable<'a>,
    content: Content<'a>,
    /// The key that names its own file, and the digest of its content.
    pub(super) digest: Option<(&'static str, String)>,
}

impl<'a> TypedBody<'a> {
    /// The body at a place of a scene, whose own file is read; `None` if it has no nodes and elements. Mistakes in lists and files are
    /// reported. A surface is filled with at most so many elements.
    pub(super) fn read(scene: &Typed<'a>, at: usize, most: u64) -> Option<Self> {
        let before = scene.report.total();
        let (file, here) = (scene.file.body[at].as_ref()?, scene.place(at));
        let mut table = BodyTable { file, here, flawed: scene.flawed.contains("body") };
        let mut digest = None;
        let content = if let Some(generator) = Generator::of(file) {
            Content::Generated(generator)
        } else if let Some(name) = &file.file {
            let lists = Lists::read(scene.folder, name, table.here.clone(), scene.limits)?;
            digest = Some(("file", lists.digest()));
            Content::Listed(Box::new(lists), Vec::new())
        } else if file.mesh.is_some() {
            let mesh = mesh::read(scene.folder, &table, scene.limits)?;
            digest = Some(("mesh", mesh.digest.clone()));
            mesh::make(mesh, &table, most)?
        } else {
            Content::Listed(Box::new(Lists::typed(file, table.here.clone())?), Vec::new())
        };
        table.flawed |= scene.report.total() > before;
        Some(Self { table, content, digest })
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

    /// The keys that determine its size, and how to make it smaller.
    pub(super) fn sized_by(&self) -> (&'static [&'static str], &'static str) {
        match self.content {
            Content::Generated(Generator::Lattice(_)) => (&["lattice", "cells"], "use fewer cells"),
            Content::Generated(Generator::Polygon(_)) => (&["polygon", "sides"], "use fewer sides"),
            Content::Generated(Generator::Fan(_)) => (&["fan", "sides"], "use fewer sides"),
            Content::Generated(Generator::Disc(_)) => (&["disc"], "use fewer rings or sectors"),
            Content::Generated(Generator::Bars(_)) => (&["bars", "count"], "use fewer bars"),
            Content::Listed(..) => (&["nodes"], "use fewer nodes"),
            Content::Filled(..) => (&["fill"], "fill it with fewer `cells`, or a larger `side`"),
        }
    }

    /// Reports that it is too large.
    pub(super) fn too_large(&self, message: String, help: String) {
        let here = self.sized_by().0.iter().fold(self.table.here.clone(), |here, &key| here.to(key));
        match &self.content {
            Content::Listed(lists, _) => match &lists.source.file {
                Some((name, place)) => place.wrong(format!("`{name}`: {message}"), help),
                None => here.wrong_key(message, help),
            },
            _ => here.wrong(message, help),
        }
    }

    /// Reports mistakes in settings of a body that is too large to be made.
    pub(super) fn check(&self) {
        if let Content::Generated(generator) = self.content {
            check_generator(generator, &self.table);
            check_start(&self.table, generator.dimension());
        }
    }

    /// The body, or `None` after reporting every mistake in it. Its models have these moduli, if they have any.
    pub(super) fn resolve(self, young: &[Option<f64>]) -> Option<SceneBody> {
        let Self { table, content, .. } = self;
        let body = match content {
            Content::Generated(generator) => generated(&table, generator)?,
            Content::Listed(lists, groups) => SceneBody { groups, ..listed(&table, *lists)? },
            Content::Filled(of, side) => filled(&table, *of, side)?,
        };
        regions::apply(&table, body, young)
    }
}

/// A generated body.
fn generated(table: &BodyTable<'_>, generator: Generator<'_>) -> Option<SceneBody> {
    let before = table.here.report.total();
    let dimension = generator.dimension();
    let along = check_generator(generator, table);
    let Made { nodes: rest, elements } = generator.make(along?);
    let solids = table.solids(Solids::Ordered);
    let made = Body::builder(rest).dimension(dimension).elements(elements).solids(solids).build();
    let body = table.sound(made)?;
    let mass = mass::resolve(table, &body, None);
    let initial = start(table, body.rest().to_vec(), None, dimension);
    if table.here.report.total() > before {
        return None;
    }
    let body = table.sound(body.with_masses(mass?))?;
    let side = generator.side();
    Some(SceneBody { has_cells: side.is_some(), ..table.resolved(body, initial, side) })
}

/// A surface with the elements that fill it, whose edges have a length (m).
fn filled(table: &BodyTable<'_>, of: Filled, side: f64) -> Option<SceneBody> {
    let (file, before) = (table.file, table.here.report.total());
    let Filled {
        cage: Cage { nodes, elements, filled, convex, groups, volumes, overlap, .. }, surface, weights, ..
    } = of;
    let solids = if convex { Solids::Convex } else { Solids::Ordered };
    let measures = surface.measures();
    let carried = Arc::new(Carried { rest: surface.points, triangles: surface.triangles, weights });
    let made = Body::builder(nodes).elements(elements).solids(solids).fill(filled).carried(carried).build();
    let mut body = table.sound(made)?;
    // Cubes are all alike.
    if file.fill.as_ref().is_some_and(|fill| fill.with != FillKind::Cubes) {
        let stiffness = relative_stiffness(&body, side);
        body = table.sound(body.with_stiffness(stiffness))?;
    }
    let mass = mass::resolve(table, &body, volumes);
    let initial = start(table, body.rest().to_vec(), None, Dimension::Space);
    if table.here.report.total() > before {
        return None;
    }
    let mut mass = mass?;
    if let Some(density) = file.density
        && measures.closed
    {
        // Tetrahedra and polyhedra fill it a little more or less, but its mass is that of its own volume, where shells count once.
        let found: f64 = mass.iter().sum();
        mass.iter_mut().for_each(|mass| *mass *= density * (measures.volume - overlap) / found);
    }
    let body = table.sound(body.with_masses(mass))?;
    Some(SceneBody { groups, surface_groups: surface.groups, ..table.resolved(body, initial, Some(side)) })
}

/// The size of a body with these nodes and elements.
fn size_of(nodes: &[DVec3], elements: &IndexLists) -> BodySize {
    let mut counts = BTreeMap::new();
    elements.iter().for_each(|list| *counts.entry(list.len()).or_default() += 1);
    BodySize::new(nodes.len() as u128, counts)
}

/// Checks of a generator that the schema cannot express. Returns the direction of bars; that of other generators has no
/// meaning.
fn check_generator(generator: Generator<'_>, table: &BodyTable<'_>) -> Option<DVec3> {
    let at = |key, inner| table.here.to(key).to(inner);
    match generator {
        Generator::Lattice(Lattice { cells, side, elements, .. }) => {
            let axes = cells.len();
            let wrong = match elements {
                Cells::Triangles if axes == 3 => Some(("triangles", "in space", "tetrahedra")),
                Cells::Tetrahedra if axes == 2 => Some(("tetrahedra", "in the plane", "triangles")),
                _ => None,
            };
            if let Some((typed, place, other)) = wrong {
                let ([typed, other], here) = ([typed, other].map(quoted), at("lattice", "elements"));
                let message = format!("`{here}` is {typed}, but the lattice is {place}: it has {axes} `cells`");
                here.wrong(message, format!("use {other}, or other `cells`"));
            }
            let sides = match side {
                SideFile::PerAxis(sides) => sides.len(),
                SideFile::Equal(_) => axes,
            };
            if sides != axes {
                let here = at("lattice", "side");
                let message =
                    format!("`{here}` has {sides} entries, and `cells` has {axes}; expected one for each axis");
                here.wrong(message, "or one number for all");
            }
            (wrong.is_none() && sides == axes).then_some(DVec3::X)
        }
        Generator::Bars(bars) => {
            let here = at("bars", "direction");
            direction(vector(&bars.direction, generator.dimension(), &here)?, &here)
        }
        Generator::Polygon(_) | Generator::Fan(_) | Generator::Disc(_) => Some(DVec3::X),
    }
}

/// A body of listed nodes and elements.
fn listed(table: &BodyTable<'_>, lists: Lists<'_>) -> Option<SceneBody> {
    let (file, before) = (table.file, table.here.report.total());
    let solids = table.solids(lists.solids);
    let dimension = lists.dimension;
    elements::check(&lists, solids, table.flawed);
    let count = lists.nodes.len();
    for (key, length) in [
        ("masses", lists.masses.as_ref().map(Vec::len)),
        ("positions", lists.positions.as_ref().map(Vec::len)),
        ("velocities", lists.velocities.as_ref().map(Vec::len)),
    ] {
        length.into_iter().for_each(|length| lists.source.check_count(key, length, count));
    }
    // Of lists in the scene the schema says it.
    if file.file.is_some() {
        let [masses, positions, velocities] =
            [lists.masses.is_some(), lists.positions.is_some(), lists.velocities.is_some()];
        for (key, typed) in [("mass", file.mass), ("density", file.density), ("mass_total", file.mass_total)] {
            lists.check_exclusive(masses && typed.is_some(), key, "masses");
        }
        lists.check_exclusive(velocities && file.velocity.is_some(), "velocity", "velocities");
        lists.check_exclusive(positions && file.start.is_some(), "start", "positions");
    }
    let Lists { nodes: rest, elements, springs, faces, positions, velocities, masses, .. } = lists;
    let initial = start(table, positions.unwrap_or_else(|| rest.clone()), velocities, dimension);
    if table.flawed || table.here.report.total() > before || elements.is_empty() {
        return None;
    }
    let made = Body::builder(rest).dimension(dimension).elements(elements).solids(solids).faces(faces).build();
    let body = table.sound(made)?;
    let masses = match masses {
        Some(listed) => listed,
        None => mass::resolve(table, &body, None)?,
    };
    let body = table.sound(body.with_masses(masses))?;
    Some(SceneBody { springs, ..table.resolved(body, initial, None) })
}

/// The body of a recording, called like its run, with its state at the start.
pub(super) fn recorded(lists: Lists<'_>, name: String, start: State) -> Option<SceneBody> {
    let table = BodyTable { file: &BodyFile::default(), here: lists.source.body.clone(), flawed: false };
    Some(SceneBody { name, initial: start, ..listed(&table, lists)? })
}

/// The initial positions and velocities of the body, from its listed positions (m) and velocities (m/s), if any.
fn start(
    table: &BodyTable<'_>,
    mut position: Vec<DVec3>,
    velocities: Option<Vec<DVec3>>,
    dimension: Dimension,
) -> State {
    let (shape, turn, spin, offset, velocity) = check_start(table, dimension);
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
    if let Some(height) = table.file.lowest {
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
    table: &BodyTable<'_>,
    dimension: Dimension,
) -> (Option<(StartShape, DVec3, u32)>, Option<(DVec3, f64)>, Option<DVec3>, DVec3, DVec3) {
    let (file, here) = (table.file, &table.here);
    let shape = file.start.as_ref().and_then(|typed| {
        check_use(typed.shape, &here.to("start"));
        let at = here.to("start").to("direction");
        let along = match &typed.direction {
            // Reported above.
            Some(_) if !typed.shape.has_direction() => DVec3::X,
            Some(along) => direction(vector(along, dimension, &at)?, &at)?,
            None => DVec3::X,
        };
        Some((typed.shape, along, typed.seed))
    });
    let turn = file
        .rotation
        .as_ref()
        .and_then(|typed| Some((axis(typed.axis.as_ref(), dimension, &here.to("rotation"))?, typed.angle)));
    let spin =
        file.spin.as_ref().and_then(|typed| Some(axis(typed.axis.as_ref(), dimension, &here.to("spin"))? * typed.rate));
    let optional = |typed: &Option<Coordinates>, key| match typed {
        Some(typed) => vector(typed, dimension, &here.to(key)).unwrap_or_default(),
        None => DVec3::ZERO,
    };
    (shape, turn, spin, optional(&file.offset, "offset"), optional(&file.velocity, "velocity"))
}

/// Reports keys of a start that do not belong to its shape.
fn check_use(shape: StartShape, start: &Here<'_>) {
    let about = [
        ("direction", shape.has_direction(), "lines, planes and mirror images"),
        ("seed", shape == StartShape::Cloud, "clouds"),
    ];
    for (key, used, about) in about {
        let here = start.to(key);
        if !used && here.is_typed() {
            let message = format!("`{here}` is about {about}, but the shape is {}", quoted(&typed(&shape)));
            here.wrong_key(message, "remove it, or use another shape");
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
