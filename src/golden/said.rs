//! The keys and values of a scene file, so that a golden can name those changed.

use super::keys::Key;
use crate::reading::words::hexadecimal;
use crate::scene::Scene;
use crate::scene::figure::Figure;
use sha2::{Digest, Sha256};
use std::path::Path;
use toml::Value;

/// A value with more characters is replaced by its digest.
const LONGEST: usize = 100;

/// The keys of a scene, with the step of each run in seconds: it may follow from the stiffness of another run.
pub(super) fn of_scene(scene: &Scene) -> Vec<Key> {
    let mut keys = scene.file.as_ref().map_or_else(Vec::new, |file| of_file(file));
    for (at, run) in scene.runs.iter().enumerate() {
        let path = format!("run[{at}].step");
        keys.retain(|key| key.path != path);
        keys.push(Key { path, value: format!("{} s", run.step) });
    }
    keys
}

/// The keys of a figure file, and those of its scenes.
pub(super) fn of_figure(path: &Path, figure: &Figure) -> Vec<Key> {
    let of_scene = |scene: &Scene| {
        let name = scene.name.clone();
        of_scene(scene).into_iter().map(move |key| Key { path: format!("{name}: {}", key.path), ..key })
    };
    of_file(path).into_iter().chain(figure.scenes().iter().flat_map(of_scene)).collect()
}

/// The keys of a file that was read before.
fn of_file(path: &Path) -> Vec<Key> {
    let mut keys = Vec::new();
    let text = std::fs::read_to_string(path).unwrap_or_default();
    if let Ok(table) = text.parse::<toml::Table>() {
        let folder = path.parent().unwrap_or(Path::new(""));
        table.into_iter().for_each(|(name, value)| add(&mut keys, folder, name, value));
    }
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
            keys.push(Key { path, value });
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
    use crate::scene::Limits;

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
        let before = of_scene(&scene(folder.path(), text));
        let told = |after: &str| -> Vec<String> {
            changed(&before, &of_scene(&scene(folder.path(), after))).iter().map(ToString::to_string).collect()
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
    fn long_lists_and_files_are_named_by_their_digests() {
        let folder = tempfile::tempdir().expect("a folder");
        let keys = |text: &str| {
            let path = folder.path().join("any.toml");
            std::fs::write(&path, text).expect("a file");
            of_file(&path)
        };
        let list =
            |last: u32| format!("body.nodes = {:?}", (0..60).chain([last]).map(|at| [at, 1]).collect::<Vec<_>>());
        let [one, other] = [60, 61].map(|last| keys(&list(last)));
        assert!(one[0].value.starts_with("digest ") && one[0].value.len() == 19 && one != other, "{one:?}");
        std::fs::write(folder.path().join("body.npz"), "one").expect("a file");
        let before = keys("body.file = 'body.npz'");
        std::fs::write(folder.path().join("body.npz"), "two").expect("a file");
        let told = changed(&before, &keys("body.file = 'body.npz'"));
        assert!(told[0].to_string().starts_with("body.file: \"body.npz\", digest "), "{told:?}");
    }
}
