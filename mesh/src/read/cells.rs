//! Points and cells as a file lists them, and the mesh that they make.

use super::order::{Parts, along};
use super::polygon::Triangulation;
use super::source::Source;
use super::{Format, Limits, Mesh, ReadError, Surface, Volume};
use crate::Group;
use crate::weld::joined;
use glam::DVec3;
use localshape_sim::{Dimension, ElementKind, IndexLists, Solids};
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// The kind of a cell in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CellKind {
    /// One point, or several that are not joined.
    Point,
    /// A line through its points.
    Line,
    /// A triangle, quadrilateral or polygon.
    Polygon,
    /// A tetrahedron.
    Tetrahedron,
    /// A pyramid on a quadrilateral.
    Pyramid,
    /// A wedge between two triangles.
    Wedge,
    /// A hexahedron.
    Hexahedron,
    /// The convex hull of its corners.
    Polyhedron,
}

impl CellKind {
    /// The kind of elements that such cells become.
    fn element(self) -> Option<ElementKind> {
        Some(match self {
            Self::Point | Self::Line | Self::Polygon => return None,
            Self::Tetrahedron => ElementKind::Tetrahedron,
            Self::Pyramid => ElementKind::Pyramid,
            Self::Wedge => ElementKind::Wedge,
            Self::Hexahedron => ElementKind::Hexahedron,
            Self::Polyhedron => ElementKind::Other,
        })
    }

    pub(super) fn is_solid(self) -> bool {
        self.element().is_some()
    }

    fn is_face(self) -> bool {
        self == Self::Polygon
    }
}

/// Points and cells as a file lists them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// Position of each point, in the unit of the file.
    pub points: Vec<DVec3>,
    /// The kind of each cell.
    pub kinds: Vec<CellKind>,
    /// The points of each cell without those between its corners, in the order of [`Solids::Ordered`].
    pub corners: IndexLists,
    /// Sets of points with a name, in ascending order.
    pub groups: Vec<Group>,
    /// Velocity of each point, in the unit of the file a second: the point data `velocity` of VTK's grids.
    pub velocities: Option<Vec<DVec3>>,
    /// Displacement of each point, in the unit of the file: the point data of VTK's grids named `displacement` or, without a pressure `p`
    /// beside it, `u`, in capital letters or not. They are not added to the points.
    pub displacements: Option<Vec<DVec3>>,
    /// Single points, and the corners of further cells, that are copies of those in other pieces of a parallel run.
    pub copies: IndexLists,
    /// What is left out of the file or not read, each as the predicate of a sentence about it.
    pub notes: Vec<String>,
}

/// What VTK tells of a point or a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Ghost {
    /// It is one of this piece.
    #[default]
    None,
    /// It is a copy of one in another piece.
    Copy,
    /// It is no part of the body.
    Hidden,
}

/// A dimension and the number of a set of points.
type Key = (i64, i64);

/// Cells while they are read.
#[derive(Debug)]
pub(super) struct Builder<'l> {
    pub(super) cells: Cells,
    /// What VTK tells of the first points and cells.
    ghosts: [Vec<Ghost>; 2],
    groups: BTreeMap<String, Vec<u32>>,
    /// Sets of points by their numbers, and the names of some of them.
    numbered: BTreeMap<Key, Vec<u32>>,
    pub(super) set_names: HashMap<Key, String>,
    /// The number of points in all sets.
    grouped: usize,
    limits: &'l Limits,
    /// Whether cells of higher order gave their corners only.
    pub(super) is_curved: bool,
    /// The highest index of a corner, and the place where it was found. Points may follow the cells that name them.
    highest: (u32, usize),
    /// The points without coordinates, and the places where they were found.
    lost: Vec<(u32, usize)>,
    /// The names of cells from now on, of three kinds, and the first cell that has them.
    names: [(Vec<String>, usize); 3],
    /// The cells of each name.
    named: BTreeMap<String, Vec<Range<usize>>>,
}

impl<'l> Builder<'l> {
    pub(super) fn new(limits: &'l Limits) -> Self {
        let (cells, ghosts, groups, numbered, set_names, grouped) = Default::default();
        let (is_curved, highest, lost, names, named) = Default::default();
        Self { cells, ghosts, groups, numbered, set_names, grouped, limits, is_curved, highest, lost, names, named }
    }

