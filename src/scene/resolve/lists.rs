//! The lists of a body: typed in the scene, or in a file beside it.

use super::{Place, vector};
use crate::reading::beside::missing;
use crate::reading::collector::{Collector, Help, PathPart, key_path, written};
use crate::reading::words::{count, list, nearest};
use crate::scene::file::LARGEST;
use crate::scene::file::{BodyFile, Coordinates, Positive};
use crate::scene::limits::Limits;
use crate::scene::mesh;
use crate::scene::npz::{Array, Npz, Values};
use crate::scene::recording::full;
use crate::sim::{Dimension, IndexLists, Solids};
use glam::DVec3;
use sha2::{Digest, Sha256};
use std::path::Path;

/// The place of the lists.
#[derive(Clone, Debug)]
pub(super) struct ListSource {
    /// The place of the body in the scene.
    pub(super) body: Place,
    /// The file that has the lists, and the place of its name in the scene; `None` if the scene has them.
    pub(super) file: Option<(String, Place)>,
}

impl ListSource {
    /// The name of a list or an entry in messages.
    pub(super) fn name(&self, key: &str, at: &[usize]) -> String {
        let indices: String = at.iter().map(|index| format!("[{index}]")).collect();
        match &self.file {
            None => format!("{}.{key}{indices}", written(&self.body)),
            Some((file, _)) => format!("{file}: {key}{indices}"),
        }
    }

    /// Reports a mistake in an entry of a list.
    pub(super) fn report(&self, report: &mut Collector<'_>, key: &str, at: &[usize], message: String, help: impl Help) {
        match self.file {
            None => {
                let indices = at.iter().map(|&index| PathPart::Index(index));
                let path: Vec<_> = key_path![self.body; key].into_iter().chain(indices).collect();
                report.at(&path, message, help);
            }
            Some(_) => self.report_in_file(report, key, at, message, help.text()),
        }
    }

    /// Reports a mistake about a whole list.
    pub(super) fn report_key(&self, report: &mut Collector<'_>, key: &str, message: String) {
        match self.file {
            None => report.at_key(&key_path![self.body; key], message, None),
            Some(_) => self.report_in_file(report, key, &[], message, None),
        }
    }

    /// Reports at the file's name in the scene, so the message names list and entry.
    fn report_in_file(
        &self,
        report: &mut Collector<'_>,
        key: &str,
        at: &[usize],
        message: String,
        help: Option<String>,
    ) {
        let named = message.contains(&format!("`{}", self.name(key, &at[..at.len().min(1)])));
        let message = if named { message } else { format!("`{}`: {message}", self.name(key, at)) };
        if let Some((_, place)) = &self.file {
            report.at(place, message, help);
        }
    }
}

/// The lists of a body.
#[derive(Clone, Debug)]
pub(super) struct Lists {
    pub(super) source: ListSource,
    pub(super) dimension: Dimension,
    /// Rest positions (m).
    pub(super) nodes: Vec<DVec3>,
    pub(super) elements: IndexLists,
    /// How elements of four, five, six and eight nodes are read, unless the scene says.
    pub(super) solids: Solids,
    pub(super) springs: Option<Vec<[u32; 2]>>,
    pub(super) faces: Option<IndexLists>,
    /// Initial positions (m).
    pub(super) positions: Option<Vec<DVec3>>,
    /// Initial velocities (m/s).
    pub(super) velocities: Option<Vec<DVec3>>,
    /// Masses (kg).
    pub(super) masses: Option<Vec<f64>>,
}

impl Lists {
    /// The lists of a scene with nodes. Points with another number of coordinates are reported.
    pub(super) fn typed(file: &BodyFile, place: &Place, report: &mut Collector<'_>) -> Option<Self> {
        let nodes = file.nodes.as_ref()?;
        let dimension = if nodes.first()?.0.len() == 2 { Dimension::Plane } else { Dimension::Space };
        let mut points = |typed: &Option<Vec<Coordinates>>, key| {
            let mut points = Vec::new();
            for (at, coordinates) in typed.as_ref()?.iter().enumerate() {
                let path = key_path![place; key, at];
                points.push(vector(coordinates, dimension, &path, report).unwrap_or_default());
            }
            Some(points)
        };
        let all =
            |typed: &Option<Vec<Vec<u32>>>| Some(typed.as_ref()?.iter().map(Vec::as_slice).collect::<IndexLists>());
        Some(Self {
            solids: Solids::Ordered,
            source: ListSource { body: place.clone(), file: None },
            dimension,
            nodes: points(&file.nodes, "nodes")?,
            elements: all(&file.elements).unwrap_or_default(),
            springs: file.springs.clone(),
            faces: all(&file.faces),
            positions: points(&file.positions, "positions"),
            velocities: points(&file.velocities, "velocities"),
            masses: file.masses.as_ref().map(|masses| masses.iter().map(|&Positive(mass)| mass).collect()),
        })
    }

