//! `table`: the paper's numbers beside ours.

use super::console::{print, print_json};
use super::failure::{Failure, Status};
use super::options::{PrintOptions, ThreadOptions};
use super::{interrupt, record};
use crate::output::SheetFiles;
use crate::table::{Watch, ratio, table1};
use clap::{Args, ValueEnum, ValueHint};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  localshape table                             Table 1 and the ratio in output/table1/ and output/ratio/
  localshape table table1 --orientations 200   more starts, narrower medians
  localshape table ratio --threads 4 -o four   the ratio of computation times on four threads

Each folder then has the table as Markdown, which is also printed, and as CSV with all digits, and that of Table 1 a figure \
of it as SVG and PDF. Table 1 has the same bytes on every machine and for any number of threads. The ratio is measured on this machine, which should be idle otherwise.";

/// Measure the tables of the paper, and print them beside its numbers
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Table {
    /// What to measure
    #[arg(value_name = "TABLE", value_enum, default_values_t = [Name::All])]
    tables: Vec<Name>,

    /// Output folder [default: output/TABLE]; with several tables, the folder that holds one folder TABLE for each
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    out: Option<PathBuf>,

    /// Replace a table in the output folder that was made with other options, or other files
    #[arg(long)]
    overwrite: bool,

    /// Number of random orientations in Table 1, of which the first are always the same
    #[arg(long, value_name = "N", default_value_t = table1::Protocol::default().orientations)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000))]
    orientations: u32,

    // The ratio is measured on one thread by default.
    #[command(flatten)]
    threads: ThreadOptions,
    #[command(flatten)]
    printing: PrintOptions,
}

/// The files of Table 1 as a figure.
#[cfg(feature = "render")]
const DRAWN: [&str; 2] = ["table1.svg", "table1.pdf"];
#[cfg(not(feature = "render"))]
const DRAWN: [&str; 0] = [];

/// Table 1 as a figure: their contents.
#[cfg(feature = "render")]
fn drawn(table: &table1::Table1) -> Vec<Vec<u8>> {
    super::table_figure::files(table)
}
#[cfg(not(feature = "render"))]
fn drawn(_: &table1::Table1) -> Vec<Vec<u8>> {
    Vec::new()
}

/// The tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Name {
    /// The errors of the rotations (Table 1)
    Table1,
    /// The computation time of the shape model over that of mass-spring (section 4)
    Ratio,
    /// All of them
    All,
}

/// A table that was measured.
struct Made {
    /// It as Markdown.
    text: String,
    /// The contents of each of its files.
    files: Vec<Vec<u8>>,
    json: Value,
}

impl Made {
    fn new(texts: impl IntoIterator<Item = String>, more: Vec<Vec<u8>>, json: Value) -> Self {
        let texts: Vec<_> = texts.into_iter().collect();
        let text = texts[0].clone();
        Self { text, files: texts.into_iter().map(String::into_bytes).chain(more).collect(), json }
    }
}

impl Table {
    pub(super) fn run(self) -> Result<Status, Failure> {
        interrupt::listen();
        let wanted = |name: &Name| self.tables.contains(name) || self.tables.contains(&Name::All);
        let names: Vec<_> = [Name::Table1, Name::Ratio].into_iter().filter(wanted).collect();
        // All folders are looked at before the first table is measured.
        let folder = |name: Name| match &self.out {
            Some(out) if names.len() > 1 => out.join(name.word()),
            Some(out) => out.clone(),
            None => Path::new("output").join(name.word()),
        };
        for &name in &names {
            SheetFiles::inspect(&folder(name), &name.files(), &self.mark(name), self.overwrite)?;
        }
        let (mut documents, mut status) = (Vec::new(), Status::Done);
        for (number, &name) in names.iter().enumerate() {
            let folder = folder(name);
            let files = SheetFiles::begin(&folder, &name.files(), &self.mark(name), self.overwrite)?;
            let Some(made) = self.measure(name)? else {
                status = Status::Interrupted;
                if self.printing.prints_text() {
                    print(&format!("interrupted; {} was not made\n", name.word()))?;
                }
                break;
            };
            files.finish(&made.files)?;
            if self.printing.json {
                let mut document = json!({ "table": name.word(), "folder": folder.to_string_lossy() });
                document["files"] = json!(name.files());
                record::merge(&mut document, made.json);
                documents.push(document);
            } else if !self.printing.quiet {
                let blank = if number > 0 { "\n" } else { "" };
                let (table, names) = (&made.text, name.files().join(", "));
                print(&format!("{blank}{table}\nIn {}: {names}\n", folder.display()))?;
            }
        }
        if self.printing.json {
            print_json(&json!({ "tables": documents }))?;
        }
        Ok(status)
    }

    /// How a table is made, by which its files are known again.
    fn mark(&self, name: Name) -> String {
        match name {
            Name::Ratio => ratio::mark(self.threads.count_or(1)),
            _ => self.table1().mark(),
        }
    }

    fn table1(&self) -> table1::Protocol {
        table1::Protocol { orientations: self.orientations, ..table1::Protocol::default() }
    }

    /// Measures a table; `None` if the user wants to stop.
    fn measure(&self, name: Name) -> Result<Option<Made>, Failure> {
        let (protocol, timing) = (self.table1(), ratio::Protocol::default());
        let (work, threads) = match name {
            Name::Ratio => (timing.work(), self.threads.count_or(1)),
            _ => (protocol.work(), self.threads.count()),
        };
        let pool = record::pool(threads)?;
        let bar = self.printing.progress(name.word(), work);
        let watch: &Watch<'_> = &interrupt::watch(&bar);
        let made = pool.install(|| match name {
            Name::Ratio => {
                ratio::measure(&timing, watch).map(|ratios| Made::new(ratios.files(), Vec::new(), ratios.json()))
            }
            _ => table1::measure(&protocol, watch).map(|table| Made::new(table.files(), drawn(&table), table.json())),
        });
        bar.finish_and_clear();
        Ok(made)
    }
}

impl Name {
    fn word(self) -> &'static str {
        if self == Self::Ratio { "ratio" } else { "table1" }
    }

    fn files(self) -> Vec<&'static str> {
        match self {
            Self::Table1 => [&table1::FILES[..], &DRAWN].concat(),
            Self::Ratio => ratio::FILES.to_vec(),
            Self::All => Vec::new(),
        }
    }
}
