//! The structure of all studies: a name, a measurement, and findings as text, tables and pages.

use crate::folder::Folder;
use crate::page::Page;
use crate::table::Table;
use clap::{Args, ValueHint};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use localshape::Scene;
use localshape::internals::{Failure, Status, command_line, listen, print, requested};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// Called with the amount of work just done, from any thread; `false` stops the measurement.
pub(crate) type Watch<'a> = dyn Fn(u64) -> bool + Sync + 'a;

/// A measurement that is ready to be made.
pub(crate) trait Study: Send + Sync {
    /// The amount of work: the sum of the amounts that [`Self::measure`] reports.
    fn work(&self) -> u64;

    /// Measures, with the caller's thread pool (rayon); `None` if `watch` stops it.
    fn measure(&self, watch: &Watch<'_>) -> Option<Findings>;
}

/// A study, and how it is made.
pub(crate) struct Task {
    /// The name of the study, and of its folder and files.
    name: &'static str,
    study: Box<dyn Study>,
    threads: usize,
    /// The arguments of the command that repeats it.
    arguments: Vec<String>,
}

impl Task {
    pub(crate) fn new(name: &'static str, study: impl Study + 'static, threads: usize, arguments: Vec<String>) -> Self {
        Self { name, study: Box::new(study), threads, arguments }
    }
}

/// The findings of a study.
pub(crate) struct Findings {
    /// The Markdown text.
    pub(crate) text: String,
    /// The tables with all digits, each with the name of its CSV file.
    pub(crate) tables: Vec<(&'static str, Table)>,
    /// The plots or maps; `None` without any.
    pub(crate) page: Option<Page>,
}

/// The results for all items, on the caller's threads; `None` if `watch`, which is called after each, stops them.
pub(crate) fn each<T: Sync, R: Send>(
    items: &[T],
    watch: &Watch<'_>,
    result: impl Fn(&T) -> R + Sync,
) -> Option<Vec<R>> {
    let one = |item| watch(0).then(|| result(item)).filter(|_| watch(1));
    items.par_iter().map(one).collect()
}

/// A scene of a study.
pub(crate) fn built_in(text: &str, name: &str) -> Scene {
    Scene::parse(text, name, &Default::default()).unwrap_or_else(|error| panic!("a scene without mistakes: {error}"))
}

/// Options of all studies.
#[derive(Args, Debug)]
pub(crate) struct Options {
    /// Output folder [default: output/study-NAME]
    #[arg(short, long, global = true, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,

    /// Write into a folder with other files, or with a study of another command
    #[arg(long, global = true)]
    pub(crate) overwrite: bool,

    /// Print only errors: no progress or results
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,

    /// Print the results as one JSON document
    #[arg(long, global = true, conflicts_with = "quiet")]
    pub(crate) json: bool,
}

/// Makes a study: measures, writes its files, and prints its text.
pub(crate) fn make(task: &Task, options: &Options) -> Result<Status, Failure> {
    let Task { name, arguments, .. } = task;
    let command = command_line(&[&["localshape-study", name].map(str::to_owned), &arguments[..]].concat());
    let path = options.out.clone().unwrap_or_else(|| format!("output/study-{name}").into());
    listen();
    let folder = Folder::new(path, name, &command, options.overwrite)?;
    let Some(found) = measured(task, options.quiet)? else {
        if !options.quiet && !options.json {
            print(&format!("interrupted; {name} was not made\n"))?;
        }
        return Ok(Status::Interrupted);
    };
    let text = format!("{}\n{}", folder.mark, found.text);
    let mut files = vec![(format!("{name}.md"), text.clone().into_bytes())];
    files.extend(found.tables.iter().map(|(name, table)| (format!("{name}.csv"), table.csv().into_bytes())));
    if let Some(page) = &found.page {
        let [svg, png] = page.files().map_err(|error| Failure::files(error.to_string()))?;
        files.extend([(format!("{name}.svg"), svg), (format!("{name}.png"), png)]);
    }
    folder.write(&files)?;
    let names: Vec<_> = files.iter().map(|(name, _)| name.as_str()).collect();
    if options.json {
        let tables: Map<String, Value> =
            found.tables.iter().map(|(name, table)| ((*name).to_owned(), table.json())).collect();
        let document = json!({ "study": name, "folder": folder.path, "files": names, "tables": tables });
        print(&format!("{document:#}\n"))?;
    } else if !options.quiet {
        print(&format!("{text}\nIn {}: {}\n", folder.path.display(), names.join(", ")))?;
    }
    Ok(Status::Done)
}

/// Measures with a number of threads, below a bar of progress in a terminal; `None` after an interruption.
fn measured(Task { name, study, threads, .. }: &Task, is_quiet: bool) -> Result<Option<Findings>, Failure> {
    let pool = ThreadPoolBuilder::new().num_threads(*threads).build();
    let pool = pool.map_err(|error| Failure::files(format!("cannot start threads: {error}")))?;
    let style = ProgressStyle::with_template("{prefix}  {wide_bar}  {eta} left").expect("a template of known keys");
    let target = if is_quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(study.work()), target).with_style(style).with_prefix(*name);
    let watch = |more| {
        bar.inc(more);
        !requested()
    };
    let found = pool.install(|| study.measure(&watch));
    bar.finish_and_clear();
    Ok(found)
}
