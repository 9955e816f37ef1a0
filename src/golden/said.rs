//! The keys and values of a scene file, so that a golden can name those changed.

use super::keys::Key;
use crate::reading::words::hexadecimal;
use crate::scene::figure::Figure;
use crate::scene::{Scene, SceneKeys, Setting, keys_in_memory, keys_of};
use sha2::{Digest, Sha256};
use std::path::Path;
use toml::{Table, Value};

/// A value with more characters is replaced by its digest.
const LONGEST: usize = 100;

/// The keys of a scene with settings, whose keys may be in memory, and the step of each run in seconds: it may follow from the stiffness
/// of another run.
pub(super) fn of_scene(scene: &Scene, in_memory: Option<&SceneKeys>, settings: &[Setting]) -> Vec<Key> {
    let mut keys = match (in_memory, &scene.file) {
        (Some(keys), _) => listed(keys_in_memory(keys, settings), Path::new("")),
        (None, Some(file)) => of_file(file, settings),
        (None, None) => Vec::new(),
    };
    for (at, run) in scene.runs.iter().enumerate() {
        let path = format!("run[{at}].step");
        keys.retain(|(other, _)| *other != path);
        keys.push((path, format!("{} s", run.step)));
    }
    keys
}

/// The keys of a figure file, and those of its scenes.
pub(super) fn of_figure(path: &Path, figure: &Figure) -> Vec<Key> {
    let of_scene = |scene: &Scene| {
        let name = scene.name.clone();
        of_scene(scene, None, &[]).into_iter().map(move |(path, value)| (format!("{name}: {path}"), value))
    };
    of_file(path, &[]).into_iter().chain(figure.scenes().iter().flat_map(of_scene)).collect()
}

/// The keys of a file that was read before, with settings.
fn of_file(path: &Path, settings: &[Setting]) -> Vec<Key> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    listed(keys_of(&text, settings), path.parent().unwrap_or(Path::new("")))
}

/// The keys in a table, which name files in a folder.
fn listed(table: Table, folder: &Path) -> Vec<Key> {
    let mut keys = Vec::new();
    table.into_iter().for_each(|(name, value)| add(&mut keys, folder, name, value));
    keys
}

/// The keys of scenes and figures whose values name other files: of a body, of fonts, of a scene.
const FILES: [&str; 4] = ["file", "regular", "semi_bold", "scene"];

fn add(keys: &mut Vec<Key>, folder: &Path, path: String, value: Value) {
    let is_table = |value: &Value| matches!(value, Value::Table(_));
    match value {
        Value::Table(table) => {
            table.into_iter().for_each(|(name, value)| add(keys, folder, format!("{path}.{name}"), value));
        }
        Value::Array(items) if items.iter().any(is_table) => {
            items.into_iter().enumerate().for_each(|(at, item)| add(keys, folder, format!("{path}[{at}]"), item));
        }
        value => {
            let is_file = FILES.contains(&path.rsplit('.').next().unwrap_or_default());
            let beside = value.as_str().filter(|_| is_file).and_then(|name| std::fs::read(folder.join(name)).ok());
            let text = written(&value);
            let value = match beside {
                // A file beside the scene, such as the body.
                Some(bytes) => format!("{text}, {}", digest(&bytes)),
                None if text.len() > LONGEST => digest(text.as_bytes()),
                None => text,
            };
            keys.push((path, value));
        }
    }
}

/// A value on one line. Equal numbers are written alike.
fn written(value: &Value) -> String {
    match value {
        Value::Float(number) => number.to_string(),
        Value::Array(items) => format!("[{}]", items.iter().map(written).collect::<Vec<_>>().join(", ")),
        value => value.to_string(),
    }
}

/// The start of a digest.
fn digest(bytes: &[u8]) -> String {
    format!("digest {}", hexadecimal(&Sha256::digest(bytes)[..6]))
}

#[cfg(test)]
mod tests {
    use super::super::keys::changed;
    use super::*;
    use crate::scene::{BodyLists, Limits};

