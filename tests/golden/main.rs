//! This project's own goldens: every primitive of drawing, every shipped scene and every shipped figure.
//!
//! Each has a folder `NAME/` here with small pictures and `golden.toml`, a record of all its states. So a failure
//! reports whether the physics changed, at which node and from which frame on, or only the drawing. Primitives are the
//! scenes beside their goldens in `primitives/`. Pictures without lit bodies must be equal, as no driver rounds them.
//!
//! `UPDATE_GOLDENS=1 cargo test --release --test golden` makes and renews goldens, and lists accepted changes; then
//! look at every changed picture.
#![cfg(feature = "render")]

mod suite;

use localshape::golden::Suite;
use localshape::gpu::{self, AdapterChoice};
use localshape::internals::read_tags;
use std::path::{Path, PathBuf};

/// The kind of adapter that draws the goldens.
const USUAL: &str = "llvmpipe";

/// Greatest size of all goldens together (bytes): some 80 kB for each shipped scene.
const LARGEST: u64 = 12 * 256 * 1024;
/// Greatest size of one golden (bytes).
const LARGEST_GOLDEN: u64 = 96 * 1024;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The scene and figure files in a folder, by name.
fn files(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join(folder)).expect("a folder of scenes or figures");
    let paths = entries.map(|entry| entry.expect("a readable folder").path());
    let mut files: Vec<_> = paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    files.sort();
    assert!(!files.is_empty(), "{folder}");
    files
}

/// A folder of goldens, the folder of their scenes, and the number of pictures of new ones.
const SETS: [(&str, &str, u64); 5] = [
    ("tests/golden/primitives", "tests/golden/primitives", 1),
    ("tests/golden/scenes", "scenes", 1),
    ("tests/golden/elements", "scenes/elements", 1),
    ("tests/golden/contact", "scenes/contact", 1),
    ("tests/golden/figures", "figures", 1),
];

fn check(goldens: &str, adapter: Option<&str>) {
    let (_, folder, pictures) = SETS.into_iter().find(|set| set.0 == goldens).expect("one of the sets");
    let reports = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden").join(adapter.unwrap_or_default()).join(folder);
    let mut suite = Suite::new(root().join(goldens)).pictures(pictures).reports(reports);
    // Other processors and C libraries round differently.
    if cfg!(all(target_arch = "x86_64", target_env = "gnu")) {
        suite = suite.exact();
    }
    if let Some(adapter) = adapter {
        suite = suite.on(AdapterChoice::Named(adapter.to_owned()));
    }
    for file in files(folder) {
        suite.scene(file);
    }
    suite.finish();
}

#[test]
fn primitives() {
    check("tests/golden/primitives", None);
}

#[test]
fn scenes() {
    check("tests/golden/scenes", None);
}

#[test]
fn scenes_of_elements() {
    check("tests/golden/elements", None);
}

#[test]
fn scenes_of_contact() {
    check("tests/golden/contact", None);
}

#[test]
fn figures() {
    check("tests/golden/figures", None);
}

/// With other adapters of this machine, such as a GPU, states have the same bits, and pictures of lit bodies are within the
/// tolerance.
#[test]
fn other_adapters() {
    if std::env::var_os("UPDATE_GOLDENS").is_some() {
        // The other tests write files.
        return;
    }
    let mut others: Vec<_> = gpu::adapters().0.into_iter().map(|adapter| adapter.name).collect();
    others.retain(|name| !name.starts_with(USUAL));
    others.dedup();
    if others.is_empty() {
        assert!(std::env::var("LOCALSHAPE_REQUIRE_OTHER_ADAPTER").is_err(), "there is one graphics adapter only");
        localshape::internals::skipped("this machine has one graphics adapter only");
    }
    for name in others {
        for (goldens, ..) in SETS {
            check(goldens, Some(&name));
        }
    }
}

#[test]
fn goldens_are_small_and_drawn_by_one_kind_of_adapter() {
    if std::env::var_os("UPDATE_GOLDENS").is_some() {
        return;
    }
    let size = |path: &Path| -> u64 {
        let entries = std::fs::read_dir(path).expect("a readable folder").map(|entry| entry.expect("an entry"));
        entries.map(|entry| entry.metadata().expect("a file").len()).sum()
    };
    let mut all = 0;
    for (goldens, ..) in SETS {
        for entry in std::fs::read_dir(root().join(goldens)).expect("a folder of goldens") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                let size = size(&path);
                for file in std::fs::read_dir(&path).expect("a golden").map(|entry| entry.expect("an entry").path()) {
                    let tags = read_tags(&file).expect("a file");
                    // Pictures without lit bodies are drawn without an adapter.
                    let is_usual =
                        tags.is_none_or(|(_, tags)| tags.adapter == "none" || tags.adapter.starts_with(USUAL));
                    assert!(is_usual, "{}: drawn by another adapter", file.display());
                }
                assert!(size <= LARGEST_GOLDEN, "{}: {size} bytes, make its pictures smaller", path.display());
                all += size;
            }
        }
    }
    assert!(all <= LARGEST, "all goldens together: {all} bytes");
}
