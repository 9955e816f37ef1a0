//! `--sweep`: variants of a scene, one for each line of a table, each in a folder of its own.

use super::console::{self, columns};
use super::failure::{Failure, Status, missing, note, warn_of};
use super::frames::Shard;
use super::options::{PrintOptions, RunOptions, SceneOptions};
use crate::output::{OutputError, SUMMARY_FILE, exact, read_file, rows_as_csv, write_whole};
use crate::reading::report::mistake;
use crate::reading::source::Source;
use crate::reading::variants::{Row, Variants, cell, decimal_comma, set, value};
use crate::reading::words::short;
use crate::reading::{Mistake, Mistakes};
use crate::scene::{Limits, Scene, SceneError};
use crate::sim::words::quantity;
use csv::ReaderBuilder;
use serde_json::Value;
use std::collections::HashSet;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The longest table that is read (bytes), with some 100 000 variants.
const LONGEST: u64 = 8 << 20;
/// The most characters of a folder's name that come from its values.
const MOST_CHARACTERS: usize = 80;
/// The table of all variants with their folders.
const VARIANTS_FILE: &str = "variants.csv";
/// The table of how their runs fare.
const COMPARISON_FILE: &str = "comparison.csv";

/// Variants of a scene.
#[derive(Debug)]
pub(super) struct Sweep {
    scene: PathBuf,
    limits: Limits,
    /// Those of the shard.
    variants: Vec<Variant>,
    folder: PathBuf,
    /// The contents of the table of all variants, and the digests of their scenes.
    table: Vec<u8>,
    digests: Vec<String>,
}

/// One line of the table.
#[derive(Debug)]
struct Variant {
    /// Keys and values that differ from the scene.
    changes: Vec<(String, toml::Value)>,
    /// The name of its folder.
    folder: String,
}

impl Sweep {
    /// Reads a table of variants of a scene, and checks all of them. With a `shard` it has a share of them.
    pub(super) fn read(
        file: &Path,
        scenes: &SceneOptions,
        options: &RunOptions,
        shard: Option<Shard>,
        check: impl Fn(&Scene) -> Result<(), Failure>,
    ) -> Result<Self, Failure> {
        let [path] = &scenes.scenes[..] else {
            return Err(Failure::usage("--sweep has the variants of one scene; run the scenes one at a time"));
        };
        let name = file.display();
        let limits = scenes.limits();
        let base = scenes.load_all(options.printing.quiet)?.pop().expect("one was named");
        let found = fs::metadata(file).map_err(|error| missing(file, "csv", error))?;
        if found.is_file() && found.len() > LONGEST {
            return Err(Failure::usage(format!("{name} is longer than {LONGEST} bytes; split the sweep")));
        }
        let bytes = read_file(file)?
            .ok_or_else(|| Failure::usage(format!("{name} is no file; expected a table, such as sweep.csv")))?;
        let text = String::from_utf8(bytes).map_err(|_| Failure::usage(format!("{name} is not text in UTF-8")))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let Variants { keys, rows } = Variants::parse(text).map_err(|found| {
            Failure::usage(Mistakes { file: name.to_string(), found: vec![*found], total: 1 }.to_string())
        })?;
        let usual = || Path::new("output").join(format!("{}-sweep", base.name));
        let folder = options.out.as_deref().map_or_else(usual, Path::to_owned);
        let (variants, table, digests) = (Vec::new(), Vec::new(), Vec::new());
        let mut sweep = Self { scene: path.clone(), limits, variants, folder, table, digests };
        let names = short_names(&keys);
        for (number, (row, _)) in rows.iter().enumerate() {
            let cells = keys.iter().zip(row).filter(|(_, cell)| !cell.is_empty());
            let changes = cells.map(|(key, cell)| (key.clone(), value(cell))).collect();
            let values = names.iter().zip(row).filter(|(_, cell)| !cell.is_empty());
            let values: Vec<_> = values.map(|(name, cell)| format!("{name}={cell}")).collect();
            let plain = |c: char| if c.is_alphanumeric() || "._=+-".contains(c) { c } else { '-' };
            let values: String = values.join("_").chars().map(plain).take(MOST_CHARACTERS).collect();
            let folder = format!("{:04}_{values}", number + 1);
            sweep.variants.push(Variant { changes, folder: folder.trim_end_matches(['_', '.']).to_owned() });
        }
        let (mut warnings, digests) = sweep.check(file, text, &keys, &rows, check)?;
        sweep.digests = digests;
        // Those of the scene itself are told already.
        warnings.retain(|one| base.warnings.iter().all(|known| known.message != one.message));
        if !options.printing.quiet {
            warn_of(file, warnings);
        }
        sweep.table = sweep.table(&keys, &rows);
        if let Some(shard) = shard {
            let numbers: Vec<u64> = (0..sweep.variants.len() as u64).collect();
            let share =
                shard.select(&numbers, "variants").map_err(|message| Failure::usage(format!("--shard: {message}")))?;
            let mut number = 0;
            sweep.variants.retain(|_| {
                number += 1;
                share.binary_search(&(number - 1)).is_ok()
            });
        }
        Ok(sweep)
    }