    pub(super) fn points(&self) -> usize {
        self.cells.points.len()
    }

    /// Whether there are no cells so far.
    pub(super) fn is_empty(&self) -> bool {
        self.cells.kinds.is_empty()
    }

    /// Refuses numbers of points and cells beyond the limits, before they are read.
    pub(super) fn expect(&self, points: u64, cells: u64) -> Result<(), ReadError> {
        for (count, most, what) in [(points, self.limits.points, "points"), (cells, self.limits.corners / 3, "cells")] {
            if count > most as u64 {
                return Err(too_many(&count.to_string(), what, most));
            }
        }
        Ok(())
    }

    /// Adds a point, and returns its index.
    pub(super) fn point(&mut self, point: DVec3) -> Result<u32, ReadError> {
        /// Coordinates beyond this are not lengths, and products of them would overflow.
        const FAR: f64 = 1e100;
        let index = self.cells.points.len();
        if !(point.abs().max_element() <= FAR && point.is_finite()) {
            let [x, y, z] = point.to_array();
            let message = format!("has point {index} at [{x:?}, {y:?}, {z:?}]; expected coordinates up to 1e100");
            return Err(ReadError::damaged(message));
        }
        let most = self.limits.points.min(u32::MAX as usize - 1);
        if index >= most {
            return Err(too_many(&format!("more than {most}"), "points", most));
        }
        self.cells.points.push(point);
        Ok(index as u32)
    }

    /// Adds a point that was found at a place. Programs write some that no cell names without coordinates: those are left out.
    pub(super) fn point_at(&mut self, point: DVec3, at: usize) -> Result<u32, ReadError> {
        if point.is_finite() {
            return self.point(point);
        }
        self.lost.push((self.points() as u32, at));
        self.point(DVec3::ZERO)
    }

    /// The index of a point, counted from 0, that was found at a place.
    pub(super) fn corner(&mut self, index: i64, at: usize, source: &Source<'_>) -> Result<u32, ReadError> {
        let corner = u32::try_from(index)
            .map_err(|_| ReadError::damaged(format!("names a point that it does not have {}", source.place(at))))?;
        if corner > self.highest.0 {
            self.highest = (corner, at);
        }
        Ok(corner)
    }

    pub(super) fn cell(&mut self, kind: CellKind, corners: &[u32]) -> Result<(), ReadError> {
        let most = self.limits.corners.min(u32::MAX as usize - 1);
        if corners.is_empty() {
            return Ok(());
        }
        if self.cells.corners.indices().len() + corners.len() > most {
            return Err(too_many(&format!("more than {most}"), "corners", most));
        }
        self.cells.kinds.push(kind);
        self.cells.corners.push(corners);
        Ok(())
    }

    /// Adds a cell whose corners, if it is a hexahedron, are listed around one side and then around the other.
    pub(super) fn around(&mut self, kind: CellKind, corners: &[u32]) -> Result<(), ReadError> {
        match *corners {
            [a, b, c, d, e, f, g, h] if kind == CellKind::Hexahedron => {
                self.cell(kind, &along(&[a, b, c, d, e, f, g, h]))
            }
            _ => self.cell(kind, corners),
        }
    }

    /// Adds a polygon, or what is left of one with less than three corners.
    pub(super) fn face(&mut self, corners: &[u32]) -> Result<(), ReadError> {
        match corners.len() {
            0 => Ok(()),
            1 => self.cell(CellKind::Point, corners),
            2 => self.cell(CellKind::Line, corners),
            _ => self.cell(CellKind::Polygon, corners),
        }
    }

    pub(super) fn strip(&mut self, corners: &[u32]) -> Result<(), ReadError> {
        for (at, triangle) in corners.windows(3).enumerate() {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
            self.face(&if at.is_multiple_of(2) { [a, b, c] } else { [b, a, c] })?;
        }
        Ok(())
    }

    /// Adds the velocities of the next points.
    pub(super) fn velocities(&mut self, velocities: Vec<DVec3>) {
        self.cells.velocities.get_or_insert_default().extend(velocities);
    }

    /// Adds the displacements of the next points.
    pub(super) fn displacements(&mut self, displacements: Vec<DVec3>) {
        self.cells.displacements.get_or_insert_default().extend(displacements);
    }

