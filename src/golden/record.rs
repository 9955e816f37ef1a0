//! The text file of a golden: a record of its scene, frame by frame.
//!
//! A digest for each run and frame says whether a state is the same, bit for bit. Some frames also have diagnostics and
//! rounded positions, from which the distance is known when digests differ. The file has some tens of kilobytes for any
//! scene: for long scenes at most every second frame is recorded, for large bodies at most every second node.

use super::states::{Positions, Run, State, States, Step};
use crate::output::Tags;
use crate::sim::diagnostics::{Chosen, Reach, Value};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io;
use std::path::Path;

/// The name of the file in a golden's folder.
pub(crate) const RECORD_FILE: &str = "golden.toml";

/// The largest file that is read (bytes).
const LARGEST_FILE: u64 = 4 << 20;

/// The version of its format.
const FORMAT: u32 = 1;

/// Number of digits of each digest: 48 bits.
pub(super) const DIGITS: usize = 12;

/// Approximate maximum size of the digests and of the positions of a golden (bytes).
pub(super) const ROOM_FOR_DIGESTS: usize = 24 * 1024;
pub(super) const ROOM_FOR_POSITIONS: usize = 8 * 1024;
/// Approximate size of a coordinate (bytes).
pub(super) const COORDINATE: usize = 5;
/// Positions are rounded to about this part of the extent of all nodes.
const FINENESS: f64 = 1e-5;

/// The contents of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Record {
    /// Name of the scene or figure file.
    pub(super) subject: String,
    /// Digests of the scenes shown.
    pub(super) scenes: Vec<String>,
    /// Width and height of the pictures (px).
    pub(super) size: [u32; 2],
    /// Samples of each pixel.
    pub(super) pictures: Vec<Drawn>,
    pub(super) states: States,
}

/// A picture of a golden and the adapter that drew it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Drawn {
    /// Name of the file beside this one.
    pub(super) file: String,
    /// The frame shown; 0 for figures.
    pub(super) frame: u64,
    /// The graphics adapter with its driver.
    pub(super) adapter: String,
    /// The version of this crate.
    pub(super) version: String,
}

impl Drawn {
    /// A picture of a file name with this metadata.
    pub(super) fn new(file: &str, label: &Tags) -> Self {
        let (adapter, version) = (label.adapter.clone(), label.version.clone());
        Self { file: file.to_owned(), frame: label.frame().unwrap_or(0), adapter, version }
    }
}

/// The file as it is read and written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    subject: String,
    scenes: Vec<String>,
    size: [u32; 2],
    #[serde(rename = "picture", default)]
    pictures: Vec<Drawn>,
    #[serde(rename = "run", default)]
    runs: Vec<FileRun>,
    digests: String,
    numbers: String,
    positions: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileRun {
    name: String,
    nodes: usize,
    /// The stride of nodes with positions.
    every: usize,
    /// The unit of the integers in `positions` (m).
    quantum: f64,
    /// Time step and the scene's cycle T (s). Earlier versions of this program did not record them.
    step: Option<f64>,
    cycle: Option<f64>,
}

impl FileRun {
    fn step(&self) -> Option<Step> {
        Some(Step { step: self.step?, cycle: self.cycle? })
    }
}

