//! Invariants of `ARCHITECTURE.md` that the compiler does not check, tested on the source.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Every Rust file of a module, which is a folder or one file of `src`, with its text up to its tests.
fn sources(room: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let room_at = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(room);
    let mut left = vec![if room_at.is_dir() { room_at } else { room_at.with_extension("rs") }];
    while let Some(path) = left.pop() {
        if path.is_dir() {
            let entries = std::fs::read_dir(&path).expect("a readable folder");
            left.extend(entries.map(|entry| entry.expect("a readable folder").path()));
        } else {
            if path.extension().is_some_and(|ending| ending == "rs") {
                let text = std::fs::read_to_string(&path).expect("a readable file");
                found.push((path, text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().to_owned()));
            }
        }
    }
    assert!(!found.is_empty(), "src/{room} has no source");
    found
}

/// Lines of code, without comments, that contain one of the words.
fn offenders(room: &str, words: &[&str]) -> Vec<String> {
    let mut lines = Vec::new();
    for (path, text) in sources(room) {
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            if words.iter().any(|word| code.contains(word)) {
                lines.push(format!("{}:{}: {}", path.display(), number + 1, line.trim()));
            }
        }
    }
    lines
}

/// The modules of the crate that a module uses; also itself, if it uses itself by a full path.
fn rooms_named_by(room: &str) -> BTreeSet<String> {
    let mut rooms = BTreeSet::new();
    for (_, text) in sources(room) {
        let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
        for named in code.flat_map(|line| line.split("crate::").skip(1)) {
            // A list in braces has several.
            assert!(!named.starts_with('{'), "one `use` for each room: {named}");
            rooms.insert(named.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect());
        }
    }
    rooms
}

#[test]
fn pictures_do_not_simulate() {
    assert_eq!(offenders("picture", &["World", "Runner", ".prepare(", ".forces(", ".world("]), [""; 0]);
}

#[test]
fn only_gpu_and_render_name_wgpu() {
    for room in
        ["colour", "reading", "look", "scene", "runner", "picture", "vector", "output", "golden", "animation", "cli"]
    {
        assert_eq!(offenders(room, &["wgpu"]), [""; 0]);
    }
}

/// Double precision is converted to single precision in one file, relative to the panel's origin, and in another one for formats of
/// other programs.
#[test]
fn one_place_narrows() {
    for room in ["picture", "output/export"] {
        let narrowing = offenders(room, &["as f32", "as_vec2(", "as_vec3(", "as_mat4(", "as_quat("]);
        let elsewhere: Vec<_> = narrowing.iter().filter(|line| !line.contains("narrow.rs:")).collect();
        assert_eq!(elsewhere, [""; 0]);
        assert!(!narrowing.is_empty());
    }
}

#[test]
fn nothing_flows_back() {
    // A macro of `reading` names `reading`.
    assert_eq!(rooms_named_by("reading"), BTreeSet::from(["reading", "sim"].map(str::to_owned)));
    assert_eq!(rooms_named_by("look"), BTreeSet::from(["colour", "reading", "sim"].map(str::to_owned)));
    assert_eq!(
        offenders("scene", &["crate::picture", "crate::gpu", "crate::render", "crate::output", "crate::cli"]),
        [""; 0]
    );
    assert_eq!(offenders("colour", &["crate::"]), [""; 0]);
    assert_eq!(offenders("picture", &["crate::gpu", "crate::render", "crate::output", "crate::cli"]), [""; 0]);
    assert_eq!(offenders("render", &["crate::sim", "crate::scene", "crate::output", "crate::cli"]), [""; 0]);
    assert_eq!(offenders("gpu", &["crate::sim", "crate::scene", "crate::picture", "crate::render"]), [""; 0]);
    assert_eq!(offenders("output", &["crate::cli"]), [""; 0]);
    // It uses only the encoder of PNG of `output`, and of `reading` the escaping of words.
    assert_eq!(rooms_named_by("vector"), BTreeSet::from(["colour", "output", "picture", "reading"].map(str::to_owned)));
    // Pictures are its input; of `picture` it uses only fonts.
    let outside = ["crate::sim", "crate::scene", "crate::gpu", "crate::render", "crate::cli"];
    assert_eq!(offenders("animation", &outside), [""; 0]);
    for file in ["history", "moments"] {
        let outside = ["crate::picture", "crate::gpu", "crate::render", "crate::output", "crate::cli"];
        assert_eq!(offenders(&format!("runner/{file}"), &outside), [""; 0]);
    }
}

