//! `--sweep`: variants of a scene, one for each line of a table, each in a folder of its own.

use super::failure::{Failure, warn_of};
use super::frames::Shard;
use super::options::{RunOptions, SceneOptions};
use crate::output::{OutputError, read_file, write_whole};
use crate::reading::report::mistake;
use crate::reading::source::Source;
use crate::reading::{Mistake, Mistakes};
use crate::scene::{Limits, Scene, SceneError};
use csv::{ReaderBuilder, StringRecord, Trim};
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

/// Variants of a scene.
#[derive(Debug)]
pub(super) struct Sweep {
    scene: PathBuf,
    limits: Limits,
    /// Those of the shard.
    variants: Vec<Variant>,
    folder: PathBuf,
    /// The contents of the table of all variants.
    table: Vec<u8>,
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
        let found = fs::metadata(file).map_err(OutputError::reading(file))?;
        if found.is_file() && found.len() > LONGEST {
            return Err(Failure::usage(format!("{name} is longer than {LONGEST} bytes; split the sweep")));
        }
        let bytes = read_file(file)?
            .ok_or_else(|| Failure::usage(format!("{name} is no file; expected a table, such as sweep.csv")))?;
        let text = String::from_utf8(bytes).map_err(|_| Failure::usage(format!("{name} is not text in UTF-8")))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let (keys, rows) = rows(text).map_err(|error| Failure::usage(format!("{name}: {error}")))?;
        let mut sweep =
            Self { scene: path.clone(), limits, variants: Vec::new(), folder: PathBuf::new(), table: Vec::new() };
        sweep.folder = options
            .out
            .as_deref()
            .map_or_else(|| Path::new("output").join(format!("{}-sweep", base.name)), Path::to_owned);
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
        let mut warnings = sweep.check(file, text, &keys, &rows, check)?;
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

    /// Reads all variants, so that nothing is made before all mistakes are known, and returns the warnings, each at its cell.
    fn check(
        &self,
        file: &Path,
        text: &str,
        keys: &[String],
        rows: &[Row],
        check: impl Fn(&Scene) -> Result<(), Failure>,
    ) -> Result<Vec<Mistake>, Failure> {
        let source = Source::new(text);
        let mut warnings = Vec::new();
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
                let start = if is_key { 0 } else { *start };
                add(cell(text, start, column_of(&one.place)), one.message, one.help);
            }
        }
        match total {
            0 => Ok(warnings),
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

    /// Writes the table of all variants with their folders, and returns the variants, each with its folder, read one at a time.
    pub(super) fn variants(&self) -> Result<impl Iterator<Item = Result<(Scene, PathBuf), Failure>>, Failure> {
        let path = self.folder.join(VARIANTS_FILE);
        if read_file(&path)?.is_some_and(|bytes| !bytes.starts_with(b"folder,")) {
            return Err(Failure::usage(format!(
                "{} was not written by localshape; choose another folder with -o",
                path.display()
            )));
        }
        fs::create_dir_all(&self.folder).map_err(OutputError::writing(&self.folder))?;
        write_whole(&path, &self.table)?;
        Ok((0..self.variants.len()).map(|number| match self.scene(number) {
            Ok(scene) => Ok((scene, self.folder.join(&self.variants[number].folder))),
            Err(Wrong::Scene(error)) => Err(Failure::usage(error.to_string())),
            Err(Wrong::Key(_, message)) => Err(Failure::usage(message)),
        }))
    }

    fn table(&self, keys: &[String], rows: &[Row]) -> Vec<u8> {
        let mut table = csv::Writer::from_writer(Vec::new());
        let folder = |name: &str| std::iter::once(name.to_owned());
        let head = folder("folder").chain(keys.iter().cloned()).collect::<Vec<_>>();
        let lines = self.variants.iter().zip(rows).map(|(variant, (row, _))| {
            folder(&variant.folder).chain(row.iter().map(str::to_owned)).collect::<Vec<_>>()
        });
        for line in std::iter::once(head).chain(lines) {
            table.write_record(line).expect("rows of equal length into memory");
        }
        table.into_inner().expect("memory takes all")
    }
}

/// Why a variant is no scene.
enum Wrong {
    /// A key cannot be changed.
    Key(String, String),
    Scene(SceneError),
}

/// The cells of a line, and the place of its first byte.
type Row = (StringRecord, usize);

/// The keys and the lines of a table.
fn rows(text: &str) -> Result<(Vec<String>, Vec<Row>), String> {
    let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(text.as_bytes());
    let keys: Vec<String> = reader.headers().map_err(|error| error.to_string())?.iter().map(str::to_owned).collect();
    if let Some(at) = (0..keys.len()).find(|&at| keys[at].is_empty() || keys[..at].contains(&keys[at])) {
        return Err(format!(
            "the key of column {} is {}; expected one such as run[0].model.stiffness",
            at + 1,
            if keys[at].is_empty() { "missing" } else { "given a second time" }
        ));
    }
    let rows = reader.into_records().map(|row| {
        let row = row.map_err(|error| match error.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                let line = error.position().map_or(0, csv::Position::line);
                format!("line {line} has {len} values; expected {expected_len}, one for each key")
            }
            _ => "is no table of comma-separated values".to_owned(),
        })?;
        let start = row.position().map_or(0, |position| position.byte() as usize);
        Ok((row, start))
    });
    let rows: Vec<_> = rows.collect::<Result<_, String>>()?;
    if keys.is_empty() || rows.is_empty() {
        return Err(
            "has no variants; expected a line of keys, such as body.lattice.side, and one line of values for each"
                .to_owned(),
        );
    }
    Ok((keys, rows))
}