impl File {
    /// Validates the values of a record.
    fn check(&self) -> Result<(), String> {
        let twice = |names: Vec<&str>| names.iter().collect::<BTreeSet<_>>().len() < names.len();
        if self.format != FORMAT {
            return Err(format!("it has the format {}; this version reads format {FORMAT}", self.format));
        }
        if self.runs.is_empty() || twice(self.runs.iter().map(|run| run.name.as_str()).collect()) {
            return Err("it has no `[[run]]`, or two of one name".to_owned());
        }
        let count = 1..=u32::MAX as usize;
        for FileRun { name, nodes, every, quantum, step, cycle } in &self.runs {
            let is_time = |time: &f64| time.is_finite() && *time > 0.0;
            if ![step, cycle].into_iter().flatten().all(is_time) {
                return Err(format!("run “{}” has a step or cycle that is not a positive number", short(name)));
            }
            let is_sound = count.contains(every) && *nodes <= *count.end();
            if !is_sound || !quantum.is_finite() || *quantum <= 0.0 {
                return Err(format!(
                    "run “{}” has nodes = {nodes}, every = {every} and quantum = {quantum:e}; expected positive numbers",
                    short(name)
                ));
            }
        }
        let is_plain =
            |file: &str| file.ends_with(".png") && !file.starts_with('.') && !file.contains(['/', '\\', ':']);
        if let Some(drawn) = self.pictures.iter().find(|drawn| !is_plain(&drawn.file)) {
            return Err(format!("“{}” is not a plain name of a PNG picture", short(&drawn.file)));
        }
        if self.pictures.is_empty() || twice(self.pictures.iter().map(|drawn| drawn.file.as_str()).collect()) {
            return Err("it has no `[[picture]]`, or two of one name".to_owned());
        }
        let [width, height] = self.size;
        if !self.size.iter().all(|side| (16..=16_384).contains(side)) {
            return Err(format!("pictures of {width}×{height} pixels cannot be drawn"));
        }
        Ok(())
    }
}