    /// Reads all variants, so that nothing is made before all mistakes are known, and returns the warnings, each at its cell,
    /// and the digests.
    fn check(
        &self,
        file: &Path,
        text: &str,
        keys: &[String],
        rows: &[Row],
        check: impl Fn(&Scene) -> Result<(), Failure>,
    ) -> Result<(Vec<Mistake>, Vec<String>), Failure> {
        let source = Source::new(text);
        let (mut warnings, mut digests) = (Vec::new(), Vec::new());
        let column_of = |place: &str| {
            let is_below = |long: &str, short: &str| {
                long.strip_prefix(short).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
            };
            let fits = |key: &str| is_below(place, key) || is_below(key, place);
            (0..keys.len()).filter(|&at| fits(&keys[at])).max_by_key(|&at| keys[at].len()).unwrap_or(0)
        };
        let (mut found, mut total, mut known) = (Vec::new(), 0, HashSet::new());
        let mut add = |cell: Range<usize>, message: String, help: Option<String>| {
            // What is wrong with a key is so in all lines.
            if known.insert((cell.start, message.clone())) {
                total += 1;
                found.push(mistake(&source, cell, &[], message, help));
            }
        };
        for (number, (_, start)) in rows.iter().enumerate() {
            let mistakes = match self.scene(number) {
                Ok(scene) => {
                    if let Err(failure) = check(&scene) {
                        add(cell(text, *start, 0), failure.mistake()?, None);
                    }
                    digests.push(scene.digest);
                    warnings.extend(scene.warnings.into_iter().map(|one| {
                        mistake(&source, cell(text, *start, column_of(&one.place)), &[], one.message, one.help)
                    }));
                    continue;
                }
                Err(Wrong::Key(key, message)) => {
                    let column = keys.iter().position(|known| *known == key).unwrap_or(0);
                    add(cell(text, 0, column), message, None);
                    continue;
                }
                Err(Wrong::Scene(SceneError::Mistakes(mistakes))) => mistakes,
                Err(Wrong::Scene(error)) => return Err(Failure::usage(error.to_string())),
            };
            for one in mistakes.found {
                let is_key = one.message.starts_with("unknown key");
                let (start, column) = (if is_key { 0 } else { *start }, column_of(&one.place));
                let help = decimal_comma(&rows[number].0[column]).filter(|_| !is_key).or(one.help);
                add(cell(text, start, column), one.message, help);
            }
        }
        match total {
            0 => Ok((warnings, digests)),
            _ => Err(Failure::usage(Mistakes { file: file.display().to_string(), found, total }.to_string())),
        }
    }

    /// The scene of a variant.
    fn scene(&self, number: usize) -> Result<Scene, Wrong> {
        let text = Scene::text(&self.scene, &self.limits).map_err(Wrong::Scene)?;
        let mut root: toml::Table = toml::from_str(&text).unwrap_or_default();
        for (key, value) in &self.variants[number].changes {
            set(&mut root, key, value.clone()).map_err(|message| Wrong::Key(key.clone(), message))?;
        }
        let text = toml::to_string(&root).map_err(|error| Wrong::Key(String::new(), error.to_string()))?;
        Scene::load_text(&text, &self.scene, &self.limits).map_err(Wrong::Scene)
    }

    /// Refuses a folder with variants of a table that has other lines, unless these may be lost. More lines are no other table.
    ///
    /// # Errors
    /// If it is refused or cannot be read.
    pub(super) fn check_folder(&self, overwrite: bool) -> Result<(), OutputError> {
        let occupied = |what: String| Err(OutputError::Occupied { path: self.folder.clone(), what });
        let bytes = read_file(&self.folder.join(VARIANTS_FILE))?;
        let compared = read_file(&self.folder.join(COMPARISON_FILE))?;
        for (name, bytes) in [(VARIANTS_FILE, &bytes), (COMPARISON_FILE, &compared)] {
            if !overwrite && bytes.as_ref().is_some_and(|bytes| !bytes.starts_with(b"folder,")) {
                return occupied(format!("{name}, which was not written by localshape"));
            }
        }
        let Some(bytes) = bytes.filter(|bytes| bytes.starts_with(b"folder,")) else { return Ok(()) };
        let lines = |table: &[u8]| -> Vec<Vec<String>> {
            let lines = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(table).into_records();
            lines.flatten().map(|line| line.iter().map(str::to_owned).collect()).collect()
        };
        let (found, known) = (lines(&bytes), lines(&self.table).into_iter().collect::<HashSet<_>>());
        let others: Vec<_> = found.iter().filter(|line| !known.contains(*line)).collect();
        // Where the keys differ, so do all lines.
        let Some(name) = others.last().and_then(|line| line.first()) else { return Ok(()) };
        if !overwrite {
            return occupied(format!("variants of another table, such as {name}"));
        }
        let ours = |name: &String| self.variants.iter().any(|variant| variant.folder == *name);
        let mut names = others.iter().filter_map(|line| line.first());
        if let Some(name) = names.rfind(|name| !ours(name) && self.folder.join(name).is_dir()) {
            note(&format!("{} keeps variants of an earlier table, such as {name}", self.folder.display()));
        }
        Ok(())
    }

