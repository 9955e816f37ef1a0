//! Runs that start at rest.

use super::Typed;
use crate::reading::collector::Collector;
use crate::reading::words::{quoted, short};
use crate::scene::file::StartFile;
use crate::scene::{Rest, Run, Scene, SceneBody};
use crate::sim::{Crew, NoEquilibrium, equilibrium};
use rayon::prelude::*;

/// Moves the bodies of each run to where they are at rest, if the scene asks for it.
pub(super) fn start(typed: &Typed<'_>, scene: &mut Scene) {
    let asked = typed.file.time.as_ref().and_then(|time| time.start);
    // Without a part that has mistakes, rest would be elsewhere.
    let (Some(StartFile::Equilibrium), 0) = (asked, typed.report.total()) else { return };
    let Scene { gravity, obstacles, contacts, bodies, runs, .. } = scene;
    let all = runs.len();
    let find = |run: &Run| {
        let surroundings = run.surroundings((*gravity, 0.0), obstacles, contacts.as_ref());
        let parts: Vec<_> = run.bodies.bodies().iter().cloned().zip(run.models.iter().map(|model| &**model)).collect();
        equilibrium(&parts, &run.initial, &surroundings, run.step, Crew::new(run.threads(all)))
    };
    let found: Vec<_> = runs.par_iter().map(|run| run.recording.is_none().then(|| find(run))).collect();
    for (run, found) in runs.iter_mut().zip(found) {
        match found {
            Some(Ok(found)) => {
                warn_of_small_loads(run, found.residual, typed.report);
                run.rest = Some(Rest { residual: found.residual, evaluations: found.evaluations });
                run.placed = Some(std::mem::replace(&mut run.initial.position, found.position));
            }
            Some(Err(why)) => {
                // Other runs mostly have the same mistake.
                refuse(run, &why, bodies, typed.report);
                return;
            }
            None => {}
        }
    }
}

/// Warns of a state of rest in which round-off of the elastic forces is all that is balanced.
fn warn_of_small_loads(run: &Run, residual: f64, report: &Collector<'_>) {
    /// The share of the load above which what is left is told.
    const MUCH: f64 = 0.02;
    if residual > MUCH {
        let name = quoted(&run.name);
        let message = format!(
            "{residual:.0e} of the load is left in the state of rest of {name}: the load is as small as round-off"
        );
        report.to("time").to("start").warn(message, "give a larger load, or a softer body");
    }
}

/// Reports a run that has no state of rest.
fn refuse(run: &Run, why: &NoEquilibrium, bodies: &[SceneBody], report: &Collector<'_>) {
    let name = quoted(&run.name);
    let (why, help) = match *why {
        NoEquilibrium::Unheld { body, force } => {
            let body =
                run.of.get(body).and_then(|&body| bodies.get(body)).map_or("its body".into(), SceneBody::in_words);
            let force = short(force.length());
            (format!("nothing holds {body} against {force} N"), "hold nodes with [[hold]], or put an obstacle below it")
        }
        NoEquilibrium::Unbalanced { residual, evaluations } => (
            format!("after {evaluations} evaluations of forces, {residual:.1e} of the load is left"),
            "hold more nodes, make the load smaller, or remove `start` and let the run come to rest by its damping",
        ),
    };
    report.to("time").to("start").wrong(format!("{name} finds no state of rest: {why}"), help);
}
