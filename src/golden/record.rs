//! The text file of a golden: the keys of its scene, and its states frame by frame.
//!
//! A digest for each run and frame tells whether a state is the same, bit for bit. Eleven frames from the first to the
//! last also have rounded positions, which give the distance when digests differ. The file has some tens of kilobytes
//! for any scene: long scenes have digests of fewer frames, large bodies positions of fewer nodes.

use super::keys::Key;
use super::states::{Run, State, States};
use crate::sim::geometry::bounds;
use glam::DVec3;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// The name of the file in a golden's folder.
pub(crate) const RECORD_FILE: &str = "golden.toml";
/// The version of its format.
const FORMAT: u32 = 2;
/// Number of digits of each digest: 48 bits.
pub(super) const DIGITS: usize = 12;
/// Approximate maximum size of the positions of a golden (bytes).
const ROOM_FOR_POSITIONS: usize = 12 << 10;
/// Approximate size of a coordinate (bytes).
const COORDINATE: usize = 7;
/// The precision of rounded positions, about, in extents of all nodes.
const FINENESS: f64 = 1e-5;

/// The contents of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Record {
    /// Name of the scene or figure file.
    pub(super) subject: String,
    /// Width and height of the pictures (px).
    pub(super) size: [u32; 2],
    /// Frames with pictures; 0 for figures.
    pub(super) frames: BTreeSet<u64>,
    /// The keys of the scene.
    pub(super) keys: Vec<Key>,
    pub(super) states: States,
}

/// The fields of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    subject: String,
    size: [u32; 2],
    frames: BTreeSet<u64>,
    runs: Vec<String>,
    nodes: Vec<usize>,
    every: usize,
    quantum: f64,
    keys: Vec<String>,
    digests: String,
    positions: String,
}

