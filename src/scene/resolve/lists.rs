//! The lists of a body: typed in the scene, made in code, or in a file.

use super::vector;
use crate::reading::collector::{Help, Here};
use crate::reading::words::hexadecimal;
use crate::scene::file::{BodyFile, Coordinates, LARGEST, Positive};
use crate::sim::{Dimension, IndexLists, Solids};
use glam::DVec3;
use sha2::{Digest, Sha256};

/// Where the lists of a body stand.
#[derive(Clone, Debug)]
pub(super) struct ListSource<'a> {
    /// The place of the body in the scene.
    pub(super) body: Here<'a>,
    /// The file that has the lists, and the place of its name in the scene; `None` if the scene has them.
    pub(super) file: Option<(String, Here<'a>)>,
}

impl ListSource<'_> {
    /// The name of a list or an entry in messages.
    pub(super) fn name(&self, key: &str, at: &[usize]) -> String {
        let indices: String = at.iter().map(|index| format!("[{index}]")).collect();
        match &self.file {
            None => format!("{}.{key}{indices}", self.body),
            Some((file, _)) => format!("{file}: {key}{indices}"),
        }
    }

    /// Reports a mistake in an entry of a list. In a file it is reported at the file's name in the scene, so that the message has to
    /// name list and entry.
    pub(super) fn report(&self, key: &str, at: &[usize], message: String, help: impl Help) {
        let Some((_, file)) = &self.file else {
            let list = self.body.to(key);
            return at.iter().fold(list, |here, &index| here.to(index)).wrong(message, help);
        };
        let named = message.contains(&format!("`{}", self.name(key, &at[..at.len().min(1)])));
        let message = if named { message } else { format!("`{}`: {message}", self.name(key, at)) };
        file.wrong(message, help);
    }

    /// Reports a mistake whose message begins with the name of a list or an entry.
    pub(super) fn say(&self, key: &str, at: &[usize], message: &str) {
        self.report(key, at, format!("`{}` {message}", self.name(key, at)), None);
    }

    /// Reports a list without exactly one entry for each node.
    pub(super) fn check_count(&self, key: &str, length: usize, nodes: usize) {
        if length != nodes {
            let (name, entries) = (self.name(key, &[]), if length == 1 { "entry" } else { "entries" });
            let message =
                format!("`{name}` has {length} {entries}, and the body has {nodes} nodes; expected one for each");
            match self.file {
                None => self.body.to(key).wrong_key(message, None),
                Some(_) => self.report(key, &[], message, None),
            }
        }
    }

    /// Reports coordinates that are not finite or too large.
    pub(super) fn check_points(&self, key: &str, points: &[DVec3]) {
        let is_wrong = |point: &DVec3| !point.is_finite() || point.abs().max_element() > LARGEST;
        for (row, point) in points.iter().enumerate().filter(|(_, point)| is_wrong(point)) {
            let wrong = point.to_array().into_iter().enumerate().filter_map(|(axis, at)| Some((axis, beyond(at)?)));
            wrong.for_each(|(axis, message)| self.say(key, &[row, axis], &message));
        }
    }

    /// Reports masses that are not finite, too large or not above zero.
    pub(super) fn check_masses(&self, key: &str, masses: &[f64]) {
        for (row, &mass) in masses.iter().enumerate() {
            let too_small = || (mass <= 0.0).then(|| format!("is {mass}; expected a number greater than 0"));
            beyond(mass).or_else(too_small).into_iter().for_each(|message| self.say(key, &[row], &message));
        }
    }

    /// Reports rows with fewer nodes than they need.
    pub(super) fn check_rows(&self, key: &str, rows: &IndexLists, least: usize) {
        for (row, list) in rows.iter().enumerate().filter(|(_, list)| list.len() < least) {
            let nodes = if list.len() == 1 { "node" } else { "nodes" };
            self.say(key, &[row], &format!("has {} {nodes}; expected at least {least}", list.len()));
        }
    }
}

/// The message for a number that is not finite or too large.
fn beyond(number: f64) -> Option<String> {
    let expected = if number.is_finite() { format!("a magnitude up to {LARGEST:e}") } else { "a finite number".into() };
    (number.is_nan() || number.abs() > LARGEST).then(|| format!("is {number}; expected {expected}"))
}

/// The lists of a body.
#[derive(Clone, Debug)]
pub(super) struct Lists<'a> {
    pub(super) source: ListSource<'a>,
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

impl<'a> Lists<'a> {
    /// Nodes and elements alone.
    pub(super) fn new(source: ListSource<'a>, dimension: Dimension, nodes: Vec<DVec3>, elements: IndexLists) -> Self {
        let (springs, faces, positions, velocities, masses) = Default::default();
        let solids = Solids::Ordered;
        Self { source, dimension, nodes, elements, solids, springs, faces, positions, velocities, masses }
    }

    /// The lists of a scene with nodes. Mistakes that the schema does not find are reported: points with another number of
    /// coordinates, and in a scene made in code all numbers out of range and short rows.
    pub(super) fn typed(file: &BodyFile, body: Here<'a>) -> Option<Self> {
        let nodes = file.nodes.as_ref()?;
        let dimension = if nodes.first()?.0.len() == 2 { Dimension::Plane } else { Dimension::Space };
        let source = ListSource { body, file: None };
        let points = |typed: &Option<Vec<Coordinates>>, key: &'static str| {
            let mut here = source.body.to(key).to(0);
            let point = |(row, typed)| {
                here.go_to(row);
                vector(typed, dimension, &here).unwrap_or_default()
            };
            let points: Vec<_> = typed.as_ref()?.iter().enumerate().map(point).collect();
            source.check_points(key, &points);
            Some(points)
        };
        let (nodes, positions) = (points(&file.nodes, "nodes")?, points(&file.positions, "positions"));
        let velocities = points(&file.velocities, "velocities");
        let masses: Option<Vec<_>> = file.masses.as_ref().map(|all| all.iter().map(|&Positive(mass)| mass).collect());
        masses.iter().for_each(|masses| source.check_masses("masses", masses));
        let rows = |typed: &Option<Vec<Vec<u32>>>, key, least| {
            let rows: IndexLists = typed.as_ref()?.iter().map(Vec::as_slice).collect();
            source.check_rows(key, &rows, least);
            Some(rows)
        };
        let (elements, faces) = (rows(&file.elements, "elements", 2), rows(&file.faces, "faces", 3));
        let springs = file.springs.clone();
        let lists = Self::new(source, dimension, nodes, elements.unwrap_or_default());
        Some(Self { springs, faces, positions, velocities, masses, ..lists })
    }

    /// Reports a key of the scene that conflicts with an array of the file.
    pub(super) fn check_exclusive(&self, typed: bool, key: &str, array: &str) {
        if typed {
            let here = self.source.body.to(key);
            let message = format!("`{here}` and `{}` exclude each other", self.source.name(array, &[]));
            here.wrong_key(message, "keep one");
        }
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
        hexadecimal(&hasher.finalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::collector::Collector;
    use toml::de::DeTable;

    #[test]
    fn hulls_have_another_digest_than_ordered_elements() {
        let root = DeTable::new();
        let report = Collector::of_code(&root);
        let source = ListSource { body: report.root(), file: None };
        let elements = [&[0, 1, 2, 3][..]].into_iter().collect();
        let lists = Lists::new(source, Dimension::Space, vec![DVec3::ZERO; 4], elements);
        assert_ne!(lists.digest(), Lists { solids: Solids::Convex, ..lists.clone() }.digest());
    }
}