    /// Adds points to the set of this name.
    pub(super) fn group(&mut self, name: String, points: Vec<u32>) {
        self.groups.entry(name).or_default().extend(points);
    }

    /// Adds points to the set of a number, which names it unless `set_names` does.
    pub(super) fn number(&mut self, set: Key, points: &[u32]) -> Result<(), ReadError> {
        spend(&mut self.grouped, points.len(), self.limits)?;
        self.numbered.entry(set).or_default().extend(points);
        Ok(())
    }

    /// Gives cells from now on other names of a kind, 0 to 2. Their points become groups.
    pub(super) fn name(&mut self, kind: usize, names: Vec<String>) {
        let now = self.cells.kinds.len();
        let (before, start) = std::mem::replace(&mut self.names[kind], (names, now));
        for name in before.into_iter().filter(|name| start < now && !name.is_empty()) {
            self.named.entry(name).or_default().push(start..now);
        }
    }

    /// Tells what the points from an index on are.
    pub(super) fn ghosts(&mut self, from: usize, ghosts: Vec<Ghost>) {
        self.ghosts[0].resize(from, Ghost::None);
        self.ghosts[0].extend(ghosts);
    }

    /// Tells what cells of the file are, if anything, by the first cell that each became.
    pub(super) fn ghosts_of_cells(&mut self, starts: &[usize], ghosts: &[Ghost]) {
        let ends = starts.iter().skip(1).copied().chain([self.cells.kinds.len()]);
        for ((&start, end), &ghost) in starts.iter().zip(ends).zip(ghosts) {
            self.ghosts[1].resize(start, Ghost::None);
            self.ghosts[1].resize(end, ghost);
        }
    }

    /// Takes copies of cells out, with the points that are copies, and leaves out what is no part of the body.
    fn drop_ghosts(&mut self) {
        let [points, cells] = std::mem::take(&mut self.ghosts);
        let of = |all: &[Ghost], at: usize| all.get(at).copied().unwrap_or_default();
        let (kinds, corners) = (std::mem::take(&mut self.cells.kinds), std::mem::take(&mut self.cells.corners));
        for (at, (kind, cell)) in kinds.into_iter().zip(corners.iter()).enumerate() {
            let is_hidden = cell.iter().any(|&point| of(&points, point as usize) == Ghost::Hidden);
            match of(&cells, at) {
                Ghost::Copy => self.cells.copies.push(cell),
                Ghost::None if !is_hidden => {
                    self.cells.kinds.push(kind);
                    self.cells.corners.push(cell);
                }
                _ => {}
            }
        }
        let copies = (0..).zip(&points).filter(|(_, ghost)| **ghost == Ghost::Copy);
        copies.for_each(|(point, _)| self.cells.copies.push(&[point]));
    }

    /// Leaves points without coordinates out, if no cell names them.
    fn drop_lost(&mut self, source: &Source<'_>, first: u64) -> Result<(), ReadError> {
        let cells = &mut self.cells;
        let named = Used::new(cells.points.len(), cells.corners.indices());
        if let Some(&(index, at)) = self.lost.iter().find(|(index, _)| named.new[*index as usize] != NONE) {
            let (index, place) = (u64::from(index) + first, source.place(at));
            let message =
                format!("has point {index} without coordinates {place}, and a face with it; expected numbers");
            return Err(ReadError::new(message, "remove its faces, or write the file again"));
        }
        let mut new = vec![0; cells.points.len()];
        self.lost.iter().for_each(|(index, _)| new[*index as usize] = NONE);
        let kept = Used::numbered(new);
        cells.notes.push(match self.lost.len() {
            1 => "has a point without coordinates, which is left out".to_owned(),
            lost => format!("has {lost} points without coordinates, which are left out"),
        });
        cells.points = kept.of(&cells.points);
        cells.velocities = cells.velocities.take().map(|all| kept.of(&all));
        cells.displacements = cells.displacements.take().map(|all| kept.of(&all));
        cells.rename(&kept.new);
        let renamed = |list: &[u32]| -> Vec<u32> { list.iter().map(|&point| kept.new[point as usize]).collect() };
        let copies = std::mem::take(&mut cells.copies);
        copies.iter().map(renamed).filter(|list| !list.contains(&NONE)).for_each(|list| cells.copies.push(&list));
        for points in self.groups.values_mut() {
            *points = renamed(points);
            points.retain(|&point| point != NONE);
        }
        Ok(())
    }