impl Record {
    /// Reads the text of a record.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let file: File = toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(1, |span| 1 + text[..span.start.min(text.len())].matches('\n').count());
            format!("line {line}: {}", short(error.message()))
        })?;
        file.check()?;
        let mut runs: Vec<Run> = file
            .runs
            .iter()
            .map(|run| Run { name: run.name.clone(), step: run.step(), states: BTreeMap::new() })
            .collect();
        for line in lines(&file.digests) {
            let wrong =
                || format!("`digests` has the line “{}”; expected a frame and a digest of each run", short(line));
            let mut words = line.split_whitespace();
            let frame: u64 = words.next().and_then(|word| word.parse().ok()).ok_or_else(wrong)?;
            let digests: Vec<_> = words.collect();
            if digests.len() != runs.len() {
                return Err(wrong());
            }
            if runs.iter().any(|run| run.states.contains_key(&frame)) {
                return Err(format!("`digests` has frame {frame} twice"));
            }
            for (run, digest) in runs.iter_mut().zip(digests) {
                if digest.len() < DIGITS || !digest.bytes().all(|byte| byte.is_ascii_hexdigit()) {
                    return Err(wrong());
                }
                run.states.insert(frame, State { digest: digest.to_owned(), ..State::default() });
            }
        }
        if runs.iter().any(|run| run.states.is_empty()) {
            return Err("`digests` is empty".to_owned());
        }
        for line in lines(&file.numbers) {
            let wrong = || format!("`numbers` has the line “{}”; expected frame, run and six numbers", short(line));
            let words: Vec<_> = line.split_whitespace().collect();
            let state = state_of(&mut runs, &words).ok_or_else(wrong)?.1;
            let numbers = Chosen::read(Reach::Goldens, |at, _| words.get(2 + at).copied());
            let numbers = numbers.filter(|numbers| numbers.iter().count() == words.len() - 2).ok_or_else(wrong)?;
            state.numbers = Some(numbers);
        }
        for line in lines(&file.positions) {
            let wrong = || {
                format!(
                    "`positions` has the line “{}”; expected frame, run and three whole numbers for each node",
                    short(line)
                )
            };
            let words: Vec<_> = line.split_whitespace().collect();
            let (run, state) = state_of(&mut runs, &words).ok_or_else(wrong)?;
            let FileRun { nodes, every, quantum, .. } = file.runs[run];
            let counts: Option<Vec<i64>> = words[2..].iter().map(|word| word.parse().ok()).collect();
            // The validated bounds prevent overflow.
            let coordinates = 3 * nodes.div_ceil(every);
            let counts = counts.filter(|counts| counts.len() == coordinates).ok_or_else(wrong)?;
            let vector = |at: &[i64]| DVec3::new(at[0] as f64, at[1] as f64, at[2] as f64) * quantum;
            state.positions =
                Some(Positions { quantum, every, nodes, at: counts.chunks_exact(3).map(vector).collect() });
        }
        let File { subject, scenes, size, pictures, .. } = file;
        Ok(Self { subject, scenes, size, pictures, states: States { runs } })
    }

    /// Reads the record of a golden's folder.
    ///
    /// # Errors
    /// If the file cannot be read; the inner error says what is wrong with its contents.
    pub(super) fn read(folder: &Path) -> io::Result<Result<Self, String>> {
        let path = folder.join(RECORD_FILE);
        let found = path.metadata()?;
        if !found.is_file() || found.len() > LARGEST_FILE {
            return Ok(Err("it is not a file, or is far too large: a record has some tens of kilobytes".to_owned()));
        }
        Ok(String::from_utf8(std::fs::read(&path)?)
            .map_err(|_| "it is not text".to_owned())
            .and_then(|text| Self::parse(&text)))
    }

    /// The text of the file, with positions rounded.
    pub(super) fn text(&self) -> String {
        let mut runs = Vec::new();
        let [mut digests, mut numbers, mut positions] = [const { String::new() }; 3];
        let frames: BTreeSet<u64> = self.states.runs.iter().flat_map(|run| run.states.keys().copied()).collect();
        for frame in &frames {
            // Only what is known of all runs is recorded.
            let states: Option<Vec<&State>> = self.states.runs.iter().map(|run| run.states.get(frame)).collect();
            let Some(states) = states else { continue };
            write!(digests, "\n{frame}").expect("writing to a string");
            for state in states {
                let digest: String = state.digest.chars().take(DIGITS).collect();
                write!(digests, " {digest}").expect("writing to a string");
            }
        }
        let bytes = |run: &Run| {
            let nodes = |state: &State| state.positions.as_ref().map_or(0, |positions| positions.at.len());
            3 * COORDINATE * run.states.values().map(nodes).sum::<usize>()
        };
        let all: usize = self.states.runs.iter().map(bytes).sum();
        let every = all.div_ceil(ROOM_FOR_POSITIONS).max(1);
        for (number, run) in self.states.runs.iter().enumerate() {
            let known = || run.states.values().filter_map(|state| state.positions.as_ref());
            let quantum = known().map(|positions| positions.quantum).fold(quantum(known()), f64::max);
            let nodes = known().map(|positions| positions.nodes).max().unwrap_or(0);
            // Values read from a record are rounded already.
            let every = if known().any(|positions| positions.every > 1) { 1 } else { every };
            let kept = known().map(|positions| positions.every).max().unwrap_or(1) * every;
            let [step, cycle] = [run.step.map(|step| step.step), run.step.map(|step| step.cycle)];
            runs.push(FileRun { name: run.name.clone(), nodes, every: kept, quantum, step, cycle });
            for (frame, state) in &run.states {
                let is_everywhere = self.states.runs.iter().all(|run| run.states.contains_key(frame));
                let Some(known) = state.positions.as_ref().filter(|_| is_everywhere) else { continue };
                if let Some(all) = &state.numbers {
                    write!(numbers, "\n{frame} {number}").expect("writing to a string");
                    for (_, value) in all.iter() {
                        match value {
                            Value::Count(count) => write!(numbers, " {count}"),
                            value => write!(numbers, " {:.5e}", value.size()),
                        }
                        .expect("writing to a string");
                    }
                }
                write!(positions, "\n{frame} {number}").expect("writing to a string");
                for coordinate in known.at.iter().step_by(every).flat_map(DVec3::to_array) {
                    write!(positions, " {}", (coordinate / quantum).round() as i64).expect("writing to a string");
                }
            }
        }
        self.file(&runs, [&digests, &numbers, &positions])
    }

    /// The file around its tables, formatted by hand for readability.
    fn file(&self, runs: &[FileRun], [digests, numbers, positions]: [&str; 3]) -> String {
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let scenes: Vec<_> = self.scenes.iter().map(|scene| quoted(scene)).collect();
        let [width, height] = self.size;
        let mut text = format!(
            "# What {} did when this was accepted. Written by localshape: not to be edited, but to be renewed.\n\
             format = {FORMAT}\nsubject = {}\nscenes = [{}]\nsize = [{width}, {height}]\n\n\
             # Frame, and the start of the digest of all positions and velocities of each run.\n\
             digests = '''{digests}\n'''\n\n\
             # Frame, run from 0, kinetic, elastic and gravitational energy (J), elements turned over, volume ratio, shape error (m).\n\
             numbers = '''{numbers}\n'''\n\n\
             # Frame, run, and x, y, z of the nodes in quanta of the run.\n\
             positions = '''{positions}\n'''\n",
            self.subject.replace(char::is_control, " "),
            quoted(&self.subject),
            scenes.join(", "),
        );
        for run in runs {
            let FileRun { name, nodes, every, quantum, .. } = run;
            write!(
                text,
                "\n[[run]]\nname = {}\nnodes = {nodes}\nevery = {every}\nquantum = {quantum:e}\n",
                quoted(name)
            )
            .expect("writing to a string");
            if let Some(Step { step, cycle }) = run.step() {
                write!(text, "step = {step:e}\ncycle = {cycle:e}\n").expect("writing to a string");
            }
        }
        for Drawn { file, frame, adapter, version } in &self.pictures {
            let [file, adapter, version] = [file, adapter, version].map(|text| quoted(text));
            write!(text, "\n[[picture]]\nfile = {file}\nframe = {frame}\nadapter = {adapter}\nversion = {version}\n")
                .expect("writing to a string");
        }
        text
    }
}

