//! The lists of a body in a NumPy archive.

use super::lists::{ListSource, Lists};
use crate::reading::beside::missing;
use crate::reading::collector::Here;
use crate::reading::words::{count, list, nearest};
use crate::scene::file::LISTS;
use crate::scene::limits::Limits;
use crate::scene::mesh;
use crate::scene::npz::{Array, Npz, Values};
use crate::scene::recording::full;
use crate::sim::{Dimension, IndexLists};
use glam::DVec3;
use std::path::Path;

/// The help for a file that is not an archive.
const EXPECTED: &str = "write it with numpy.savez, at least `nodes` (a row of coordinates for each) and `elements` (a row of nodes for each, \
                        -1 at the end of short ones); docs/bodies.md has an example";

impl<'a> Lists<'a> {
    /// The lists of the archive of a body, or `None` after reporting its mistakes.
    pub(super) fn read(folder: &Path, name: &str, body: Here<'a>, limits: &Limits) -> Option<Self> {
        let (path, place, report) = (folder.join(name), body.to("file"), body.report);
        let open = || match path.exists() {
            false => Err(missing(&path, &["npz"])),
            true => match mesh::instead_of_archive(&path, name) {
                Some(wrong) => Err(wrong),
                None => Npz::open(&path).map_err(|message| (message, Some(EXPECTED.to_owned()))),
            },
        };
        let mut npz = open().map_err(|(message, help)| place.wrong(format!("`{name}` {message}"), help)).ok()?;
        let before = report.total();
        let source = ListSource { body, file: Some((name.to_owned(), place)) };
        let lists = Reader { npz: &mut npz, source, limits }.lists();
        lists.filter(|_| report.total() == before)
    }

    /// The lists of the body of a run in an archive of states, if it has one; `None` after reporting mistakes, too.
    pub(super) fn recorded(npz: &mut Npz, run: &str, source: ListSource<'a>, limits: &Limits) -> Option<Self> {
        let names = npz.names();
        // A run has its own body, or that of all runs.
        let name = |key: &str| [full(run, key), key.to_owned()].into_iter().find(|name| names.contains(name));
        let rest = name("rest")?;
        let [elements, faces, mass] =
            ["elements", "faces", "mass"].map(|key| name(key).unwrap_or_else(|| full(run, key)));
        let mut reader = Reader { npz, source, limits };
        let (nodes, dimension) = reader.nodes(&rest)?;
        let elements = reader.array(&elements).and_then(|array| reader.rows(&elements, &array, 2));
        let faces = reader.optional(&faces).and_then(|array| reader.rows(&faces, &array, 3));
        let masses = reader.optional(&mass).and_then(|array| reader.masses(&mass, &array));
        let (nodes, elements, source) = (nodes?, elements?, reader.source);
        let count = masses.as_ref().map_or(nodes.len(), Vec::len);
        source.check_count(&mass, count, nodes.len());
        (count == nodes.len()).then(|| Self { faces, masses, ..Self::new(source, dimension, nodes, elements) })
    }
}

/// The name of an array without that of its run.
fn of_any(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or(key)
}

/// Reads the arrays of one archive.
struct Reader<'r, 'a> {
    npz: &'r mut Npz,
    source: ListSource<'a>,
    limits: &'r Limits,
}