    /// All cells, if each names points that are there. Errors count points from `first`.
    pub(super) fn finish(mut self, source: &Source<'_>, first: u64) -> Result<Cells, ReadError> {
        let count = self.cells.points.len();
        if !self.cells.corners.indices().is_empty() && self.highest.0 as usize >= count {
            let (index, place) = (u64::from(self.highest.0) + first, source.place(self.highest.1));
            let message = match count {
                0 => format!("names point {index} {place}, but has no points"),
                _ => {
                    format!("names point {index} {place}, but has points {first} to {}", count as u64 + first - 1)
                }
            };
            return Err(ReadError::damaged(message));
        }
        for (set, points) in std::mem::take(&mut self.numbered) {
            let kind = ["point", "curve", "surface", "volume"].get(set.0 as usize).copied().unwrap_or("group");
            let name = self.set_names.get(&set).cloned().unwrap_or_else(|| format!("{kind} {}", set.1));
            self.group(name, points);
        }
        if self.is_curved {
            let note = "has cells of higher order, of which the corners are read: their edges become straight";
            self.cells.notes.push(note.to_owned());
        }
        // Some pieces may have none.
        self.cells.velocities = self.cells.velocities.filter(|all| all.len() == count);
        self.cells.displacements = self.cells.displacements.filter(|all| all.len() == count);
        if self.ghosts.iter().flatten().any(|&ghost| ghost != Ghost::None) {
            self.drop_ghosts();
        }
        if !self.lost.is_empty() {
            self.drop_lost(source, first)?;
        }
        (0..self.names.len()).for_each(|kind| self.name(kind, Vec::new()));
        let (count, corners) = (self.cells.points.len(), &self.cells.corners);
        let of = |cells: &Range<usize>| {
            &corners.indices()[corners.range(cells.start).start..corners.range(cells.end - 1).end]
        };
        let named =
            self.named.into_iter().map(|(name, cells)| (name, cells.iter().map(of).collect::<Vec<_>>().concat()));
        let groups =
            self.groups.into_iter().chain(named).map(|(name, points)| Group::new(name, points, count)).collect();
        self.cells.groups = groups;
        Ok(self.cells)
    }
}

/// Refuses sets with very many members.
pub(super) fn spend(spent: &mut usize, members: usize, limits: &Limits) -> Result<(), ReadError> {
    let most = limits.corners.saturating_mul(4);
    *spent = spent.saturating_add(members);
    if *spent > most {
        let message = format!("has groups with more than {most} nodes");
        return Err(ReadError::new(message, "put each element into one group or few"));
    }
    Ok(())
}

pub(super) fn too_many(found: &str, what: &str, most: usize) -> ReadError {
    let message = format!("has {found} {what}; at most {most} are read");
    ReadError::new(message, "make the mesh coarser, with a decimation of the program that wrote it")
}

impl Cells {
    /// The mesh of a file of a format. In formats of cells it is a volume of the cells with a volume; else, if all faces lie in a plane
    /// of equal z, a volume of them in the plane; else, and in formats of surfaces, a surface of triangles. Points that belong to no
    /// part of it are left out.
    ///
    /// # Errors
    /// If there are neither cells nor faces, or cells without area or volume.
    pub fn mesh(self, format: Format) -> Result<Mesh, ReadError> {
        // A flat surface is not a body in the plane.
        if matches!(format, Format::Obj | Format::Stl | Format::Ply | Format::Off | Format::Gltf) {
            return self.faces();
        }
        let is_volume = self.has(CellKind::is_solid) || self.has(CellKind::is_face) && self.is_plane();
        if is_volume { self.elements(Dimension::Plane).map(Mesh::Volume) } else { self.faces() }
    }

    /// Makes points nearer than a distance to an earlier one one with it, and returns their number.
    pub fn weld(&mut self, distance: f64) -> usize {
        let first = joined(&self.points, (0..self.points.len() as u32).collect(), distance);
        self.rename(&first);
        self.groups.iter_mut().for_each(|group| *group = group.renamed(&first));
        (0..).zip(&first).filter(|&(point, &first)| point != first).count()
    }