    /// Writes the table of all variants with their folders.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn write_table(&self) -> Result<(), OutputError> {
        fs::create_dir_all(&self.folder).map_err(OutputError::writing(&self.folder))?;
        write_whole(&self.folder.join(VARIANTS_FILE), &self.table)
    }

    /// The variants, each with its folder, read one at a time.
    pub(super) fn variants(&self) -> impl Iterator<Item = Result<(Scene, PathBuf), Failure>> {
        (0..self.variants.len()).map(|number| match self.scene(number) {
            Ok(scene) => Ok((scene, self.folder.join(&self.variants[number].folder))),
            Err(Wrong::Scene(error)) => Err(Failure::usage(error.to_string())),
            Err(Wrong::Key(_, message)) => Err(Failure::usage(message)),
        })
    }

    /// Ends a sweep that was not interrupted: writes a table of how the runs of all variants fare that are complete, also of other
    /// shards, if they are of the same scene, and prints the beginning of it if that is wanted.
    ///
    /// # Errors
    /// If a summary cannot be read, or the table cannot be written.
    pub(super) fn end(&self, status: Status, printing: PrintOptions) -> Result<Status, Failure> {
        /// The most lines that are printed.
        const MOST: usize = 60;
        if status != Status::Done {
            return Ok(status);
        }
        let path = self.folder.join(COMPARISON_FILE);
        let (mut table, mut shown) = self.compared()?;
        loop {
            write_whole(&path, &table)?;
            // Shards that end together: whoever writes last has seen all.
            let now = self.compared()?;
            if now.0 == table {
                break;
            }
            (table, shown) = now;
        }
        if printing.prints_text() {
            let more = shown.len().saturating_sub(MOST + 1);
            shown.truncate(MOST + 1);
            let text = columns(&shown, [false, false, false, true, true]);
            let more = if more > 0 { format!("{more} more ") } else { String::new() };
            console::print(&format!("\n{text}{more}in {}\n", path.display()))?;
        }
        Ok(status)
    }

    /// How the runs of all complete variants fare: as a table, and in words.
    fn compared(&self) -> Result<(Vec<u8>, Vec<[String; 5]>), Failure> {
        let heads = ["folder", "run", "status", "diverged_at_s", "turned_over", "shape_error_m"];
        let mut table = vec![heads.map(str::to_owned)];
        let mut shown = vec![["variant", "run", "status", "turned over", "shape error"].map(str::to_owned)];
        let mut lines = ReaderBuilder::new().from_reader(&self.table[..]);
        for (line, digest) in lines.records().flatten().zip(&self.digests) {
            let name = line.get(0).unwrap_or_default();
            let bytes = read_file(&self.folder.join(name).join(SUMMARY_FILE))?.unwrap_or_default();
            let summary: Value = serde_json::from_slice(&bytes).unwrap_or_default();
            let is_done = summary["outcome"] == "done" && summary["scene"]["digest"] == *digest;
            for run in summary["runs"].as_array().filter(|_| is_done).into_iter().flatten() {
                let number = |value: &Value| value.as_f64().map_or_else(String::new, exact);
                let [run_name, status] = ["name", "status"].map(|key| run[key].as_str().unwrap_or_default());
                let [over, error] = ["turned_over", "shape_error"].map(|key| &run["last"][key]);
                let over = over.as_u64().map_or_else(String::new, |count| count.to_string());
                let row = [name, run_name, status, &number(&run["time"]), &over, &number(error)];
                table.push(row.map(str::to_owned));
                let at = run["time"].as_f64().map_or_else(String::new, |time| format!(" at {} s", short(time)));
                let error = error.as_f64().map_or_else(String::new, |error| quantity(error, "m"));
                shown.push([name.to_owned(), run_name.to_owned(), format!("{status}{at}"), over, error]);
            }
        }
        Ok((rows_as_csv(table), shown))
    }

    fn table(&self, keys: &[String], rows: &[Row]) -> Vec<u8> {
        let folder = |name: &str| std::iter::once(name.to_owned());
        let head = folder("folder").chain(keys.iter().cloned()).collect::<Vec<_>>();
        let lines = self.variants.iter().zip(rows).map(|(variant, (row, _))| {
            folder(&variant.folder).chain(row.iter().map(str::to_owned)).collect::<Vec<_>>()
        });
        rows_as_csv(std::iter::once(head).chain(lines))
    }
}

/// Why a variant is no scene.
enum Wrong {
    /// A key cannot be changed.
    Key(String, String),
    Scene(SceneError),
}

/// The last parts of keys where they differ, else whole keys.
fn short_names(keys: &[String]) -> Vec<String> {
    let last = |key: &String| key.rsplit('.').next().unwrap_or_default().to_owned();
    let is_alone = |key: &String| keys.iter().filter(|other| last(other) == last(key)).count() == 1;
    let whole = |key: &String| key.chars().filter(|c| !"[]".contains(*c)).collect();
    keys.iter().map(|key| if is_alone(key) { last(key) } else { whole(key) }).collect()
}
