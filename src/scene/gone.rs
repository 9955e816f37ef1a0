//! Keys and values of scene and figure files that are gone, and what to write instead.

use crate::reading::collector::PathPart;

/// A key or a value that is gone.
struct Gone {
    /// The path of the key, without the indices of entries.
    key: &'static str,
    /// The removed value; `None` if the whole key is gone.
    value: Option<&'static str>,
    /// What to write instead.
    instead: &'static str,
}

const fn key(key: &'static str, instead: &'static str) -> Gone {
    Gone { key, value: None, instead }
}

const fn value(key: &'static str, value: &'static str, instead: &'static str) -> Gone {
    Gone { key, value: Some(value), instead }
}

/// For parts of pictures that became words in the list of labels. A list replaces the usual one.
const ALL_LABELS: &str = "write `labels = [\"letters\", \"name\", \"model\", \"clock\", \"count\", \"number\", \"scale-bar\", \
                          \"legend\"]` without the words for parts that are not shown";

const CHARTS: &str = "write `charts = [\"DIAGNOSTIC\"]`, such as `charts = [\"energy\"]`";

#[rustfmt::skip]
const GONE: &[Gone] = &[
    key("time.sleep", "remove it"),
    value("time.integrator", "forest-ruth", "write `\"pefrl\"`"),
    value("time.integrator", "blanes-moan", "write `\"pefrl\"`"),
    value("time.integrator", "quinlan-tremaine", "write `\"pefrl\"`"),
    value("run.integrator", "forest-ruth", "write `\"pefrl\"`"),
    value("run.integrator", "blanes-moan", "write `\"pefrl\"`"),
    value("run.integrator", "quinlan-tremaine", "write `\"pefrl\"`"),
    value("run.model.rotation", "symmetric", "write `\"robust\"`"),
    value("run.model.rotation", "cayley", "write `\"robust\"`"),
    value("run.model.rotation", "quintic", "write `\"robust\"`"),
    value("run.model.rotation", "mueller", "write `\"robust\"`"),
    value("run.model.rotation", "kugelstadt", "write `\"robust\"`"),
    value("run.model.rotation", "closed-form", "write `\"robust\"`"),
    value("run.model.rotation", "davenport", "write `\"robust\"`"),
    value("view.background", "transparent", "write a colour"),
    key("view.camera.follow", "for `false`, write `target` or `distance`, which fix the camera; for `true`, remove it: the camera follows the body"),
    key("view.colours", "remove it; `theme`, `background`, and `colour` in each `[[run]]` remain"),
    key("view.difference", "write `colour = { by = \"distance\", to = \"RUN\" }`"),
    key("view.difference_of", "remove it"),
    key("view.columns", "write the number in `view.panels`"),
    key("view.explode", "remove it"),
    key("view.hatch", "remove it; turned-over elements are always hatched"),
    key("view.inset", "remove it"),
    key("view.legend", ALL_LABELS),
    key("view.letters", ALL_LABELS),
    key("view.line_scale", "remove it"),
    key("view.margin", "remove it"),
    key("view.light", "remove it"),
    key("view.opacity", "remove it; elements that are turned over show through the others"),
    key("view.outline", "remove it; outlines are always drawn"),
    key("view.points", "remove it"),
    key("view.scale_bar", ALL_LABELS),
    key("sheet.strips", CHARTS),
    key("view.strip", CHARTS),
    key("view.spring_colour", "write `colour = { by = \"strain\", range = [-0.3, 0.3], map = \"violet-green\" }`, and `show` without `\"surfaces\"`"),
];

/// What to write instead of a key that is gone, or of one of its values.
pub(super) fn instead(path: &[PathPart<'_>], value: Option<&str>) -> Option<&'static str> {
    let keys = path.iter().filter_map(|part| if let PathPart::Key(key) = part { Some(*key) } else { None });
    let is_at = |gone: &&Gone| gone.value == value && gone.key.split('.').eq(keys.clone());
    GONE.iter().find(is_at).map(|gone| gone.instead)
}

#[cfg(test)]
mod tests {
    use super::GONE;
    use crate::scene::{Limits, Scene};
    use toml::{Table, Value};

    #[test]
    fn each_key_that_is_gone_has_one_message() {
        let scene = "
            time.duration = 1
            body.lattice = { cells = [1, 1, 1], side = 0.1 }
            run = [{ name = 'Local shape', model = { kind = 'shape-based', stiffness = 1e4 } }]
            view.theme = 'light'";
        // `tests/scene/figures.rs` tests keys of figure files.
        for gone in GONE.iter().filter(|gone| !gone.key.starts_with("sheet")) {
            let mut scene: Table = scene.parse().expect("TOML");
            let (tables, last) = gone.key.rsplit_once('.').expect("a key of a table");
            let table = tables.split('.').fold(&mut scene, |table, key| {
                let inner = table.entry(key).or_insert_with(|| Value::Table(Table::new()));
                match inner {
                    Value::Array(entries) => entries[0].as_table_mut(),
                    inner => inner.as_table_mut(),
                }
                .expect("a table")
            });
            table.insert(last.to_owned(), gone.value.unwrap_or("anything").into());
            let error = Scene::parse(&scene.to_string(), "old.toml", &Limits::default()).expect_err(gone.key);
            let [mistake] = error.mistakes() else { panic!("{error}") };
            let value = gone.value.map_or_else(String::new, |value| format!(" = \"{value}\""));
            assert!(mistake.message.ends_with(&format!("{last}{value}` is gone")), "{error}");
            assert_eq!(mistake.help.as_deref(), Some(gone.instead));
        }
    }
}