    fn scene(folder: &Path, text: &str) -> Scene {
        let path = folder.join("scene.toml");
        std::fs::write(&path, text).expect("a file");
        Scene::load(&path, &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn changed_keys_have_their_paths_and_values() {
        let folder = tempfile::tempdir().expect("a folder");
        let text = "
            time = { duration = 0.1, step = 'T/50', frames_per_second = 60 }
            body.lattice = { cells = [1, 1, 1], side = 0.1 }
            gravity = [0, -9.8, 0]
            [[run]]
            name = 'one'
            model = { kind = 'shape-based', stiffness = 1e4 }
            [[run]]
            name = 'other'
            model = { kind = 'mass-spring', stiffness = 2e4 }
        ";
        let before = of_scene(&scene(folder.path(), text), None, &[]);
        let told = |after: &str| -> Vec<String> {
            changed(&before, &of_scene(&scene(folder.path(), after), None, &[]))
                .iter()
                .map(ToString::to_string)
                .collect()
        };
        // Changed comments and notations of numbers are not reported.
        assert_eq!(told(&text.replace("1e4 }", "10000.0 } # ten thousand")), [""; 0]);
        let stiffer = told(&text.replace("stiffness = 1e4", "stiffness = 2e4, damping = 3"));
        assert_eq!(stiffer, ["run[0].model.damping: not given → 3", "run[0].model.stiffness: 10000 → 20000"]);
        // The step of all runs is a fraction of the cycle of the stiffest run.
        let shared = told(&text.replace("2e4", "8e4"));
        assert_eq!(shared[0], "run[1].model.stiffness: 20000 → 80000");
        assert!(
            shared.len() == 3 && shared[1].starts_with("run[0].step: 0.000888") && shared[1].ends_with(" s"),
            "{shared:?}"
        );
        let gone = told(&text.replace("gravity = [0, -9.8, 0]", ""));
        assert_eq!(gone, ["gravity: [0, -9.8, 0] → not given"]);
    }

    #[test]
    fn settings_and_lists_in_memory_are_keys() {
        let folder = tempfile::tempdir().expect("a folder");
        let text = "
            time = { duration = 0.1 }
            body.nodes = [[0, 0], [1, 0], [0, 1]]
            body.elements = [[0, 1, 2]]
            [[run]]
            name = 'one'
            model = { kind = 'shape-based', stiffness = 1e4 }
        ";
        let settings = ["run[\"one\"].model.stiffness=2e4", "time.frames_per_second=30"];
        let settings = settings.map(|setting| setting.parse::<Setting>().expect("a setting"));
        let scene = scene(folder.path(), text);
        let before = of_scene(&scene, None, &[]);
        let told = |after: &[Key]| changed(&before, after).iter().map(ToString::to_string).collect::<Vec<_>>();
        let set = ["run[0].model.stiffness: 10000 → 20000", "time.frames_per_second: not given → 30"];
        assert_eq!(told(&of_scene(&scene, None, &settings)), set);

        let mut keys: Table = text.parse().expect("TOML");
        let body = keys["body"].as_table_mut().expect("a table");
        body.remove("nodes");
        let nodes = |last: f64| vec![[0.0, 0.0].into(), [1.0, 0.0].into(), [0.0, last].into()];
        let in_memory = |last: f64| {
            let lists = BodyLists { nodes: Some(nodes(last)), ..BodyLists::default() };
            SceneKeys::new("scene", keys.clone(), vec![lists])
        };
        assert_eq!(told(&of_scene(&scene, Some(&in_memory(1.0)), &settings)), set);
        let moved = told(&of_scene(&scene, Some(&in_memory(2.0)), &[]));
        assert_eq!(moved, ["body.nodes: [[0, 0], [1, 0], [0, 1]] → [[0, 0], [1, 0], [0, 2]]"]);
    }

    #[test]
    fn long_lists_and_files_are_named_by_their_digests() {
        let folder = tempfile::tempdir().expect("a folder");
        let keys = |text: &str| {
            let path = folder.path().join("any.toml");
            std::fs::write(&path, text).expect("a file");
            of_file(&path, &[])
        };
        let list =
            |last: u32| format!("body.nodes = {:?}", (0..60).chain([last]).map(|at| [at, 1]).collect::<Vec<_>>());
        let [one, other] = [60, 61].map(|last| keys(&list(last)));
        assert!(one[0].1.starts_with("digest ") && one[0].1.len() == 19 && one != other, "{one:?}");
        std::fs::write(folder.path().join("body.npz"), "one").expect("a file");
        let before = keys("body.file = 'body.npz'");
        std::fs::write(folder.path().join("body.npz"), "two").expect("a file");
        let told = changed(&before, &keys("body.file = 'body.npz'"));
        assert!(told[0].to_string().starts_with("body.file: \"body.npz\", digest "), "{told:?}");
    }
}
