//! Nodes with a name, whose displacement is measured.

use super::choice::check_names;
use super::nodes::select;
use super::{Typed, obstacles};
use crate::reading::collector::Here;
use crate::reading::words::quoted;
use crate::scene::file::ProbeFile;
use crate::scene::{Probe, SceneBody};

/// The probes, without those with mistakes, which are reported.
pub(super) fn resolve(scene: &Typed<'_>, bodies: &[SceneBody]) -> Vec<Probe> {
    let typed = || scene.each("probe", &scene.file.probe);
    check_names(["probe", "probes"], typed().map(|(here, probe)| (here, Some(&*probe.name))));
    let others = obstacles::names(scene.file);
    let places = |key: &'static str, count: usize| (0..count).map(move |at| format!("{key}[{at}]"));
    let grips: Vec<_> = places("hold", scene.file.hold.len()).chain(places("grab", scene.file.grab.len())).collect();
    let probe = |(here, typed): (Here<'_>, &ProbeFile)| {
        let kinds = [
            ("a body", bodies.iter().any(|body| body.name == typed.name)),
            ("an obstacle", others.contains(&typed.name)),
            ("a constraint", grips.contains(&typed.name)),
        ];
        if let Some((other, _)) = kinds.into_iter().find(|(_, is_called)| *is_called) {
            let message = format!("{other} and a probe are called {}", quoted(&typed.name));
            here.to("name").wrong(message, "give the probe another name");
        }
        let nodes = select(typed.body.as_deref(), Some(&typed.nodes), bodies, (&here, "nodes"))?;
        Some(Probe { name: typed.name.clone(), nodes })
    };
    typed().filter_map(probe).collect()
}