    /// Gives the corners of all cells other indices.
    pub(super) fn rename(&mut self, new: &[u32]) {
        let renamed: Vec<u32> = self.corners.indices().iter().map(|&corner| new[corner as usize]).collect();
        self.corners = (0..self.corners.len()).map(|at| &renamed[self.corners.range(at)]).collect();
    }

    /// The faces as a surface of triangles, without points that belong to none.
    ///
    /// # Errors
    /// If there are no faces.
    fn faces(mut self) -> Result<Mesh, ReadError> {
        self.join();
        let triangles = self.triangles()?;
        let Self { points, groups, notes, .. } = self;
        Ok(Mesh::Surface(Surface { points, triangles, groups, notes }.compact()))
    }

    /// All that could be elements of one kind: the cells with a volume; else the faces, in space as triangles; else the lines. Points
    /// that belong to none of them are left out.
    ///
    /// # Errors
    /// If there is nothing of it, or cells without area or volume.
    pub fn elements(mut self, dimension: Dimension) -> Result<Volume, ReadError> {
        self.join();
        if self.has(CellKind::is_solid) {
            return self.solids();
        }
        if self.has(CellKind::is_face) && dimension == Dimension::Plane {
            return self.polygons();
        }
        let mut lists = IndexLists::default();
        self.chosen(|kind| kind == CellKind::Line)
            .flat_map(|(.., line)| line.windows(2))
            .for_each(|one| lists.push(one));
        if lists.is_empty() || self.has(CellKind::is_face) {
            lists = self.triangles()?.iter().map(<[u32; 3]>::as_slice).collect();
        }
        Ok(self.volume(dimension, Solids::Ordered, &lists, 0))
    }

    fn has(&self, wanted: fn(CellKind) -> bool) -> bool {
        self.kinds.iter().any(|&kind| wanted(kind))
    }

    /// The cells that a predicate selects, with their number in the file.
    fn chosen(&self, wanted: impl Fn(CellKind) -> bool) -> impl Iterator<Item = (usize, CellKind, &[u32])> {
        let all = self.kinds.iter().zip(self.corners.iter()).enumerate();
        all.filter(move |&(_, (&kind, _))| wanted(kind)).map(|(at, (&kind, corners))| (at, kind, corners))
    }

    /// Whether all faces have the same z, to round-off.
    fn is_plane(&self) -> bool {
        let faces = self.chosen(CellKind::is_face);
        let points = || faces.flat_map(|(.., corners)| corners).map(|&point| self.points[point as usize]);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        points().for_each(|point| (low, high) = (low.min(point), high.max(point)));
        high.z - low.z <= 1e-9 * (high - low).max_element()
    }

    /// The triangles of all faces.
    fn triangles(&self) -> Result<Vec<[u32; 3]>, ReadError> {
        let mut triangulation = Triangulation::new(&self.points);
        let mut triangles = Vec::new();
        for (at, _, corners) in self.chosen(CellKind::is_face) {
            if !triangulation.triangles(corners, &mut triangles) {
                let message = format!(
                    "has concave faces that take too long to divide into triangles: the last tried is face {at} with {} corners",
                    corners.len()
                );
                return Err(ReadError::new(message, "divide its faces into triangles in the program that wrote it"));
            }
        }
        if triangles.is_empty() && self.has(CellKind::is_face) {
            let message = "has faces with less than three different corners only";
            return Err(ReadError::new(message, "mesh the object again"));
        }
        if triangles.is_empty() {
            let points = self.points.len();
            if points == 0 {
                let help = "write it again with the object in it: some programs export what is selected alone";
                return Err(ReadError::new("has no points, faces or cells", help));
            }
            let points = if points == 1 { "1 point".to_owned() } else { format!("{points} points") };
            let message = match self.chosen(|kind| kind == CellKind::Line).count() {
                0 => format!("has {points}, but neither faces nor cells"),
                1 => format!("has {points} and 1 line, but neither faces nor cells"),
                lines => format!("has {points} and {lines} lines, but neither faces nor cells"),
            };
            return Err(ReadError::new(message, "write a mesh of triangles or of cells, not points or curves"));
        }
        Ok(triangles)
    }

