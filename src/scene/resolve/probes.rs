//! Nodes with a name, whose displacement is measured.

use super::choice::check_names;
use super::nodes::select;
use super::{Typed, obstacles};
use crate::reading::collector::{Collector, key_path};
use crate::reading::words::quoted;
use crate::scene::file::ProbeFile;
use crate::scene::{Probe, SceneBody};

/// The probes, or `None` after reporting every mistake in them.
pub(super) fn resolve(scene: &Typed<'_>, bodies: &[SceneBody], report: &mut Collector<'_>) -> Option<Vec<Probe>> {
    let typed = || scene.file.probe.iter().enumerate();
    let named = typed().map(|(at, probe)| (key_path!["probe", at].to_vec(), probe.as_ref().map(|one| &*one.name)));
    check_names(["probe", "probes"], named, report);
    let others = obstacles::names(scene.file);
    let places = |key: &'static str, count: usize| (0..count).map(move |at| format!("{key}[{at}]"));
    let grips: Vec<_> = places("hold", scene.file.hold.len()).chain(places("grab", scene.file.grab.len())).collect();
    let probe = |(at, typed): (usize, &Option<ProbeFile>)| {
        let (typed, path) = (typed.as_ref()?, key_path!["probe", at]);
        let kinds = [
            ("a body", bodies.iter().any(|body| body.name == typed.name)),
            ("an obstacle", others.contains(&typed.name)),
            ("a constraint", grips.contains(&typed.name)),
        ];
        if let Some((other, _)) = kinds.into_iter().find(|(_, is_called)| *is_called) {
            let message = format!("{other} and a probe are called {}", quoted(&typed.name));
            report.at(&key_path![path; "name"], message, "give the probe another name");
        }
        let nodes = select(typed.body.as_deref(), Some(&typed.nodes), bodies, (&path, "nodes"), report)?;
        Some(Probe { name: typed.name.clone(), nodes })
    };
    let all: Vec<_> = typed().map(probe).collect();
    all.into_iter().collect()
}
