//! Names of bodies and runs; the bodies of each run, and their models as typed.

use crate::reading::collector::{Collector, Here};
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
    pub(super) here: Here<'a>,
}

/// The bodies of each run; `None` for a run after a mistake in them. `names` are those of all `count` bodies, empty for a
/// body without one; `None` if some are not known because of mistakes.
pub(super) fn resolve<'a>(
    runs: &'a [Option<RunFile>],
    count: usize,
    names: Option<&[&str]>,
    report: &'a Collector<'a>,
) -> Vec<Option<Choice<'a>>> {
    let one = |(at, run): (usize, &'a Option<RunFile>)| {
        let (run, here) = (run.as_ref()?, report.to("run").to(at));
        let of = of(run, count, names, &here);
        let models = match (&run.model, &run.models, &run.states) {
            (Some(model), ..) => Some(vec![TypedModel { model, here: here.to("model") }; of.as_ref()?.len()]),
            (None, Some(models), _) => by_name(models, of.as_deref()?, names?, &here),
            (None, None, Some(_)) => Some(Vec::new()),
            // After a mistake.
            (None, None, None) => return None,
        };
        Some(Choice { of: of?, models: models? })
    };
    (0..).zip(runs).map(one).collect()
}

/// The bodies of a run.
fn of(run: &RunFile, count: usize, names: Option<&[&str]>, here: &Here<'_>) -> Option<Vec<usize>> {
    let Some(typed) = &run.bodies else { return Some((0..count).collect()) };
    let (names, known) = (names?, here.report.total());
    let mut of = Vec::with_capacity(typed.len());
    for (place, name) in typed.iter().enumerate() {
        let entry = |place: usize| here.to("bodies").to(place);
        if let Some(first) = typed[..place].iter().position(|other| other == name) {
            let message = format!("`{}` is {}, as is `{}`", entry(place), quoted(name), entry(first));
            entry(place).wrong(message, "expected each body once; remove one");
        } else {
            of.extend(find(name, names, &entry(place)));
        }
    }
    of.sort_unstable();
    (here.report.total() == known).then_some(of)
}

/// The models of a run's bodies, given by name.
fn by_name<'a>(
    models: &'a BTreeMap<String, ModelFile>,
    of: &[usize],
    names: &[&str],
    run: &Here<'a>,
) -> Option<Vec<TypedModel<'a>>> {
    let (known, here) = (run.report.total(), run.to("models"));
    for name in models.keys() {
        let place = here.to(name.as_str());
        let Some(body) = find(name, names, &place) else { continue };
        if !of.contains(&body) {
            let message = format!("`{here}` has a model for {}, which the run does not have", quoted(name));
            place.wrong_key(message, "remove it, or add its name to `bodies` of the run");
        }
    }
    // A misspelt name is not missing as well.
    if run.report.total() > known {
        return None;
    }
    let model = |&body: &usize| {
        let name = names[body];
        let found = models.get_key_value(name);
        if found.is_none() {
            let given: Vec<_> = models.keys().collect();
            let found = if given.is_empty() {
                "it is empty".to_owned()
            } else {
                format!("it has models for {}", list(&given, "and", quoted))
            };
            here.wrong(format!("`{here}` has no model for {}", in_words(name)), found);
        }
        found.map(|(name, model)| TypedModel { model, here: here.to(name.as_str()) })
    };
    // All missing models are reported.
    let all: Vec<_> = of.iter().map(model).collect();
    all.into_iter().collect()
}

/// The body of a name.
pub(super) fn find(name: &str, names: &[&str], here: &Here<'_>) -> Option<usize> {
    let found = names.iter().position(|known| *known == name);
    if found.is_none() {
        let help = match (nearest(name, names).filter(|name| !name.is_empty()), names) {
            (Some(near), _) => format!("did you mean {}?", quoted(near)),
            (None, [""]) => "the body of the scene has no `name`; give it one".to_owned(),
            (None, [only]) => format!("the body of the scene is {}", quoted(only)),
            (None, _) => format!("the bodies are {}", list(names, "and", quoted)),
        };
        here.wrong(format!("there is no body {}", quoted(name)), help);
    }
    found
}

/// Reports duplicate names, and names that cannot be used in files, of `[one, several]` tables at some places of a file.
pub(super) fn check_names<'a>([one, several]: [&str; 2], named: impl Iterator<Item = (Here<'a>, Option<&'a str>)>) {
    let mut known: BTreeMap<&str, Here<'_>> = BTreeMap::new();
    for (place, name) in named {
        let Some(name) = name else { continue };
        let here = place.to("name");
        let unfit = |c: char| matches!(c, '/' | '\\') || c.is_control();
        if name.trim() != name || name.contains(unfit) {
            let message = format!("the name {} cannot be used in files", quoted(name));
            let fit = name.replace(unfit, "-");
            let fit = Some(fit.trim()).filter(|fit| !fit.is_empty()).map_or("another name".to_owned(), quoted);
            let help = format!("write {fit}: no slash, no control character, and no space at either end");
            here.wrong(message, help);
        }
        if let Some(first) = known.get(name) {
            let message = format!("two {several} are called {}: `{first}` and `{place}`", quoted(name));
            here.wrong(message, format!("give each {one} a unique name"));
        }
        known.entry(name).or_insert(place);
    }
}