    /// A volume of ordered cells.
    fn ordered(mut self, parts: Parts, dimension: Dimension, solids: Solids) -> Result<Volume, ReadError> {
        let (lists, turned, note) = parts.finished(&self.corners, &self.points)?;
        self.notes.extend(note);
        Ok(self.volume(dimension, solids, &lists, turned))
    }

    /// A volume of some lists of points, with only their points.
    fn volume(self, dimension: Dimension, solids: Solids, lists: &IndexLists, turned: usize) -> Volume {
        let used = Used::new(self.points.len(), lists.indices());
        let renamed: Vec<u32> = lists.indices().iter().map(|&corner| used.new[corner as usize]).collect();
        let cells = (0..lists.len()).map(|at| &renamed[lists.range(at)]).collect();
        let groups = used.groups(&self.groups);
        let (points, places) = (used.of(&self.points), used.of(&(0..self.points.len() as u32).collect::<Vec<_>>()));
        Volume { dimension, points, places, solids, cells, groups, turned, notes: self.notes }
    }

    fn solids(self) -> Result<Volume, ReadError> {
        let hulls =
            |kind: CellKind, corners: &[u32]| kind == CellKind::Polyhedron && matches!(corners.len(), 5 | 6 | 8);
        // Elements with so many nodes are told from tetrahedra, pyramids, wedges and hexahedra in no other way.
        let convex = self.chosen(CellKind::is_solid).any(|(_, kind, corners)| hulls(kind, corners));
        let solids = if convex { Solids::Convex } else { Solids::Ordered };
        let mut parts = Parts::new(Dimension::Space, self.kinds.len());
        for (at, kind, corners) in self.chosen(CellKind::is_solid) {
            let element = match (kind.element().expect("a solid"), corners.len()) {
                (ElementKind::Other, 4) => ElementKind::Tetrahedron,
                (element, _) => element,
            };
            let mut cell = corners.to_vec();
            parts.add(at, element, &mut cell, &self.points);
        }
        self.ordered(parts, Dimension::Space, solids)
    }

    fn polygons(mut self) -> Result<Volume, ReadError> {
        let mut parts = Parts::new(Dimension::Plane, self.kinds.len());
        self.points.iter_mut().for_each(|point| point.z = 0.0);
        for (at, _, corners) in self.chosen(CellKind::is_face) {
            let mut cell = corners.to_vec();
            cell.dedup();
            if cell.first() == cell.last() {
                cell.pop();
            }
            parts.add(at, ElementKind::Polygon, &mut cell, &self.points);
        }
        self.ordered(parts, Dimension::Plane, Solids::Ordered)
    }
}

/// Stands for a point that is left out.
const NONE: u32 = u32::MAX;

/// New indices of the points in use.
pub(crate) struct Used {
    /// The new index of each point, or [`NONE`].
    pub(crate) new: Vec<u32>,
}

impl Used {
    pub(crate) fn new(points: usize, corners: &[u32]) -> Self {
        let mut new = vec![NONE; points];
        corners.iter().for_each(|&corner| new[corner as usize] = 0);
        Self::numbered(new)
    }

    /// Numbers the points that are not left out.
    fn numbered(mut new: Vec<u32>) -> Self {
        let used = new.iter_mut().filter(|new| **new != NONE);
        used.zip(0..).for_each(|(new, index)| *new = index);
        Self { new }
    }

    /// Whether no point is left out.
    pub(crate) fn are_all(&self) -> bool {
        !self.new.contains(&NONE)
    }

    /// The values of these points among those of all.
    pub(crate) fn of<T: Copy>(&self, all: &[T]) -> Vec<T> {
        all.iter().zip(&self.new).filter(|&(_, &new)| new != NONE).map(|(value, _)| *value).collect()
    }

    /// The groups that have points in use.
    pub(crate) fn groups(&self, groups: &[Group]) -> Vec<Group> {
        let group = |group: &Group| {
            let points = group.points.iter().map(|&point| self.new[point as usize]);
            let points: Vec<u32> = points.filter(|&point| point != NONE).collect();
            (!points.is_empty()).then(|| Group { name: group.name.clone(), points })
        };
        groups.iter().filter_map(group).collect()
    }
}