    /// The lists of a file, or `None` after reporting its mistakes.
    pub(super) fn read(
        folder: &Path,
        name: &str,
        place: &Place,
        limits: &Limits,
        report: &mut Collector<'_>,
    ) -> Option<Self> {
        let path = folder.join(name);
        let whole = |report: &mut Collector<'_>, message: String, help: Option<String>| {
            report.at(&key_path![place; "file"], format!("`{name}` {message}"), help);
        };
        if !path.exists() {
            let (message, help) = missing(&path, &["npz"]);
            whole(report, message, help);
            return None;
        }
        if let Some((message, help)) = mesh::instead_of_archive(&path, name) {
            whole(report, message, help);
            return None;
        }
        let mut npz = match Npz::open(&path) {
            Ok(npz) => npz,
            Err(message) => {
                whole(report, message, Some(EXPECTED.to_owned()));
                return None;
            }
        };
        let before = report.total();
        let source = ListSource { body: place.clone(), file: Some((name.to_owned(), key_path![place; "file"])) };
        let mut reader = Reader { npz: &mut npz, source, limits, report };
        let lists = reader.lists();
        (report.total() == before).then_some(lists).flatten()
    }

    /// The lists of the body of a run in an archive of states, if it has one; `None` after reporting mistakes, too.
    pub(super) fn recorded(
        npz: &mut Npz,
        run: &str,
        source: ListSource,
        limits: &Limits,
        report: &mut Collector<'_>,
    ) -> Option<Self> {
        let names = npz.names();
        // A run has its own body, or that of all runs.
        let name = |key: &str| [full(run, key), key.to_owned()].into_iter().find(|name| names.contains(name));
        let rest = name("rest")?;
        let [elements, faces, mass] =
            ["elements", "faces", "mass"].map(|key| name(key).unwrap_or_else(|| full(run, key)));
        let mut reader = Reader { npz, source, limits, report };
        let array = reader.array(&rest)?;
        let rest = reader.vectors(&rest, &array, None);
        let elements = reader.array(&elements).and_then(|array| reader.rows_of_indices(&elements, &array, 2));
        let faces = reader.optional(&faces).and_then(|array| reader.rows_of_indices(&faces, &array, 3));
        let masses = reader.optional(&mass).and_then(|array| reader.masses(&mass, &array));
        let dimension = if array.shape.get(1) == Some(&2) { Dimension::Plane } else { Dimension::Space };
        let (nodes, elements, source) = (rest?, elements?, reader.source);
        if let Some(masses) = masses.as_ref().filter(|masses| masses.len() != nodes.len()) {
            check_count(&source, &mass, masses.len(), nodes.len(), report);
            return None;
        }
        let (springs, positions, velocities) = (None, None, None);
        let solids = Solids::Ordered;
        Some(Self { source, dimension, nodes, elements, solids, springs, faces, positions, velocities, masses })
    }

    /// A digest of all lists. It does not depend on compression, the width of numbers or the location of the file.
    pub(super) fn digest(&self) -> String {
        let mut hasher = Sha256::new();
        let coordinates = |points: &[DVec3], hasher: &mut Sha256| {
            for point in points {
                // Zero and −0 are equal.
                hasher.update(point.to_array().map(|coordinate| (coordinate + 0.0).to_le_bytes()).as_flattened());
            }
        };
        let lengths = |hasher: &mut Sha256, key: &str, length: usize| {
            hasher.update(key);
            hasher.update((length as u64).to_le_bytes());
        };
        lengths(&mut hasher, if self.dimension == Dimension::Plane { "plane" } else { "space" }, self.nodes.len());
        if self.solids == Solids::Convex {
            hasher.update("convex");
        }
        coordinates(&self.nodes, &mut hasher);
        for (key, lists) in [("elements", Some(&self.elements)), ("faces", self.faces.as_ref())] {
            let Some(lists) = lists else { continue };
            lengths(&mut hasher, key, lists.len());
            // Hashing numbers one by one is slower.
            let mut bytes = Vec::new();
            for list in lists.iter() {
                bytes.clear();
                bytes.extend((list.len() as u64).to_le_bytes());
                bytes.extend(list.iter().flat_map(|index| index.to_le_bytes()));
                hasher.update(&bytes);
            }
        }
        if let Some(springs) = &self.springs {
            lengths(&mut hasher, "springs", springs.len());
            springs.iter().flatten().for_each(|index| hasher.update(index.to_le_bytes()));
        }
        for (key, points) in [("positions", &self.positions), ("velocities", &self.velocities)] {
            if let Some(points) = points {
                lengths(&mut hasher, key, points.len());
                coordinates(points, &mut hasher);
            }
        }
        if let Some(masses) = &self.masses {
            lengths(&mut hasher, "masses", masses.len());
            masses.iter().for_each(|mass| hasher.update(mass.to_le_bytes()));
        }
        hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// The message for a number that is not finite or too large.
fn beyond(number: f64) -> Option<String> {
    let expected = if number.is_finite() { format!("a magnitude up to {LARGEST:e}") } else { "a finite number".into() };
    (number.is_nan() || number.abs() > LARGEST).then(|| format!("is {number}; expected {expected}"))
}

/// Reports numbers out of range and too short lists in scenes made in code. In files the schema finds them.
pub(in crate::scene) fn check_unwritten(file: &BodyFile, place: Place, report: &mut Collector<'_>) {
    let source = ListSource { body: place, file: None };
    let mut say = |key: &str, at: &[usize], message: String| {
        source.report(report, key, at, format!("`{}` {message}", source.name(key, at)), None);
    };
    for (key, points) in [("nodes", &file.nodes), ("positions", &file.positions), ("velocities", &file.velocities)] {
        for (row, Coordinates(point)) in points.iter().flatten().enumerate() {
            let wrong = point.iter().enumerate().filter_map(|(axis, &number)| Some((axis, beyond(number)?)));
            wrong.for_each(|(axis, message)| say(key, &[row, axis], message));
        }
    }
    for (row, &Positive(mass)) in file.masses.iter().flatten().enumerate() {
        let too_small = || (mass <= 0.0).then(|| format!("is {mass}; expected a number greater than 0"));
        beyond(mass).or_else(too_small).into_iter().for_each(|message| say("masses", &[row], message));
    }
    for (key, lists, least) in [("elements", &file.elements, 2), ("faces", &file.faces, 3)] {
        for (row, list) in lists.iter().flatten().enumerate().filter(|(_, list)| list.len() < least) {
            let nodes = if list.len() == 1 { "node" } else { "nodes" };
            say(key, &[row], format!("has {} {nodes}; expected at least {least}", list.len()));
        }
    }
}

/// The help for a file that is not an archive.
const EXPECTED: &str = "write it with numpy.savez, at least `nodes` (a row of coordinates for each) and `elements` (a row of nodes for each, \
                        -1 at the end of short ones); docs/bodies.md has an example";

/// The names of arrays in an archive, in the order in which they are read.
const ARRAYS: [&str; 7] = ["nodes", "elements", "springs", "faces", "positions", "velocities", "masses"];

/// The name of an array without that of its run.
fn of_any(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or(key)
}

/// Reads the arrays of one archive.
struct Reader<'a, 't> {
    npz: &'a mut Npz,
    source: ListSource,
    limits: &'a Limits,
    report: &'a mut Collector<'t>,
}

impl Reader<'_, '_> {
    fn report(&mut self, key: &str, at: &[usize], message: String, help: Option<String>) {
        self.source.report(self.report, key, at, message, help);
    }

    /// Reports a mistake whose message begins with the name of an array or entry.
    fn say(&mut self, key: &str, at: &[usize], message: &str) {
        let message = format!("`{}` {message}", self.source.name(key, at));
        self.report(key, at, message, None);
    }

    fn lists(&mut self) -> Option<Lists> {
        for name in self.npz.names().iter().filter(|name| !ARRAYS.contains(&name.as_str())) {
            // The names in `meshio`.
            let known = [("points", "nodes"), ("cells", "elements")].into_iter().find(|(other, _)| other == name);
            let help = match known.map(|(_, ours)| ours).or_else(|| nearest(name, &ARRAYS)) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {}", list(&ARRAYS, "and", str::to_owned)),
            };
            let message = format!("`{}` is not an array of a body", self.source.name(name, &[]));
            self.report(name, &[], message, Some(help));
        }
        let nodes = self.array("nodes").and_then(|array| match array.shape[..] {
            [_, 2 | 3] => self.values("nodes", &array),
            _ => {
                self.wrong_shape("nodes", &array, "one row for each node with 2 or 3 coordinates");
                None
            }
        });
        let columns = nodes.as_ref().map(|values| values.columns as u64);
        let dimension = if columns == Some(2) { Dimension::Plane } else { Dimension::Space };
        let nodes = nodes.map(|values| self.points("nodes", &values));
        let elements = self.array("elements").and_then(|array| self.rows_of_indices("elements", &array, 2));
        let springs = self.optional("springs").and_then(|array| self.pairs("springs", &array));
        let faces = self.optional("faces").and_then(|array| self.rows_of_indices("faces", &array, 3));
        let positions = self.optional("positions").and_then(|array| self.vectors("positions", &array, columns));
        let velocities = self.optional("velocities").and_then(|array| self.vectors("velocities", &array, columns));
        let masses = self.optional("masses").and_then(|array| self.masses("masses", &array));
        let (nodes, elements, source) = (nodes?, elements?, self.source.clone());
        let solids = Solids::Ordered;
        Some(Lists { source, dimension, nodes, elements, solids, springs, faces, positions, velocities, masses })
    }

    /// The header of a required array.
    fn array(&mut self, key: &str) -> Option<Array> {
        let found = self.optional_head(key);
        if found.is_none() {
            let (file, place) = self.source.file.as_ref()?;
            self.report.at(place, format!("`{file}` has no array `{key}`"), None);
        }
        found.flatten()
    }

    /// The header of an optional array.
    fn optional(&mut self, key: &str) -> Option<Array> {
        self.optional_head(key).flatten()
    }

    /// The header of an array: `None` without such an array, `Some(None)` after reporting a mistake.
    fn optional_head(&mut self, key: &str) -> Option<Option<Array>> {
        match self.npz.array(key)? {
            Ok(array) if array.shape.first() == Some(&0) && of_any(key) != "faces" => {
                self.say(key, &[], "is empty; expected at least one row");
                Some(None)
            }
            Ok(array) => Some(Some(array)),
            Err(message) => {
                self.say(key, &[], &message);
                Some(None)
            }
        }
    }

    fn wrong_shape(&mut self, key: &str, array: &Array, expected: &str) {
        self.say(key, &[], &format!("has the shape {}; expected {expected}", array.shape_in_words()));
    }

    /// The values of an array, unless it is too large.
    fn values(&mut self, key: &str, array: &Array) -> Option<Values> {
        let all: u64 = array.shape.iter().product();
        let (length, limit, what) = match of_any(key) {
            "elements" | "faces" => (all, self.limits.corners, "entries"),
            "springs" => (array.shape[0], self.limits.springs, "springs"),
            "nodes" | "rest" => (array.shape[0], self.limits.nodes, "nodes"),
            _ => (array.shape[0], self.limits.nodes, "rows"),
        };
        if length > limit {
            let (name, length, limit) = (self.source.name(key, &[]), count(length.into()), count(limit.into()));
            let message = format!("`{name}` has {length} {what}; the limit is {limit}");
            self.report(
                key,
                &[],
                message,
                Some("use fewer nodes, or allow it with --allow-large (in code, `Limits::NONE`)".into()),
            );
            return None;
        }
        match self.npz.values(array) {
            Ok(values) => Some(values),
            Err(message) => {
                self.say(key, &[], &message);
                None
            }
        }
    }

    /// A number that is finite and not too large; otherwise a mistake is reported, and it is zero.
    fn number(&mut self, key: &str, values: &Values, at: &[usize]) -> f64 {
        let number = values.double(at[0], at.get(1).copied().unwrap_or(0));
        let Some(message) = beyond(number) else { return number };
        self.say(key, at, &message);
        0.0
    }

    fn points(&mut self, key: &str, values: &Values) -> Vec<DVec3> {
        let flat = values.columns == 2;
        let point = |row| {
            let z = if flat { 0.0 } else { self.number(key, values, &[row, 2]) };
            DVec3::new(self.number(key, values, &[row, 0]), self.number(key, values, &[row, 1]), z)
        };
        (0..values.rows).map(point).collect()
    }

    /// Points with `columns` coordinates, if the number of coordinates is known.
    fn vectors(&mut self, key: &str, array: &Array, columns: Option<u64>) -> Option<Vec<DVec3>> {
        let fits = array.shape.len() == 2 && columns.is_none_or(|columns| array.shape[1] == columns);
        if !fits || !(2..=3).contains(&array.shape[1]) {
            let expected = match columns {
                Some(columns) => format!("one row for each node with {columns} coordinates, as `nodes` has"),
                None => "one row for each node with 2 or 3 coordinates".to_owned(),
            };
            self.wrong_shape(key, array, &expected);
            return None;
        }
        let values = self.values(key, array)?;
        Some(self.points(key, &values))
    }

    fn masses(&mut self, key: &str, array: &Array) -> Option<Vec<f64>> {
        if array.shape.len() != 1 {
            self.wrong_shape(key, array, "one number for each node");
            return None;
        }
        let values = self.values(key, array)?;
        let mut masses = Vec::with_capacity(values.rows);
        for row in 0..values.rows {
            let before = self.report.total();
            let mass = self.number(key, &values, &[row]);
            if mass <= 0.0 && self.report.total() == before {
                self.say(key, &[row], &format!("is {mass}; expected a number greater than 0"));
            }
            masses.push(mass);
        }
        Some(masses)
    }

    /// The values of an array of indices with rows of a length.
    fn indices(&mut self, key: &str, array: &Array, fits: impl Fn(u64) -> bool, expected: &str) -> Option<Values> {
        if array.shape.len() != 2 || !fits(array.shape[1]) {
            self.wrong_shape(key, array, expected);
            return None;
        }
        if !array.is_whole() {
            let kind = array.type_in_words();
            self.say(key, &[], &format!("is {kind}; expected integers, as by astype(\"<i4\")"));
            return None;
        }
        self.values(key, array)
    }

    /// One index, or `None` after a mistake.
    fn index(&mut self, key: &str, values: &Values, at: [usize; 2]) -> Option<u32> {
        let number = values.whole(at[0], at[1]);
        let index = u32::try_from(number).ok();
        if index.is_none() {
            self.say(key, &at, &format!("is {number}; expected the number of a node"));
        }
        index
    }

    fn pairs(&mut self, key: &str, array: &Array) -> Option<Vec<[u32; 2]>> {
        let values = self.indices(key, array, |columns| columns == 2, "one row for each spring with 2 nodes")?;
        let mut pairs = Vec::with_capacity(values.rows);
        for row in 0..values.rows {
            let pair = [0, 1].map(|column| self.index(key, &values, [row, column]));
            pairs.push(pair.map(Option::unwrap_or_default));
        }
        Some(pairs)
    }

    /// Rows of nodes without their unused entries.
    fn rows_of_indices(&mut self, key: &str, array: &Array, least: usize) -> Option<IndexLists> {
        let expected = format!("one row for each of the {key} with at least {least} nodes");
        let values = self.indices(key, array, |columns| columns >= least as u64, &expected)?;
        let mut lists = IndexLists::default();
        let mut row_of = Vec::with_capacity(values.columns);
        for row in 0..values.rows {
            row_of.clear();
            let before = self.report.total();
            let used = (0..values.columns).rev().find(|&column| values.whole(row, column) != -1);
            let used = used.map_or(0, |last| last + 1);
            for column in 0..used {
                match values.whole(row, column) {
                    -1 => self.say(key, &[row, column], "is -1, but a node follows; expected -1 only at the end"),
                    _ => row_of.extend(self.index(key, &values, [row, column])),
                }
            }
            if used < least && self.report.total() == before {
                let nodes = if used == 1 { "node" } else { "nodes" };
                self.say(key, &[row], &format!("has {used} {nodes}; expected at least {least}"));
            }
            lists.push(&row_of);
        }
        Some(lists)
    }
}

