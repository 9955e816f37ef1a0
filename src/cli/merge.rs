//! `merge`: shards of a sequence, as `render --shard` makes them, into one folder.

use super::console;
use super::failure::{Failure, Status, note};
use super::interrupt;
use super::scenes::occupied;
use crate::output::{
    DIAGNOSTICS_FILE, Folder, OutputError, Plan, Replace, SUMMARY_FILE, Whose, document, frame_file_name, read_file,
    read_tags, relative, rows_as_csv, write_whole,
};
use clap::{Args, ValueHint};
use csv::StringRecord;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  localshape simulate scenes/fig4b.toml --states -o states
  localshape render scenes/fig4b.toml --from-states states/states.npz --shard 1/2 -o shards/1
  localshape render scenes/fig4b.toml --from-states states/states.npz --shard 2/2 -o shards/2
  localshape merge shards/* -o output/fig4b

Frames and diagnostics.csv have the bytes that one `localshape render` would have written. All shards have to be there, complete, \
and of the same scene, version, size and runs. docs/clusters.md has scripts for many machines.";

/// Join shards of a sequence in one folder
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Merge {
    /// Folders that `localshape render --shard` has made, one for each shard, in any order
    #[arg(value_name = "DIR", required = true, value_hint = ValueHint::DirPath)]
    shards: Vec<PathBuf>,

    /// The folder for the whole sequence
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    out: PathBuf,

    /// Replace files in that folder that belong to another scene, size or choice of runs
    #[arg(long)]
    overwrite: bool,

    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// One shard, as its files describe it.
#[derive(Debug)]
struct Part {
    folder: PathBuf,
    /// Its `run.json`.
    summary: Value,
    /// Which share it is, counted from 1, and of how many.
    shard: [usize; 2],
    /// The head of its diagnostics.
    head: StringRecord,
    /// Their rows by frame.
    rows: BTreeMap<u64, Vec<StringRecord>>,
}

impl Merge {
    pub(super) fn run(self, words: &[OsString]) -> Result<Status, Failure> {
        let mut parts: Vec<_> = self.shards.iter().map(|folder| Part::read(folder)).collect::<Result<_, _>>()?;
        parts.sort_by_key(|part| part.shard);
        check_alike(&parts)?;
        check_all_there(&parts)?;
        let size = parts[0].size()?;
        parts.iter().try_for_each(|part| part.check_frames(size))?;
        let place = |path: &Path| path.canonicalize().ok();
        if let Some(part) =
            parts.iter().find(|part| place(&self.out).is_some() && place(&part.folder) == place(&self.out))
        {
            bail!("-o {} is one of the shards; choose another folder", part.folder.display());
        }
        let mut frames: Vec<u64> = parts.iter().flat_map(|part| part.rows.keys().copied()).collect();
        frames.sort_unstable();
        let plan = Plan { runs: parts[0].runs(), frames: frames.clone(), states: false, size: Some(size) };
        let replace = if self.overwrite { Replace::All } else { Replace::Nothing };
        let folder = Folder::inspect(&self.out, parts[0].whose(), plan, replace, false);
        let folder = folder.map_err(|error| occupied(error, words))?.prepare()?;
        interrupt::listen();
        let mut summary = whole(&parts, frames.len(), words, folder.path(), self.quiet);
        write_summary(folder.path(), &summary)?;
        for (at, &frame) in frames.iter().enumerate() {
            if interrupt::requested() {
                summary["outcome"] = "interrupted".into();
                write_summary(folder.path(), &summary)?;
                return Ok(Status::Interrupted);
            }
            let name = frame_file_name(frame);
            let from = parts[at % parts.len()].folder.join(&name);
            let bytes = std::fs::read(&from).map_err(OutputError::reading(&from))?;
            write_whole(&folder.path().join(&name), &bytes)?;
        }
        write_whole(&folder.path().join(DIAGNOSTICS_FILE), &table(&parts, &frames))?;
        summary["outcome"] = "done".into();
        write_summary(folder.path(), &summary)?;
        if !self.quiet {
            let ([width, height], title) = (size, &parts[0].whose().title);
            let (count, shards, out) = (frames.len(), parts.len(), self.out.display());
            console::print(&format!("{title}\n{count} frames of {width}×{height} in {out}, from {shards} shards\n"))?;
        }
        Ok(Status::Done)
    }
}

impl Part {
    /// Reads a complete shard, but for its pictures.
    fn read(folder: &Path) -> Result<Self, Failure> {
        let name = folder.display();
        folder.metadata().map_err(OutputError::reading(folder))?;
        let bytes = read_file(&folder.join(SUMMARY_FILE))?;
        let summary: Option<Value> = bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let expected = "expected a folder that `localshape render --shard` has made";
        let summary = summary.filter(|summary| summary["localshape"].is_string());
        let summary =
            summary.ok_or_else(|| Failure::usage(format!("{name} has no {SUMMARY_FILE} of localshape; {expected}")))?;
        let shard = summary["frames"]["shard"].as_array().and_then(|shard| {
            let [number, of] = &shard[..] else { return None };
            Some([number.as_u64()? as usize, of.as_u64()? as usize])
        });
        let shard = shard.ok_or_else(|| Failure::usage(format!("{name} is no shard; {expected}")))?;
        if summary["outcome"] != "done" {
            let outcome = summary["outcome"].as_str().unwrap_or("unfinished");
            bail!("{name} is not complete ({outcome}); run its command again, with --resume");
        }
        let path = folder.join(DIAGNOSTICS_FILE);
        let broken = |error: csv::Error| Failure::files(format!("cannot read {}: {error}", path.display()));
        let mut table = csv::Reader::from_path(&path).map_err(broken)?;
        let head = table.headers().map_err(broken)?.clone();
        let mut part = Self { folder: folder.to_owned(), summary, shard, head, rows: BTreeMap::new() };
        for row in table.into_records() {
            let row = row.map_err(broken)?;
            let frame = row.get(1).and_then(|frame| frame.parse().ok());
            let frame = frame.ok_or_else(|| Failure::usage(format!("{} has a row without a frame", path.display())))?;
            part.rows.entry(frame).or_default().push(row);
        }
        let is_whole = part.rows.values().all(|rows| rows.len() == part.runs().len());
        if !is_whole || part.summary["frames"]["asked"] != part.rows.len() {
            bail!("{} does not have all frames; run the command again", path.display());
        }
        Ok(part)
    }

    /// The names of its runs.
    fn runs(&self) -> Vec<String> {
        let runs = self.summary["runs"].as_array().into_iter().flatten();
        runs.filter_map(|run| run["name"].as_str().map(str::to_owned)).collect()
    }

    /// Its scene.
    fn whose(&self) -> Whose {
        let text = |key: &str| self.summary["scene"][key].as_str().map(str::to_owned);
        let [digest, title] = ["digest", "title"].map(|key| text(key).unwrap_or_default());
        Whose { digest, title, file: text("file").map(PathBuf::from) }
    }

    /// Width and height of its frames (px).
    fn size(&self) -> Result<[u32; 2], Failure> {
        let size = serde_json::from_value(self.summary["frames"]["size"].clone());
        size.map_err(|_| {
            Failure::usage(format!("{} has no frames; expected a shard with pictures", self.folder.display()))
        })
    }

    /// Whether each of its frames is there, and is what it should be.
    fn check_frames(&self, size: [u32; 2]) -> Result<(), Failure> {
        let version = self.summary["localshape"].as_str().unwrap_or_default();
        let (whose, runs) = (self.whose(), self.runs());
        for &frame in self.rows.keys() {
            let path = self.folder.join(frame_file_name(frame));
            let found = if path.exists() { read_tags(&path)? } else { None };
            let is_it = found.is_some_and(|(found, tags)| {
                found == size
                    && tags.frame() == Some(frame)
                    && tags.scenes == [whose.digest.as_str()]
                    && tags.version == version
                    && tags.states.iter().map(|(_, run)| run).eq(&runs)
            });
            if !is_it {
                let what = if path.exists() { "is not that frame of this scene" } else { "is missing" };
                let help = "run the command of its shard again, with --resume";
                bail!("{} {what}; {help}", path.display());
            }
        }
        Ok(())
    }
}

/// Refuses shards of different sequences.
fn check_alike(parts: &[Part]) -> Result<(), Failure> {
    type Fact = (&'static str, fn(&Part) -> Value);
    const FACTS: [Fact; 6] = [
        ("the version of localshape", |part| part.summary["localshape"].clone()),
        ("the scene", |part| part.summary["scene"]["digest"].clone()),
        ("the number of shards", |part| part.shard[1].into()),
        ("the runs", |part| part.runs().into()),
        ("the size", |part| part.summary["frames"]["size"].clone()),
        ("the columns of diagnostics.csv", |part| part.head.iter().collect()),
    ];
    for (what, fact) in FACTS {
        if let Some(other) = parts.iter().find(|part| fact(part) != fact(&parts[0])) {
            let [one, two] = [&parts[0], other].map(|part| format!("{} ({})", part.folder.display(), fact(part)));
            bail!("{one} and {two} differ in {what}; expected shards of one sequence");
        }
    }
    Ok(())
}

/// Refuses holes and overlaps.
fn check_all_there(parts: &[Part]) -> Result<(), Failure> {
    if let Some(two) = parts.windows(2).find(|two| two[0].shard == two[1].shard) {
        let ([number, of], one, two) = (two[0].shard, two[0].folder.display(), two[1].folder.display());
        bail!("{one} and {two} are both shard {number}/{of}; expected each once");
    }
    let of = parts[0].shard[1];
    let missing = (1..=of).filter(|&number| parts.iter().all(|part| part.shard[0] != number));
    let missing: Vec<_> = missing.map(|number| format!("{number}/{of}")).collect();
    if let [_, ..] = missing[..] {
        let plural = if missing.len() == 1 { "" } else { "s" };
        bail!("missing: shard{plural} {}; expected all of {of}", missing.join(", "));
    }
    let frames = parts.iter().flat_map(|part| part.rows.keys().map(|&frame| (frame, part.shard[0])));
    let mut frames: Vec<_> = frames.collect();
    frames.sort_unstable();
    let help = "shards of the same --frames share these out in turn";
    if let Some(two) = frames.windows(2).find(|two| two[0].0 == two[1].0) {
        let [(frame, one), (_, other)] = [two[0], two[1]];
        bail!("frame {frame} is in shard {one}/{of} and in {other}/{of}; {help}");
    }
    for (at, &(frame, number)) in frames.iter().enumerate() {
        let expected = at % of + 1;
        if number != expected {
            bail!("frame {frame} is in shard {number}/{of} and should be in {expected}/{of}; {help}");
        }
    }
    Ok(())
}

/// The summary of the whole, before it is done: that of the shard with the last frame, and sums.
fn whole(parts: &[Part], frames: usize, words: &[OsString], folder: &Path, quiet: bool) -> Value {
    let last = parts.iter().max_by_key(|part| part.rows.keys().next_back());
    let mut whole = last.expect("there is a shard").summary.clone();
    let command: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
    (whole["command"], whole["outcome"], whole["times"]) = (json!(command), "unfinished".into(), Value::Null);
    for count in ["asked", "recorded", "written"] {
        whole["frames"][count] = frames.into();
    }
    if let Some(counts) = whole["frames"].as_object_mut() {
        for key in ["kept", "shard"] {
            counts.shift_remove(key);
        }
    }
    let mut adapters: Vec<_> = parts.iter().filter_map(|part| part.summary["adapter"].as_str()).collect();
    adapters.sort_unstable();
    adapters.dedup();
    if adapters.len() > 1 && !quiet {
        note(&format!(
            "the shards were drawn by different adapters, which differ in some pixels: {}",
            adapters.join("; ")
        ));
    }
    whole["adapter"] = adapters.join("; ").into();
    let path = parts[0].whose().file.and_then(|file| relative(&file, folder));
    if let Some(path) = path {
        whole["scene"]["relative_file"] = path.into();
    }
    for at in 0..parts[0].runs().len() {
        let of_parts = || parts.iter().map(|part| &part.summary["runs"][at]);
        let steps: u64 = of_parts().filter_map(|run| run["steps"].as_u64()).sum();
        let mut cut: Vec<u64> =
            of_parts().filter_map(|run| run["cut"].as_array()).flatten().filter_map(Value::as_u64).collect();
        cut.sort_unstable();
        whole["runs"][at]["steps"] = steps.into();
        if !cut.is_empty() {
            whole["runs"][at]["cut"] = cut.into();
        }
    }
    whole
}

/// The diagnostics of all shards, in the order of frames.
fn table(parts: &[Part], frames: &[u64]) -> Vec<u8> {
    let rows = frames.iter().enumerate().flat_map(|(at, frame)| &parts[at % parts.len()].rows[frame]);
    rows_as_csv(std::iter::once(&parts[0].head).chain(rows))
}

fn write_summary(folder: &Path, summary: &Value) -> Result<(), OutputError> {
    write_whole(&folder.join(SUMMARY_FILE), document(summary).as_bytes())
}
