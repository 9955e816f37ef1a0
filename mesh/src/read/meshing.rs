//! The mesh that cells of a file make.

use super::order::Parts;
use super::polygon::{Triangulation, outline};
use super::source::quoted;
use super::used::{NONE, Used};
use super::{CellKind, Cells, Format, Mesh, ReadError, Surface, Volume};
use localshape_sim::geometry::bounds;
use localshape_sim::{Dimension, ElementKind, IndexLists, Solids};
use std::collections::BTreeSet;

/// How a file is told to have cells of fewer dimensions that belong to no element.
pub(super) const BESIDE: &str = "has lines and faces beside its solids, which are left out";

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

    /// Whether all faces have the same z, to round-off.
    fn is_plane(&self) -> bool {
        let faces = self.chosen(CellKind::is_face);
        let points = faces.flat_map(|(.., corners)| corners).map(|&point| self.points[point as usize]);
        let (low, high) = bounds(&points.collect::<Vec<_>>());
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

    /// Tells of lines and faces with points that no element has, and of the groups that are lost with them. Those at the surface of
    /// the elements name its parts.
    fn tell_beside(&mut self, dimension: Dimension, lists: &IndexLists) {
        /// So many groups are named.
        const MOST: usize = 8;
        let used = Used::new(self.points.len(), lists.indices());
        let is_lost = |point: &u32| used.new[*point as usize] == NONE;
        let (what, is_thin): (_, fn(CellKind) -> bool) = match dimension {
            Dimension::Space => (BESIDE, |kind| kind == CellKind::Line || kind.is_face()),
            Dimension::Plane => ("has lines beside its faces, which are left out", |kind| kind == CellKind::Line),
        };
        let lost = self.chosen(is_thin).filter(|(.., corners)| corners.iter().any(is_lost)).count();
        if lost > 0 && !self.notes.iter().any(|note| note.starts_with(what)) {
            self.notes.push(format!("{what}: {lost}"));
        }
        let is_gone = |points: &[u32]| !points.is_empty() && points.iter().all(is_lost);
        let groups = self.groups.iter().filter(|group| is_gone(&group.points));
        let mut names: Vec<_> = groups.map(|group| quoted(group.name.as_bytes())).collect();
        if names.len() > MOST {
            names.truncate(MOST);
            names.push("…".to_owned());
        }
        if !names.is_empty() {
            self.notes.push(format!("has groups whose points are all left out: {}", names.join(", ")));
        }
    }

    /// A volume of ordered cells.
    fn ordered(mut self, parts: Parts, dimension: Dimension, solids: Solids) -> Result<Volume, ReadError> {
        let (lists, turned, notes) = parts.finished(&self.corners, &self.points)?;
        self.notes.extend(notes);
        self.tell_beside(dimension, &lists);
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
        let hulls = |kind: CellKind, corners: &[u32]| {
            kind == CellKind::Polyhedron && matches!(BTreeSet::from_iter(corners).len(), 5 | 6 | 8)
        };
        // Elements with so many nodes are told from tetrahedra, pyramids, wedges and hexahedra in no other way.
        let convex = self.chosen(CellKind::is_solid).any(|(_, kind, corners)| hulls(kind, corners));
        let solids = if convex { Solids::Convex } else { Solids::Ordered };
        let mut parts = Parts::new(Dimension::Space, self.kinds.len());
        for (at, kind, corners) in self.chosen(CellKind::is_solid) {
            let element = match (kind.element().expect("a solid"), corners.len()) {
                (ElementKind::Other, 4) => ElementKind::Tetrahedron,
                (element, _) => element,
            };
            parts.add(at, element, &mut corners.to_vec(), &self.points);
        }
        self.ordered(parts, Dimension::Space, solids)
    }

    fn polygons(mut self) -> Result<Volume, ReadError> {
        let mut parts = Parts::new(Dimension::Plane, self.kinds.len());
        self.points.iter_mut().for_each(|point| point.z = 0.0);
        for (at, _, corners) in self.chosen(CellKind::is_face) {
            parts.add(at, ElementKind::Polygon, &mut outline(corners), &self.points);
        }
        self.ordered(parts, Dimension::Plane, Solids::Ordered)
    }
}
