//! Resolves ghosts and paths.

use crate::look::{Ghost, Traced};
use crate::reading::collector::{Collector, Here};
use crate::reading::words::{list, nearest, quoted, short};
use crate::scene::{Run, Scene};

/// The name for a ghost of the rest shape.
const REST: &str = "rest";

/// The outline over each body; `None` also after a mistake.
pub(super) fn ghost(name: &str, scene: &Scene, report: &Collector<'_>) -> Option<Ghost> {
    let here = report.to("view").to("ghost");
    let run = scene.runs.iter().position(|known| known.name == name);
    match run {
        Some(at) if name == REST => {
            let message = format!("\"{REST}\" means the rest shape, but `run[{at}]` has this name, too");
            here.wrong(message, "give the run another name");
            None
        }
        None if name == REST => Some(Ghost::Rest),
        _ => self::run(name, &[REST], &here, scene).map(Ghost::Run),
    }
}

/// A run whose states are compared with those of all others. `more` are other words in its place.
pub(super) fn run(name: &str, more: &[&str], here: &Here<'_>, scene: &Scene) -> Option<usize> {
    let run = scene.runs.iter().position(|known| known.name == name);
    let run = run.or_else(|| unknown(name, more, here, scene))?;
    let one = &scene.runs[run];
    // A recording is compared with the moments nearest to its own.
    let is_simulated = |run: &Run| !run.models.is_empty();
    let has_other_steps = |other: &&Run| is_simulated(one) && is_simulated(other) && one.step != other.step;
    if let Some(other) = scene.runs.iter().find(|other| other.of != one.of) {
        let [one, other] = [one, other].map(|run| quoted(&run.name));
        let message = format!("{one} and {other} have different bodies, so their nodes cannot be compared");
        here.wrong(message, "give all runs of the scene the same bodies, or compare none");
    } else if let Some(other) = scene.runs.iter().find(has_other_steps) {
        let message = format!(
            "{} has a time step of {} s, {} one of {} s: their frames are not at the same moments",
            quoted(&one.name),
            short(one.step),
            quoted(&other.name),
            short(other.step)
        );
        here.wrong(message, "give both runs the same `step`");
    }
    Some(run)
}

/// Reports paths that are listed twice, and nodes that not all runs have.
pub(super) fn check_paths(paths: &[Traced], scene: &Scene, report: &Collector<'_>) {
    let nodes = scene.nodes_of_runs();
    let (least, most) = (nodes.iter().min().copied().unwrap_or(0), nodes.iter().max().copied().unwrap_or(0));
    for (at, path) in paths.iter().enumerate() {
        let here = report.to("view").to("paths").to(at);
        if paths[..at].contains(path) {
            here.wrong("this path is listed a second time", "remove it");
        }
        if let Traced::Node(node) = *path
            && node as usize >= least
        {
            let last = least.saturating_sub(1);
            let who = match scene.runs.iter().find(|run| run.bodies.whole().len() == least) {
                Some(run) if least < most => format!("the run {}", quoted(&run.name)),
                _ if scene.bodies.len() == 1 => "the body".to_owned(),
                _ => "each run".to_owned(),
            };
            here.wrong(format!("there is no node {node}; {who} has nodes 0 to {last}"), None);
        }
    }
}

/// Reports an unknown run, unless there are mistakes in the runs themselves.
fn unknown<T>(name: &str, more: &[&str], here: &Here<'_>, scene: &Scene) -> Option<T> {
    if scene.runs.is_empty() {
        return None;
    }
    let known: Vec<&str> = scene.runs.iter().map(|run| &*run.name).chain(more.iter().copied()).collect();
    let help = match nearest(name, &known) {
        Some(name) => format!("did you mean {}?", quoted(name)),
        None => format!("expected {}", list(&known, "or", quoted)),
    };
    here.wrong(format!("there is no run {}", quoted(name)), help);
    None
}
