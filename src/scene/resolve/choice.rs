//! Names of bodies and runs; the bodies of each run, and their models as typed.

use super::KeyPath;
use crate::reading::collector::{Collector, PathPart, key_path, written};
use crate::reading::words::{list, nearest, quoted};
use crate::scene::file::{ModelFile, RunFile};
use crate::scene::in_words;
use std::collections::BTreeMap;

/// The bodies of a run and what moves them.
#[derive(Clone, Debug)]
pub(super) struct Choice<'a> {
    /// The places of the bodies in the scene, in rising order.
    pub(super) of: Vec<usize>,
    /// The model of each body; empty for a recording.
    pub(super) models: Vec<TypedModel<'a>>,
}

/// A model as typed.
#[derive(Clone, Debug)]
pub(super) struct TypedModel<'a> {
    pub(super) model: &'a ModelFile,
    /// Its place in the file.
    pub(super) path: Vec<PathPart<'a>>,
}

/// The bodies of each run; `None` for a run after a mistake in them. `names` are those of all `count` bodies, empty for a
/// body without one; `None` if some are not known because of mistakes.
pub(super) fn resolve<'a>(
    runs: &'a [Option<RunFile>],
    count: usize,
    names: Option<&[&str]>,
    report: &mut Collector<'_>,
) -> Vec<Option<Choice<'a>>> {
    let one = |(at, run): (usize, &'a Option<RunFile>)| {
        let run = run.as_ref()?;
        let of = of(at, run, count, names, report);
        let models = match (&run.model, &run.models, &run.states) {
            (Some(model), ..) => {
                let path = key_path!["run", at, "model"].to_vec();
                Some(vec![TypedModel { model, path }; of.as_ref()?.len()])
            }
            (None, Some(models), _) => by_name(at, models, of.as_deref()?, names?, report),
            (None, None, Some(_)) => Some(Vec::new()),
            // After a mistake.
            (None, None, None) => return None,
        };
        Some(Choice { of: of?, models: models? })
    };
    (0..).zip(runs).map(one).collect()
}

/// The bodies of a run.
fn of(
    at: usize,
    run: &RunFile,
    count: usize,
    names: Option<&[&str]>,
    report: &mut Collector<'_>,
) -> Option<Vec<usize>> {
    let Some(typed) = &run.bodies else { return Some((0..count).collect()) };
    let (names, known) = (names?, report.total());
    let mut of = Vec::with_capacity(typed.len());
    for (place, name) in typed.iter().enumerate() {
        let path = key_path!["run", at, "bodies", place];
        if let Some(first) = typed[..place].iter().position(|other| other == name) {
            let message = format!("`run[{at}].bodies[{place}]` is {}, as is `run[{at}].bodies[{first}]`", quoted(name));
            report.at(&path, message, "expected each body once; remove one");
        } else {
            of.extend(find(name, names, &path, report));
        }
    }
    of.sort_unstable();
    (report.total() == known).then_some(of)
}

/// The models of a run's bodies, given by name.
fn by_name<'a>(
    at: usize,
    models: &'a BTreeMap<String, ModelFile>,
    of: &[usize],
    names: &[&str],
    report: &mut Collector<'_>,
) -> Option<Vec<TypedModel<'a>>> {
    let known = report.total();
    for name in models.keys() {
        let path = key_path!["run", at, "models", name.as_str()];
        let Some(body) = find(name, names, &path, report) else { continue };
        if !of.contains(&body) {
            let message = format!("`run[{at}].models` has a model for {}, which the run does not have", quoted(name));
            report.at_key(&path, message, "remove it, or add its name to `bodies` of the run");
        }
    }
    // A misspelt name is not missing as well.
    if report.total() > known {
        return None;
    }
    let model = |&body: &usize| {
        let name = names[body];
        let found = models.get_key_value(name);
        if found.is_none() {
            let message = format!("`run[{at}].models` has no model for {}", in_words(name));
            let given: Vec<_> = models.keys().collect();
            let found = if given.is_empty() {
                "it is empty".to_owned()
            } else {
                format!("it has models for {}", list(&given, "and", quoted))
            };
            report.at(&key_path!["run", at, "models"], message, found);
        }
        found.map(|(name, model)| TypedModel { model, path: key_path!["run", at, "models", name.as_str()].to_vec() })
    };
    // All missing models are reported.
    let all: Vec<_> = of.iter().map(model).collect();
    all.into_iter().collect()
}

/// The body of a name.
pub(super) fn find(name: &str, names: &[&str], path: &[PathPart<'_>], report: &mut Collector<'_>) -> Option<usize> {
    let found = names.iter().position(|known| *known == name);
    if found.is_none() {
        let help = match (nearest(name, names).filter(|name| !name.is_empty()), names) {
            (Some(near), _) => format!("did you mean {}?", quoted(near)),
            (None, [""]) => "the body of the scene has no `name`; give it one".to_owned(),
            (None, [only]) => format!("the body of the scene is {}", quoted(only)),
            (None, _) => format!("the bodies are {}", list(names, "and", quoted)),
        };
        report.at(path, format!("there is no body {}", quoted(name)), help);
    }
    found
}

/// Reports duplicate names, and names that cannot be used in files, of `[one, several]` tables at some places of a file.
pub(super) fn check_names<'a>(
    [one, several]: [&str; 2],
    named: impl Iterator<Item = (KeyPath, Option<&'a str>)>,
    report: &mut Collector<'_>,
) {
    let mut known: BTreeMap<&str, KeyPath> = BTreeMap::new();
    for (place, name) in named {
        let Some(name) = name else { continue };
        let path = key_path![place; "name"];
        let unfit = |c: char| matches!(c, '/' | '\\') || c.is_control();
        if name.trim() != name || name.contains(unfit) {
            let message = format!("the name {} cannot be used in files", quoted(name));
            let fit = name.replace(unfit, "-");
            let fit = Some(fit.trim()).filter(|fit| !fit.is_empty()).map_or("another name".to_owned(), quoted);
            report.at(
                &path,
                message,
                format!("write {fit}: no slash, no control character, and no space at either end"),
            );
        }
        if let Some(first) = known.get(name) {
            let [first, second] = [first, &place].map(|place| written(place));
            let message = format!("two {several} are called {}: `{first}` and `{second}`", quoted(name));
            report.at(&path, message, format!("give each {one} a unique name"));
        }
        known.entry(name).or_insert(place);
    }
}
