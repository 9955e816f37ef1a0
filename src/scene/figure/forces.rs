//! Resolves a diagram of forces.

use super::Forces;
use super::file::{ForcesFile, NumbersFile};
use super::resolve::{Scenes, share_lines};
use crate::reading::collector::Here;
use crate::reading::words::{list, quoted};
use crate::scene::{Run, Scene, SceneError};

/// The most nodes of a body whose forces are drawn.
const MOST_NODES: usize = 80;

impl<'a> Scenes<'a> {
    /// The place of a scene in a diagram of forces.
    fn of_forces(&self, index: usize) -> Here<'a> {
        self.report.to("forces").to("scenes").to(index)
    }

    /// The diagram of a file; `None` after reporting a mistake.
    pub(super) fn forces(mut self, file: ForcesFile) -> Result<Option<Forces>, SceneError> {
        let before = self.report.total();
        for (index, named) in file.scenes.iter().enumerate() {
            let here = self.of_forces(index);
            if self.scene(named, &here)?.is_some_and(|place| place < index) {
                here.wrong("this scene is named a second time", None);
            }
        }
        if self.report.total() > before {
            return Ok(None);
        }
        let names = |scene: &Scene| scene.runs.iter().map(|run| run.name.clone()).collect::<Vec<_>>();
        let runs = names(&self.scenes[0]);
        for (index, _) in self.scenes.iter().enumerate().filter(|(_, scene)| names(scene) != runs) {
            let all = list(&runs, "and", |name| format!("“{name}”"));
            let message = format!("the runs of this scene differ from those of the first: {all}");
            self.of_forces(index).wrong(message, None);
        }
        let compare = file.compare.as_ref().and_then(|name| self.compared(name, &runs));
        if file.notes.len() > runs.len() {
            let message = format!("there are more notes ({}) than runs ({})", file.notes.len(), runs.len());
            self.report.to("forces").to("notes").wrong(message, "expected one for each at most");
        }
        let recorded = |scene: &Scene| Some(quoted(&scene.runs.iter().find(|run| run.recording.is_some())?.name));
        if let Some((index, run)) = self.scenes.iter().enumerate().find_map(|(at, scene)| Some((at, recorded(scene)?)))
        {
            let message = format!("the run {run} is a recording, whose forces are not known");
            self.of_forces(index).wrong(message, "give it a `model`, or leave it out");
            return Ok(None);
        }
        let numbers = file.numbers == NumbersFile::Force;
        if file.vectors && (numbers || runs.len() > 1) {
            let message = "vectors are drawn for one run, and without numbers";
            let help = "leave one run in the scenes, and write `numbers = \"none\"`";
            self.report.to("forces").to("vectors").wrong_key(message, help);
        }
        self.check_units(numbers);
        let mut notes = file.notes;
        notes.resize(runs.len(), String::new());
        let Self { report, mut scenes, .. } = self;
        share_lines(&mut scenes);
        let forces = Forces { scenes, notes, compare, vectors: file.vectors, numbers };
        Ok((report.total() == before).then_some(forces))
    }

    /// The place of the run with which others are compared among all `runs`; `None` after reporting that there is none. Reports scenes
    /// in which another run has other bodies.
    fn compared(&mut self, name: &str, runs: &[String]) -> Option<usize> {
        let here = self.report.to("forces").to("compare");
        let place = runs.iter().position(|run| run == name);
        if place.is_none() {
            let (message, help) = self.scenes[0].no_run(name);
            here.wrong(message, help);
        }
        if runs.len() == 1 {
            here.wrong_key("there is a single run, and nothing to compare it with", None);
        }
        for (index, scene) in self.scenes.iter().enumerate() {
            let Some(compared) = place.and_then(|place| scene.runs.get(place)) else { continue };
            if let Some(other) = scene.runs.iter().find(|run| run.of != compared.of) {
                let [one, other] = [compared, other].map(|run| quoted(&run.name));
                let message = format!("{one} and {other} have different bodies, so their forces cannot be compared");
                self.of_forces(index).wrong(message, "give both runs the same bodies, or remove `compare`");
            }
        }
        place
    }

    /// Reports scenes whose forces have another unit than those of the first, or are too many. With `numbers` their unit has a length.
    fn check_units(&mut self, numbers: bool) {
        let of_runs = |scene: &Scene| {
            let each = scene.runs.iter().flat_map(Run::models_and_bodies);
            each.map(|(model, body)| model.properties(body).stiffness).collect::<Vec<_>>()
        };
        let stiffness = of_runs(&self.scenes[0])[0];
        for (index, scene) in self.scenes.iter().enumerate() {
            if of_runs(scene).iter().any(|&other| other != stiffness) {
                let message =
                    format!("a run has another stiffness than the first, {stiffness} N/m: forces would have two units");
                self.of_forces(index).wrong(message, "give all runs the same stiffness");
            }
            let nodes = scene.runs.iter().map(|run| run.body().len()).max().unwrap_or_default();
            if nodes > MOST_NODES {
                let bodies = if scene.bodies.len() == 1 { "the body has" } else { "the bodies of a run have" };
                let message = format!("{bodies} {nodes} nodes, whose forces would hide each other");
                self.of_forces(index).wrong(message, format!("expected at most {MOST_NODES}"));
            }
        }
        let side = self.scenes[0].view.side;
        let other = self.scenes.iter().position(|scene| (scene.view.side / side - 1.0).abs() > 1e-3);
        if let Some(index) = other.filter(|_| numbers) {
            let found = self.scenes[index].view.side;
            let message = format!(
                "the elements of this scene have sides of {found} m, but {side} m in the first: numbers in `k × side` would have two units"
            );
            self.of_forces(index).wrong(message, "use bodies of one size, or `numbers = \"none\"`");
        }
    }
}