fn lines(table: &str) -> impl Iterator<Item = &str> {
    table.lines().map(str::trim).filter(|line| !line.is_empty())
}

/// The start of a line, for messages.
fn short(line: &str) -> String {
    match line.char_indices().nth(80) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// The run and the state that a line is about.
fn state_of<'a>(runs: &'a mut [Run], words: &[&str]) -> Option<(usize, &'a mut State)> {
    let (frame, run) = (words.first()?.parse::<u64>().ok()?, words.get(1)?.parse::<usize>().ok()?);
    Some((run, runs.get_mut(run)?.states.get_mut(&frame)?))
}

/// The step to which positions are rounded: a power of ten, about a hundred-thousandth of their extent over all frames (m).
fn quantum<'a>(positions: impl Iterator<Item = &'a Positions>) -> f64 {
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for at in positions.flat_map(|positions| &positions.at) {
        bounds = [bounds[0].min(*at), bounds[1].max(*at)];
    }
    let extent = (bounds[1] - bounds[0]).max_element();
    if !(extent.is_finite() && extent > 0.0) {
        return 1e-6;
    }
    let power = (extent * FINENESS).log10().floor().clamp(-12.0, 12.0) as i32;
    // Parsed from text, to be the nearest double.
    format!("1e{power}").parse().expect("a power of ten")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::diagnostics::{Diagnostic, Diagnostics};

    fn record() -> Record {
        let mut states = States::default();
        for frame in 0..=20_u64 {
            for run in ["Local shape", "½ \"quoted\" '''"] {
                let at: Vec<_> = (0..5).map(|node| DVec3::new(node as f64 * 0.1, frame as f64 * 0.01, -0.2)).collect();
                let positions = (frame % 10 == 0).then_some(Positions { quantum: 0.0, every: 1, nodes: 5, at });
                let all = Diagnostics { kinetic: 1.5, elastic: f64::NAN, turned_over: 3, ..Diagnostics::default() };
                let numbers = Chosen::within(Reach::Goldens, &all);
                let digest = format!("{:064x}", frame * 1_000_003);
                states.add(
                    run,
                    frame,
                    State { time: None, digest: digest.chars().rev().collect(), positions, numbers: Some(numbers) },
                );
            }
        }
        // The other run is as in a record of an earlier version of this program.
        states.set_steps([("Local shape", Step { step: 1.0 / 3.0, cycle: 0.1 })]);
        let drawn = Drawn { file: "frame_00010.png".into(), frame: 10, adapter: "a \"b\"".into(), version: "0".into() };
        Record {
            subject: "fig4b.toml".into(),
            scenes: vec!["ab".into()],
            size: [320, 180],
            pictures: vec![drawn],
            states,
        }
    }

    #[test]
    fn what_is_written_is_read_again_coarsely() {
        let exact = record();
        let text = exact.text();
        let read = Record::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!((&read.subject, &read.scenes, read.size), (&exact.subject, &exact.scenes, exact.size));
        assert_eq!(read.pictures, exact.pictures);
        assert_eq!([read.states.runs[0].step, read.states.runs[1].step], [exact.states.runs[0].step, None]);
        for (run, coarse) in exact.states.runs.iter().zip(&read.states.runs) {
            assert_eq!((&run.name, run.states.len()), (&coarse.name, coarse.states.len()));
            for (frame, state) in &run.states {
                let other = &coarse.states[frame];
                assert!(state.digest.starts_with(&other.digest) && other.digest.len() == DIGITS);
                assert_eq!(state.positions.is_some(), other.positions.is_some());
                if let Some((one, other)) = state.positions.as_ref().zip(other.positions.as_ref()) {
                    assert_eq!((other.quantum, other.nodes), (1e-6, 5));
                    assert!(one.at.iter().zip(&other.at).all(|(a, b)| a.distance(*b) < 1e-6));
                    assert_eq!(coarse.states[frame].numbers.as_ref().unwrap().get(Diagnostic::TurnedOver), 3.0);
                }
            }
        }
        assert_eq!(read.text(), text, "rounding once is enough");
    }

    #[test]
    fn damaged_records_are_refused_in_words() {
        let text = record().text();
        for (from, to, words) in [
            ("format = 1", "format = 2", "format 2"),
            ("format = 1", "format = 1\nmore = 2", "more"),
            ("\n5 ", "\nfive ", "`digests` has the line “five"),
            ("\n0 0", "\n0 zz0", "`digests`"),
            ("\n10 0 1.50000e0", "\n10 7 1.50000e0", "`numbers`"),
            ("\n20 1 0 200000", "\n20 1 200000", "`positions`"),
            ("[[run]]", "[[runs]]", "runs"),
            ("nodes = 5", "nodes = 6148914691236517206", "expected positive numbers"),
            ("every = 1", "every = 0", "expected positive numbers"),
            ("quantum = 1e-6", "quantum = nan", "expected positive numbers"),
            ("quantum = 1e-6", "quantum = -1e-6", "expected positive numbers"),
            ("cycle = 1e-1", "cycle = inf", "not a positive number"),
            ("frame_00010.png", "../frame_00010.png", "is not a plain name"),
            ("\n6 ", "\n5 ", "frame 5 twice"),
            ("size = [320", "size = [0", "cannot be drawn"),
            ("[[picture]]", "[picture_gone]", "picture_gone"),
        ] {
            assert!(text.contains(from), "{from}\n{text}");
            let error = Record::parse(&text.replacen(from, to, 1)).unwrap_err();
            assert!(error.contains(words), "{to}: {error}");
        }
    }

    #[test]
    fn however_large_the_scene_is_the_record_is_not() {
        let mut large = Record::default();
        let at: Vec<_> = (0..100_000).map(|node| DVec3::splat(node as f64)).collect();
        let positions = Some(Positions { quantum: 0.0, every: 1, nodes: at.len(), at });
        large.states.add("run", 0, State { digest: "0123456789abcdef".into(), positions, ..State::default() });
        large.pictures = record().pictures;
        large.size = [320, 180];
        let text = large.text();
        assert!(text.len() < 20_000, "{}", text.len());
        assert_eq!(Record::parse(&text).unwrap().text(), text);
        let none = Record::parse(&text.replace("0 0123456789ab", "")).unwrap_err();
        assert!(none.contains("`digests` is empty"), "{none}");
    }
}
