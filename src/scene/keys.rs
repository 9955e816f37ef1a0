//! Scenes from the keys of scene files in memory, as of a program in another language.

use super::file::{BodyFile, Coordinates, Positive, SceneFile};
use crate::reading::setting::Setting;
use serde::Serialize;
use toml::{Table, Value};

/// The lists of one body in memory, which mean the same as the keys of scene files. They are not written as text, which takes long for
/// millions of entries.
#[derive(Clone, Debug, Default)]
pub struct BodyLists {
    /// Rest position of each node (m).
    pub nodes: Option<Vec<Coordinates>>,
    /// The nodes of each element.
    pub elements: Option<Vec<Vec<u32>>>,
    /// Pairs of nodes.
    pub springs: Option<Vec<[u32; 2]>>,
    /// The nodes of each face to draw.
    pub faces: Option<Vec<Vec<u32>>>,
    /// Initial position of each node (m).
    pub positions: Option<Vec<Coordinates>>,
    /// Initial velocity of each node (m/s).
    pub velocities: Option<Vec<Coordinates>>,
    /// Mass of each node (kg).
    pub masses: Option<Vec<f64>>,
}

/// The keys of a scene file in memory, and the lists of its bodies.
#[derive(Clone, Debug)]
pub struct SceneKeys {
    /// The name of the scene, in messages and by default as its title.
    pub(super) name: String,
    /// The keys as a scene file, with the first entry of each list in memory.
    pub(super) text: String,
    /// The lists of each body.
    pub(super) lists: Vec<BodyLists>,
}

impl SceneKeys {
    /// The keys of a scene with a name, and the lists of its first bodies, which the keys do not have. Bodies without lists at the end may be left
    /// out.
    pub fn new(name: impl Into<String>, mut keys: Table, lists: Vec<BodyLists>) -> Self {
        extend(&mut keys, &lists, 1);
        let text = toml::to_string(&keys).expect("numbers, texts, and lists and tables of them");
        Self { name: name.into(), text, lists }
    }

    /// The same keys, without the name of a folder that has a name of its own in every process.
    pub fn without_folder(&self, folder: &str) -> Self {
        Self { text: self.text.replace(folder, ""), ..self.clone() }
    }

    /// The first setting of a list in memory, or of a table that contains one, whose text would be ignored.
    pub(super) fn of_lists<'s>(&self, settings: &'s [Setting]) -> Option<&'s Setting> {
        let is_list = |key: &str| self.lists.iter().any(|lists| lists.begun(1).any(|(list, _)| list == key));
        settings.iter().find(|setting| match setting.keys()[..] {
            ["body"] => self.lists.iter().any(|lists| lists.begun(1).next().is_some()),
            ["body", key, ..] => is_list(key),
            _ => false,
        })
    }
}

/// Gives bodies among the keys of a scene their lists, of which up to so many entries each: the check of a scene file looks at one, and
/// that there are lists at all.
pub(super) fn extend(keys: &mut Table, lists: &[BodyLists], most: usize) {
    for (at, lists) in lists.iter().enumerate() {
        let body = match keys.get_mut("body") {
            Some(Value::Array(several)) => several.get_mut(at),
            one => one.filter(|_| at == 0),
        };
        let table = body.and_then(Value::as_table_mut);
        table.into_iter().for_each(|table| table.extend(lists.begun(most).map(|(key, list)| (key.to_owned(), list))));
    }
}

impl BodyLists {
    /// The keys of the lists that are given, and up to so many entries of each.
    fn begun(&self, most: usize) -> impl Iterator<Item = (&'static str, Value)> {
        fn begun<T: Serialize>(list: &Option<Vec<T>>, most: usize) -> Option<Value> {
            list.as_ref().map(|list| Value::try_from(&list[..most.min(list.len())]).expect("numbers and lists of them"))
        }
        let lists = [
            ("nodes", begun(&self.nodes, most)),
            ("elements", begun(&self.elements, most)),
            ("springs", begun(&self.springs, most)),
            ("faces", begun(&self.faces, most)),
            ("positions", begun(&self.positions, most)),
            ("velocities", begun(&self.velocities, most)),
            ("masses", begun(&self.masses, most)),
        ];
        lists.into_iter().filter_map(|(key, list)| Some((key, list?)))
    }

    /// Puts the lists in place of their first entries.
    fn fill(&self, body: &mut BodyFile) {
        let Self { nodes, elements, springs, faces, positions, velocities, masses } = self.clone();
        let masses: Option<Vec<_>> = masses.map(|masses| masses.into_iter().map(Positive).collect());
        body.nodes = nodes.or(body.nodes.take());
        body.elements = elements.or(body.elements.take());
        body.springs = springs.or(body.springs.take());
        body.faces = faces.or(body.faces.take());
        body.positions = positions.or(body.positions.take());
        body.velocities = velocities.or(body.velocities.take());
        body.masses = masses.or(body.masses.take());
    }
}

impl SceneFile {
    /// Gives its bodies their lists in memory.
    pub(super) fn fill(&mut self, lists: &[BodyLists]) {
        let bodies = self.body.iter_mut().zip(lists);
        bodies.for_each(|(body, lists)| body.iter_mut().for_each(|body| lists.fill(body)));
    }
}