impl<'a> Reader<'_, 'a> {
    fn lists(mut self) -> Option<Lists<'a>> {
        for name in self.npz.names().iter().filter(|name| !LISTS.contains(&name.as_str())) {
            // The names in `meshio`.
            let known = [("points", "nodes"), ("cells", "elements")].into_iter().find(|(other, _)| other == name);
            let help = match known.map(|(_, ours)| ours).or_else(|| nearest(name, &LISTS)) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {}", list(&LISTS, "and", str::to_owned)),
            };
            let message = format!("`{}` is not an array of a body", self.source.name(name, &[]));
            self.source.report(name, &[], message, help);
        }
        let (nodes, dimension) = self.nodes("nodes").unzip();
        let (nodes, dimension) = (nodes.flatten(), dimension.unwrap_or(Dimension::Space));
        let columns = nodes.as_ref().map(|_| if dimension == Dimension::Plane { 2 } else { 3 });
        let elements = self.array("elements").and_then(|array| self.rows("elements", &array, 2));
        let springs = self.optional("springs").and_then(|array| self.pairs("springs", &array));
        let faces = self.optional("faces").and_then(|array| self.rows("faces", &array, 3));
        let positions = self.optional("positions").and_then(|array| self.points("positions", &array, columns));
        let velocities = self.optional("velocities").and_then(|array| self.points("velocities", &array, columns));
        let masses = self.optional("masses").and_then(|array| self.masses("masses", &array));
        let lists = Lists::new(self.source, dimension, nodes?, elements?);
        Some(Lists { springs, faces, positions, velocities, masses, ..lists })
    }

    /// The header of a required array.
    fn array(&mut self, key: &str) -> Option<Array> {
        let found = self.npz.array(key);
        if let (None, Some((file, place))) = (&found, &self.source.file) {
            place.wrong(format!("`{file}` has no array `{key}`"), None);
        }
        self.sound(key, found?)
    }

    /// The header of an optional array.
    fn optional(&mut self, key: &str) -> Option<Array> {
        let found = self.npz.array(key)?;
        self.sound(key, found)
    }

    /// A header without a mistake.
    fn sound(&mut self, key: &str, found: Result<Array, String>) -> Option<Array> {
        let is_empty = |array: &Array| array.shape.first() == Some(&0) && of_any(key) != "faces";
        let empty = || "is empty; expected at least one row".to_owned();
        let sound = found.and_then(|array| if is_empty(&array) { Err(empty()) } else { Ok(array) });
        sound.map_err(|message| self.source.say(key, &[], &message)).ok()
    }

    fn wrong_shape(&mut self, key: &str, array: &Array, expected: &str) {
        self.source.say(key, &[], &format!("has the shape {}; expected {expected}", array.shape_in_words()));
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
            let help = "use fewer nodes, or allow it with --allow-large (in code, `Limits::NONE`)";
            self.source.report(key, &[], message, help);
            return None;
        }
        self.npz.values(array).map_err(|message| self.source.say(key, &[], &message)).ok()
    }

    /// The nodes, and whether they are in the plane or in space; `None` without their array.
    fn nodes(&mut self, key: &str) -> Option<(Option<Vec<DVec3>>, Dimension)> {
        let array = self.array(key)?;
        let dimension = if array.shape.get(1) == Some(&2) { Dimension::Plane } else { Dimension::Space };
        Some((self.points(key, &array, None), dimension))
    }

    /// Points with `columns` coordinates, if the number of coordinates is known.
    fn points(&mut self, key: &str, array: &Array, columns: Option<u64>) -> Option<Vec<DVec3>> {
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
        let depth = |row| if values.columns == 2 { 0.0 } else { values.double(row, 2) };
        let point = |row| DVec3::new(values.double(row, 0), values.double(row, 1), depth(row));
        let points: Vec<_> = (0..values.rows).map(point).collect();
        self.source.check_points(key, &points);
        Some(points)
    }

    fn masses(&mut self, key: &str, array: &Array) -> Option<Vec<f64>> {
        if array.shape.len() != 1 {
            self.wrong_shape(key, array, "one number for each node");
            return None;
        }
        let values = self.values(key, array)?;
        let masses: Vec<_> = (0..values.rows).map(|row| values.double(row, 0)).collect();
        self.source.check_masses(key, &masses);
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
            self.source.say(key, &[], &format!("is {kind}; expected integers, as by astype(\"<i4\")"));
            return None;
        }
        self.values(key, array)
    }

    /// One index; 0 after a mistake.
    fn index(&mut self, key: &str, values: &Values, at: [usize; 2]) -> u32 {
        let number = values.whole(at[0], at[1]);
        u32::try_from(number).unwrap_or_else(|_| {
            self.source.say(key, &at, &format!("is {number}; expected the number of a node"));
            0
        })
    }

    fn pairs(&mut self, key: &str, array: &Array) -> Option<Vec<[u32; 2]>> {
        let values = self.indices(key, array, |columns| columns == 2, "one row for each spring with 2 nodes")?;
        Some((0..values.rows).map(|row| [0, 1].map(|column| self.index(key, &values, [row, column]))).collect())
    }

    /// Rows of nodes without their unused entries.
    fn rows(&mut self, key: &str, array: &Array, least: usize) -> Option<IndexLists> {
        let expected = format!("one row for each of the {key} with at least {least} nodes");
        let values = self.indices(key, array, |columns| columns >= least as u64, &expected)?;
        let mut rows = IndexLists::default();
        let mut list = Vec::with_capacity(values.columns);
        for row in 0..values.rows {
            list.clear();
            let used = (0..values.columns).rev().find(|&column| values.whole(row, column) != -1);
            for column in 0..used.map_or(0, |last| last + 1) {
                if values.whole(row, column) == -1 {
                    self.source.say(key, &[row, column], "is -1, but a node follows; expected -1 only at the end");
                    list.push(0);
                } else {
                    list.push(self.index(key, &values, [row, column]));
                }
            }
            rows.push(&list);
        }
        self.source.check_rows(key, &rows, least);
        Some(rows)
    }
}