/// The span of a cell in the line that begins at a byte.
fn cell(text: &str, start: usize, column: usize) -> Range<usize> {
    let (mut begin, mut at, mut left, mut is_quoted) = (start, start, column, false);
    for byte in text.as_bytes().get(start..).unwrap_or_default() {
        match byte {
            b'"' => is_quoted = !is_quoted,
            b',' if !is_quoted && left > 0 => (left, begin) = (left - 1, at + 1),
            b',' | b'\r' | b'\n' if !is_quoted => break,
            _ => {}
        }
        at += 1;
    }
    begin..at.max(begin)
}

/// The value of a cell: as in a scene file, or a text without quotation marks.
fn value(cell: &str) -> toml::Value {
    let typed = toml::from_str::<toml::Table>(&format!("value = {cell}")).ok();
    let typed = typed.filter(|table| table.len() == 1).and_then(|mut table| table.remove("value"));
    typed.unwrap_or_else(|| toml::Value::String(cell.to_owned()))
}

/// Sets the value of a key such as `run[0].model.stiffness`.
fn set(root: &mut toml::Table, key: &str, value: toml::Value) -> Result<(), String> {
    let expected = || format!("`{key}` is no key; expected one such as body.lattice.side or run[0].model.stiffness");
    let mut parts = Vec::new();
    for part in key.split('.') {
        let (name, indices) = part.split_at(part.find('[').unwrap_or(part.len()));
        let indices = indices.split_terminator(']').map(|index| index.strip_prefix('[')?.trim().parse().ok());
        parts.push((name, indices.collect::<Option<Vec<usize>>>().filter(|_| !name.is_empty()).ok_or_else(expected)?));
    }
    let (last, before) = parts.split_last().ok_or_else(expected)?;
    let mut table = root;
    for (name, indices) in before {
        let entry = table.entry(*name).or_insert_with(|| toml::Value::Table(toml::Table::new()));
        table = within(entry, name, indices)?
            .as_table_mut()
            .ok_or_else(|| format!("`{name}` in `{key}` is not a table in the scene"))?;
    }
    let (name, indices) = last;
    if indices.is_empty() {
        table.insert((*name).to_owned(), value);
    } else {
        let entry = table.get_mut(*name).ok_or_else(|| format!("the scene has no `{key}`"))?;
        *within(entry, name, indices)? = value;
    }
    Ok(())
}

/// An entry of nested arrays.
fn within<'a>(mut value: &'a mut toml::Value, name: &str, indices: &[usize]) -> Result<&'a mut toml::Value, String> {
    for &index in indices {
        let items = value.as_array_mut().ok_or_else(|| format!("`{name}` is not an array in the scene"))?;
        let count = items.len();
        value = items
            .get_mut(index)
            .ok_or_else(|| format!("the scene has no `{name}[{index}]`; it has {count}, counted from 0"))?;
    }
    Ok(value)
}

/// The last parts of keys where they differ, else whole keys.
fn short_names(keys: &[String]) -> Vec<String> {
    let last = |key: &String| key.rsplit('.').next().unwrap_or_default().to_owned();
    let is_alone = |key: &String| keys.iter().filter(|other| last(other) == last(key)).count() == 1;
    let whole = |key: &String| key.chars().filter(|c| !"[]".contains(*c)).collect();
    keys.iter().map(|key| if is_alone(key) { last(key) } else { whole(key) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_typed_as_in_scenes_and_texts_need_no_quotation_marks() {
        let text = |text: &str| toml::Value::String(text.to_owned());
        assert_eq!(value("1e4"), toml::Value::Float(1e4));
        assert_eq!(value("[3, 3]"), toml::Value::Array(vec![3.into(), 3.into()]));
        assert_eq!(value("true"), toml::Value::Boolean(true));
        assert_eq!((value("T/50"), value("\"T/50\"")), (text("T/50"), text("T/50")));
        assert_eq!(value("1\nother = 2"), text("1\nother = 2"));
    }

    #[test]
    fn keys_are_those_of_messages() {
        let mut root: toml::Table = "run = [{ step = 1 }, { step = 2 }]\nbody.side = 1".parse().unwrap();
        set(&mut root, "run[1].step", 7.into()).unwrap();
        set(&mut root, "body.spin.axis", 8.into()).unwrap();
        assert_eq!(root, "run = [{ step = 1 }, { step = 7 }]\nbody.side = 1\nbody.spin.axis = 8".parse().unwrap());
        for (key, message) in [
            ("run[2].step", "the scene has no `run[2]`; it has 2, counted from 0"),
            ("body[0].side", "`body` is not an array in the scene"),
            ("body.side.x", "`side` in `body.side.x` is not a table in the scene"),
            ("run[x].step", "`run[x].step` is no key"),
            ("run..step", "`run..step` is no key"),
            ("grab[0]", "the scene has no `grab[0]`"),
        ] {
            let error = set(&mut root, key, 1.into()).unwrap_err();
            assert!(error.contains(message), "{key}: {error}");
        }
    }

    #[test]
    fn cells_are_found_in_their_lines() {
        let text = "a,b\n1,\"x, y\",3\n";
        let at = |start, column| &text[cell(text, start, column)];
        assert_eq!([at(0, 1), at(4, 0), at(4, 1), at(4, 2)], ["b", "1", "\"x, y\"", "3"]);
    }
}
