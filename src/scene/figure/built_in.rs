//! The built-in figures and their scenes, so that they exist wherever the program runs.

use std::path::{Component, Path, PathBuf};

/// The names of the built-in figures, in the paper's order.
pub(crate) const NAMES: [&str; 7] = ["fig1", "fig2", "fig3", "fig4a", "fig4b", "fig4c", "restore"];

/// The texts by their paths.
macro_rules! texts {
    ($($path:literal,)*) => {
        const TEXTS: &[(&str, &str)] = &[$(($path, include_str!(concat!("../../../", $path))),)*];
    };
}

texts! {
    "figures/fig1.toml",
    "figures/fig2.toml",
    "figures/fig3.toml",
    "figures/fig4a.toml",
    "figures/fig4b.toml",
    "figures/fig4c.toml",
    "figures/restore.toml",
    "scenes/fig4a.toml",
    "scenes/fig4b.toml",
    "scenes/fig4c.toml",
    "scenes/elements/triangle-pushed-in.toml",
    "scenes/elements/triangle-turned-over.toml",
    "scenes/elements/square.toml",
    "scenes/elements/polygon.toml",
    "scenes/elements/cube.toml",
    "scenes/elements/restore-point.toml",
    "scenes/elements/restore-line.toml",
    "scenes/elements/restore-plane.toml",
    "scenes/elements/restore-mirror.toml",
    "scenes/elements/restore-cloud-1.toml",
    "scenes/elements/restore-cloud-2.toml",
}

/// The path of a figure's text.
pub(super) fn path(name: &str) -> Option<PathBuf> {
    NAMES.contains(&name).then(|| PathBuf::from(format!("figures/{name}.toml")))
}

pub(super) fn text(path: &Path) -> Option<&'static str> {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(parts.pop()),
            Component::Normal(name) => parts.push(name.to_str()?),
            _ => {}
        }
    }
    let path = parts.join("/");
    TEXTS.iter().find(|(known, _)| *known == path).map(|(_, text)| *text)
}