impl File {
    fn check(&self) -> Result<(), String> {
        let names: BTreeSet<_> = self.runs.iter().collect();
        if self.format != FORMAT {
            return Err(format!("it has the format {}, this version of localshape reads {FORMAT}", self.format));
        }
        if names.is_empty() || names.len() < self.runs.len() || self.runs.len() != self.nodes.len() {
            return Err("expected `runs` with different names, and `nodes` with one number for each".to_owned());
        }
        let most = u32::MAX as usize;
        if !(1..=most).contains(&self.every) || self.nodes.iter().any(|&nodes| nodes > most) {
            return Err("`every` or `nodes` is out of range".to_owned());
        }
        if !self.quantum.is_finite() || self.quantum <= 0.0 {
            return Err(format!("`quantum` is {}, expected a positive number", self.quantum));
        }
        let [width, height] = self.size;
        if self.frames.is_empty() || !self.size.iter().all(|side| (16..=16_384).contains(side)) {
            return Err(format!("it has no `frames`, or pictures of {width}×{height} pixels"));
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
        let named = file.runs.iter().zip(&file.nodes);
        let runs = named.map(|(name, &nodes)| Run { name: name.clone(), nodes, ..Run::default() });
        let mut states = States { runs: runs.collect(), every: file.every, quantum: file.quantum };
        for line in lines(&file.digests) {
            read_digests(line, &mut states).ok_or_else(|| {
                format!("`digests` has the line “{}”; expected a frame and a digest of each run", short(line))
            })?;
        }
        for line in lines(&file.positions) {
            read_positions(line, &mut states).ok_or_else(|| {
                format!(
                    "`positions` has the line “{}”; expected frame, run and whole numbers for all nodes",
                    short(line)
                )
            })?;
        }
        if states.last().is_none() {
            return Err("`digests` is empty".to_owned());
        }
        let keys = file.keys.iter().map(|line| key(line)).collect();
        Ok(Self { subject: file.subject, size: file.size, frames: file.frames, keys, states })
    }

    /// The text of the file, with positions rounded.
    pub(super) fn text(&self) -> String {
        let runs = &self.states.runs;
        let (mut digests, mut positions) = (String::new(), String::new());
        // Positions of a record are rounded already.
        let (every, quantum) = match self.states.quantum {
            0.0 => (stride(&self.states), quantum(&self.states)),
            quantum => (1, quantum),
        };
        let frames: BTreeSet<u64> = runs.iter().flat_map(|run| run.states.keys().copied()).collect();
        for frame in frames {
            // A frame is recorded only if the states of all runs are known.
            let states: Option<Vec<&State>> = runs.iter().map(|run| run.states.get(&frame)).collect();
            let Some(states) = states else { continue };
            let short = states.iter().map(|state| &state.digest[..DIGITS.min(state.digest.len())]);
            let _ = writeln!(digests, "{frame} {}", short.collect::<Vec<_>>().join(" "));
            for (run, at) in states.iter().enumerate().filter_map(|(run, state)| Some((run, state.positions.as_ref()?)))
            {
                let whole = |coordinate: f64| ((coordinate / quantum).round() as i64).to_string();
                let numbers = at.iter().step_by(every).flat_map(DVec3::to_array).map(whole);
                let _ = writeln!(positions, "{frame} {run} {}", numbers.collect::<Vec<_>>().join(" "));
            }
        }
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let names: Vec<_> = runs.iter().map(|run| quoted(&run.name)).collect();
        let keys: String =
            self.keys.iter().map(|(path, value)| format!("  {},\n", quoted(&format!("{path} = {value}")))).collect();
        format!(
            "# What a scene did when this was accepted. Written by localshape, not to be edited.\n\
             format = {FORMAT}\nsubject = {}\nsize = {:?}\nframes = {:?}\n\
             runs = [{}]\nnodes = {:?}\nevery = {}\nquantum = {quantum:e}\n\n\
             # What the scene says.\n\
             keys = [\n{keys}]\n\n\
             # Frame, and the start of the digest of all positions and velocities of each run.\n\
             digests = '''\n{digests}'''\n\n\
             # Frame, run from 0, and x, y, z of every node, or of every second, third …, in quanta (m).\n\
             positions = '''\n{positions}'''\n",
            quoted(&self.subject),
            self.size,
            self.frames.iter().collect::<Vec<_>>(),
            names.join(", "),
            runs.iter().map(|run| run.nodes).collect::<Vec<_>>(),
            every * self.states.every,
        )
    }
}

/// The key of a line.
fn key(line: &str) -> Key {
    let (path, value) = line.split_once(" = ").unwrap_or((line, ""));
    (path.to_owned(), value.to_owned())
}

/// Whether a text is a record.
pub(crate) fn is_record(text: &str) -> bool {
    Record::parse(text).is_ok_and(|record| !record.text().is_empty())
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

/// Adds the states of a line of digests; `None` if the line is wrong.
fn read_digests(line: &str, states: &mut States) -> Option<()> {
    let mut words = line.split_whitespace();
    let frame: u64 = words.next()?.parse().ok()?;
    let digests: Vec<&str> = words.collect();
    let is_digest = |digest: &&str| digest.len() >= DIGITS && digest.bytes().all(|byte| byte.is_ascii_hexdigit());
    if digests.len() != states.runs.len() || !digests.iter().all(is_digest) {
        return None;
    }
    for (run, digest) in states.runs.iter_mut().zip(digests) {
        let state = State { digest: digest.to_owned(), positions: None };
        if run.states.insert(frame, state).is_some() {
            return None;
        }
    }
    Some(())
}

/// Adds the positions of a line to the state that it names; `None` if the line is wrong.
fn read_positions(line: &str, states: &mut States) -> Option<()> {
    let mut words = line.split_whitespace();
    let (frame, run): (u64, usize) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    let counts: Vec<i64> = words.map(str::parse).collect::<Result<_, _>>().ok()?;
    let run = states.runs.get_mut(run)?;
    let state = run.states.get_mut(&frame)?;
    // The checked bounds prevent overflow.
    if counts.len() != 3 * run.nodes.div_ceil(states.every) {
        return None;
    }
    let vector = |at: &[i64]| DVec3::new(at[0] as f64, at[1] as f64, at[2] as f64) * states.quantum;
    state.positions = Some(counts.chunks_exact(3).map(vector).collect());
    Some(())
}

/// The stride of nodes at which the known positions fit into a record.
fn stride(states: &States) -> usize {
    let known = states.runs.iter().flat_map(|run| run.states.values()).filter_map(|state| state.positions.as_ref());
    (3 * COORDINATE * known.map(Vec::len).sum::<usize>()).div_ceil(ROOM_FOR_POSITIONS).max(1)
}

/// The step to which positions are rounded: a power of ten, about a hundred-thousandth of their extent over all frames (m).
fn quantum(states: &States) -> f64 {
    let known = states.runs.iter().flat_map(|run| run.states.values()).filter_map(|state| state.positions.as_ref());
    let (low, high) = bounds(&known.flatten().copied().collect::<Vec<_>>());
    let extent = (high - low).max_element();
    if !(extent.is_finite() && extent > 0.0) {
        return 1e-6;
    }
    let power = (extent * FINENESS).log10().floor().clamp(-12.0, 12.0) as i32;
    // Parsed from text, which gives the nearest double.
    format!("1e{power}").parse().expect("a power of ten")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> Record {
        let mut states = States::default();
        for frame in 0..=20_u64 {
            for run in ["Local shape", "½ \"quoted\" '''"] {
                let at = (0..5).map(|node| DVec3::new(f64::from(node) * 0.1, frame as f64 * 0.01, -0.2)).collect();
                let digest: String = format!("{:064x}", frame * 1_000_003).chars().rev().collect();
                let run = states.run_mut(run);
                run.nodes = 5;
                run.states.insert(frame, State { digest, positions: (frame % 10 == 0).then_some(at) });
            }
        }
        let keys = ["title = \"½ '''\"", "gravity = [0, -9.8, 0]"].map(key).into();
        Record { subject: "fig4b.toml".into(), size: [320, 180], frames: [10, 20].into(), keys, states }
    }

    #[test]
    fn what_is_written_is_read_again_coarsely() {
        let exact = record();
        let text = exact.text();
        let read = Record::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!((&read.subject, read.size, &read.frames), (&exact.subject, exact.size, &exact.frames));
        assert_eq!((&read.keys, read.states.quantum, read.states.every), (&exact.keys, 1e-6, 1));
        for (run, coarse) in exact.states.runs.iter().zip(&read.states.runs) {
            assert_eq!((&run.name, run.nodes, run.states.len()), (&coarse.name, coarse.nodes, coarse.states.len()));
            for (frame, state) in &run.states {
                let other = &coarse.states[frame];
                assert!(state.digest.starts_with(&other.digest) && other.digest.len() == DIGITS);
                let [one, other] = [state, other].map(|state| state.positions.as_deref().unwrap_or_default());
                assert_eq!(one.len(), other.len());
                assert!(one.iter().zip(other).all(|(a, b)| a.distance(*b) < 1e-6));
            }
        }
        assert_eq!(read.text(), text, "rounding once is enough");
    }

    #[test]
    fn damaged_records_are_refused_in_words() {
        let text = record().text();
        for (from, to, words) in [
            ("format = 2", "format = 1", "it has the format 1"),
            ("format = 2", "format = 2\nmore = 2", "more"),
            ("\n5 ", "\nfive ", "`digests` has the line “five"),
            ("\n0 0", "\n0 zz0", "`digests`"),
            ("\n6 ", "\n5 ", "`digests`"),
            ("\n10 0 0", "\n10 7 0", "`positions`"),
            ("\n10 0 0", "\n21 0 0", "`positions`"),
            ("\n20 1 0 200000", "\n20 1 200000", "`positions`"),
            ("runs = [", "runs = [\"one\", ", "`runs`"),
            ("nodes = [5", "nodes = [6148914691236517206", "out of range"),
            ("every = 1", "every = 0", "out of range"),
            ("quantum = 1e-6", "quantum = nan", "a positive number"),
            ("quantum = 1e-6", "quantum = -1e-6", "a positive number"),
            ("size = [320", "size = [0", "0×180"),
            ("frames = [10, 20]", "frames = []", "no `frames`"),
        ] {
            assert!(text.contains(from), "{from}\n{text}");
            let error = Record::parse(&text.replacen(from, to, 1)).unwrap_err();
            assert!(error.contains(words), "{to}: {error}");
        }
    }

    #[test]
    fn however_large_the_scene_is_the_record_is_not() {
        let mut large = record();
        large.states = States::default();
        let run = large.states.run_mut("run");
        run.nodes = 100_000;
        for frame in (0..=10).map(|at| 100_000 * at) {
            let positions = Some((0..100_000).map(|node| DVec3::splat(f64::from(node))).collect());
            run.states.insert(frame, State { digest: "0123456789abcdef".into(), positions });
        }
        let text = large.text();
        let read = Record::parse(&text).expect("sound");
        assert!(text.len() < 20_000 && read.text() == text, "{}", text.len());
        assert!(read.states.runs[0].states.values().all(|state| state.positions.is_some()));
        let none = Record::parse(&text.replace(" 0123456789ab", "")).unwrap_err();
        assert!(none.contains("`digests`"), "{none}");
    }
}