/// Reports a list without exactly one entry for each node.
pub(super) fn check_count(source: &ListSource, key: &str, length: usize, nodes: usize, report: &mut Collector<'_>) {
    if length != nodes {
        let (name, entries) = (source.name(key, &[]), if length == 1 { "entry" } else { "entries" });
        let message = format!("`{name}` has {length} {entries}, and the body has {nodes} nodes; expected one for each");
        source.report_key(report, key, message);
    }
}

/// Reports a key of the scene that conflicts with an array of the file.
pub(super) fn check_exclusive(lists: &Lists, typed: bool, key: &str, array: &str, report: &mut Collector<'_>) {
    if typed {
        let path = key_path![lists.source.body; key];
        let message = format!("`{}` and `{}` exclude each other", written(&path), lists.source.name(array, &[]));
        report.at_key(&path, message, "keep one");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_have_another_digest_than_ordered_elements() {
        let (springs, faces, positions, velocities, masses) = Default::default();
        let source = ListSource { body: Vec::new(), file: None };
        let (dimension, nodes) = (Dimension::Space, vec![DVec3::ZERO; 4]);
        let (elements, solids) = ([&[0, 1, 2, 3][..]].into_iter().collect(), Solids::Ordered);
        let lists = Lists { source, dimension, nodes, elements, solids, springs, faces, positions, velocities, masses };
        assert_ne!(lists.digest(), Lists { solids: Solids::Convex, ..lists.clone() }.digest());
    }
}
