//! The structure of all studies: a name, a measurement, and findings as text, tables and pages.

use crate::failure::{Failure, Status};
use crate::folder::{Folder, Notes};
use crate::progress::{self, Watch};
use crate::table::Table;
use clap::{Args, ValueHint};
use rayon::ThreadPoolBuilder;
use serde_json::{Map, Value, json};
use std::io::{self, ErrorKind, Write};
use std::path::PathBuf;

/// A measurement that is ready to be made.
pub(crate) trait Study: Send + Sync {
    /// Its name, and that of its folder and files.
    fn name(&self) -> &'static str;

    /// The command that repeats it.
    fn command(&self) -> String {
        format!("localshape-study {}", self.name())
    }

    /// The digest of the study's parameters besides the command. Notes of an interrupted study depend on it.
    fn digest(&self) -> &str {
        ""
    }

    /// The amount of work: the sum of the amounts that [`Self::measure`] reports.
    fn work(&self) -> u64;

    /// Measures, with the caller's thread pool (rayon); `None` if `watch` stops it. Notes are kept until the study is
    /// done.
    fn measure(&self, watch: &Watch<'_>, notes: &Notes) -> Option<Findings>;
}

/// The findings of a study.
pub(crate) struct Findings {
    /// The Markdown text.
    pub(crate) text: String,
    /// The tables with all digits, each with the name of its CSV file.
    pub(crate) tables: Vec<(&'static str, Table)>,
    /// The pages, each with the name of its SVG and PNG files, without extensions.
    #[cfg(feature = "render")]
    pub(crate) pages: Vec<(&'static str, crate::page::Page)>,
}

impl Findings {
    /// Findings without pages.
    pub(crate) fn new(text: String, tables: impl Into<Vec<(&'static str, Table)>>) -> Self {
        Self {
            text,
            tables: tables.into(),
            #[cfg(feature = "render")]
            pages: Vec::new(),
        }
    }
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

/// Makes a study: measures with a number of threads, writes its files, and prints its text.
pub(crate) fn make(study: &dyn Study, threads: usize, options: &Options) -> Result<Status, Failure> {
    let (name, command) = (study.name(), study.command());
    let path = options.out.clone().unwrap_or_else(|| format!("output/study-{name}").into());
    let folder = Folder::new(path, name, &command, options.overwrite)?;
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| Failure::files(format!("cannot start threads: {error}")))?;
    let notes = folder.notes(study.digest());
    let found =
        progress::shown(name, study.work(), options.quiet, |watch| pool.install(|| study.measure(watch, &notes)));
    let Some(Findings { text, tables, .. }) = &found else {
        if !options.quiet && !options.json {
            let goes_on = if notes.are_kept() { "; the same command continues from here" } else { "" };
            print(&format!("interrupted; {name} was not made{goes_on}\n"))?;
        }
        return Ok(Status::Interrupted);
    };
    let text = format!("{}\n{text}", folder.mark());
    let mut files = vec![(format!("{name}.md"), text.clone().into_bytes())];
    files.extend(tables.iter().map(|(name, table)| (format!("{name}.csv"), table.csv().into_bytes())));
    #[cfg(feature = "render")]
    for (name, page) in found.iter().flat_map(|found| &found.pages) {
        let [svg, png] = page.files()?;
        files.extend([(format!("{name}.svg"), svg), (format!("{name}.png"), png)]);
    }
    folder.write(&files)?;
    notes.remove();
    let names: Vec<_> = files.iter().map(|(name, _)| name.as_str()).collect();
    if options.json {
        let tables: Map<String, Value> =
            tables.iter().map(|(name, table)| ((*name).to_owned(), table.json())).collect();
        let document = json!({ "study": name, "folder": folder.path(), "files": names, "tables": tables });
        print(&format!("{document:#}\n"))?;
    } else if !options.quiet {
        print(&format!("{text}\nIn {}: {}\n", folder.path().display(), names.join(", ")))?;
    }
    Ok(Status::Done)
}

/// Prints results. A closed pipe is not an error.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::files(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}