/// The simulation, as read and resolved, does not depend on pictures: bodies, motions, obstacles, grips and steps.
#[test]
fn the_physics_of_a_scene_knows_no_drawing() {
    let files = ["file/body", "file/motion", "file/obstacle", "resolve/body", "resolve/elements", "resolve/grips"];
    let others = ["resolve/lists", "resolve/motion", "resolve/obstacles", "generate", "limits", "npz", "step"];
    for file in files.iter().chain(&others) {
        assert_eq!(offenders(&format!("scene/{file}"), &["look", "colour", "Camera", "pixel"]), [""; 0]);
    }
}

/// Every numbered equation of the paper can be found by a text search (Eqs. 7 and 11–14 in the map of the paper).
#[test]
fn every_equation_can_be_found() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/paper.md")).expect("the map");
    let code: String = sources("../sim/src").into_iter().map(|(_, text)| text).collect();
    for number in [1, 2, 3, 4, 5, 8, 9, 10, 15, 16, 17, 18] {
        assert!(code.contains(&format!("doc(alias = \"Eq. {number}\")")), "Eq. {number} has no search alias");
    }
    for range in ["Eq. (6)", "Eqs. (7)–(9)", "Eqs. (11)–(14)"] {
        assert!(page.contains(range), "{range} is missing in docs/paper.md");
    }
}

/// The front page of the documentation has `examples/from_code.rs`, except for hidden lines.
#[test]
fn the_front_page_shows_the_example() {
    let read = |name: &str| std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).expect("a file");
    let (front, example) = (read("src/lib.rs"), read("examples/from_code.rs"));
    let page = front.split("//! # From code to a picture").nth(1).and_then(|rest| rest.split("//! ```\n").next());
    let lines =
        page.expect("the section").lines().filter_map(|line| line.strip_prefix("//! ").or(line.strip_prefix("//!")));
    let shown: Vec<_> = lines.skip(1).filter(|line| !line.starts_with('#')).collect();
    let code: Vec<_> = example.lines().skip_while(|line| !line.starts_with("use ")).collect();
    assert_eq!(shown, code);
}

/// The dependency table of `CONTRIBUTING.md` has the dependencies of the manifests of the library and of its meshes, and no
/// others.
#[test]
fn every_dependency_has_its_reason() {
    let read = |name: &str| std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).expect("a file");
    let page = read("CONTRIBUTING.md");
    let mut names = BTreeSet::new();
    for manifest in ["Cargo.toml", "mesh/Cargo.toml"] {
        let manifest: toml::Table = read(manifest).parse().expect("a manifest");
        let targets = manifest.get("target").and_then(toml::Value::as_table);
        let of_targets = targets.into_iter().flat_map(toml::Table::values).map(|target| &target["dependencies"]);
        let tables = manifest.get("dependencies").into_iter().chain(manifest.get("dev-dependencies")).chain(of_targets);
        names.extend(tables.flat_map(|table| table.as_table().expect("a table").keys().cloned()));
    }
    let table = page.split("## Dependencies").nth(1).expect("the section");
    let rows = table.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    let listed: BTreeSet<_> =
        rows.flat_map(|cell| cell.split(", ")).map(|name| name.trim_matches('`').to_owned()).collect();
    assert_eq!(listed, names);
}
