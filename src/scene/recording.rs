//! Runs that were computed elsewhere: positions and velocities over time, in a NumPy archive beside the scene.
//!
//! Rows of the archive are read when they are shown, so memory does not grow with the recording.

use super::file::LARGEST;
use super::npz::{Array, Npz};
use crate::reading::words::{count, list, nearest, quoted};
use crate::sim::{Divergence, Recording, State};
use glam::DVec3;
use sha2::{Digest, Sha256};
use std::collections::VecDeque;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A moment is shown exactly if it is nearer than this share of the time to the next recorded one.
const AT: f64 = 1e-9;
/// Bytes that are checked together when a recording is opened.
const BLOCK: usize = 1 << 23;
/// Rows that are kept: those of central differences on both sides of a moment, with velocities or without.
const KEPT: usize = 4;

/// A run of an archive.
#[derive(Debug)]
pub struct Recorded {
    path: PathBuf,
    archive: Mutex<Npz>,
    /// Its name in the archive; empty for plain names.
    name: String,
    /// The recorded moments (s), rising, the first at 0 or before.
    times: Vec<f64>,
    /// The time step of the program that made it (s), if it is known.
    step: Option<f64>,
    /// The program that made it, in its own words.
    engine: Option<String>,
    position: Track,
    velocity: Option<Track>,
    /// Why a row could not be read again.
    fault: Mutex<Option<String>>,
}

/// One vector for each node in each moment.
#[derive(Debug)]
struct Track {
    array: Array,
    /// The SHA-256 of each row.
    digests: Vec<[u8; 32]>,
    /// Whether the third coordinate, if there is one, is zero everywhere.
    is_flat: bool,
}

/// A mistake in an archive.
#[derive(Clone, Debug)]
pub(super) struct Flaw {
    /// The array or entry; empty for the whole file.
    pub(super) place: String,
    pub(super) message: String,
    pub(super) help: Option<String>,
}

impl Flaw {
    fn new(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { place: place.into(), message: message.into(), help: None }
    }
}

impl Recorded {
    /// Opens a run of an archive: the `chosen` one, or the one with plain names, the only one, or the one called like the
    /// run that shows it. Every number is read once.
    pub(super) fn open(path: &Path, chosen: Option<&str>, shown_as: &str) -> Result<Self, Flaw> {
        let mut npz = Npz::open(path).map_err(|message| Flaw::new("", message))?;
        let run = choose(&npz.names(), chosen, shown_as)?;
        let mut arrays = Arrays { npz: &mut npz, run: &run };
        let Some(mut position) = arrays.track("position", None)? else { unreachable!("the chosen run has positions") };
        let mut velocity = arrays.track("velocity", Some(&position))?;
        let times = arrays.times(position.array.shape[0])?;
        let (step, engine) = (arrays.step()?, arrays.engine()?);
        position.check(&mut npz, &full(&run, "position"))?;
        velocity.iter_mut().try_for_each(|track| track.check(&mut npz, &full(&run, "velocity")))?;
        let (archive, fault) = (Mutex::new(npz), Mutex::default());
        Ok(Self { path: path.into(), archive, name: run, times, step, engine, position, velocity, fault })
    }

    /// Its name in the archive; empty for plain names.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// The archive.
    pub(super) fn archive(&self) -> MutexGuard<'_, Npz> {
        self.archive.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The number of recorded moments.
    pub fn moments(&self) -> usize {
        self.times.len()
    }

    /// Whether velocities are recorded. Otherwise they are central differences of positions.
    pub fn has_velocities(&self) -> bool {
        self.velocity.is_some()
    }

    /// The time step of the program that made it (s), if it is known.
    pub(super) fn step(&self) -> Option<f64> {
        self.step
    }

    /// The program that made it, or the name of the file.
    pub fn source(&self) -> String {
        let file = || self.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        self.engine.clone().unwrap_or_else(file)
    }

    /// Where it comes from, and its number of states: `MuJoCo 4.0, recorded, 61 states`.
    pub(crate) fn description(&self) -> String {
        let moments = count(self.moments() as u128);
        format!("{}, recorded, {moments} state{}", self.source(), if self.moments() == 1 { "" } else { "s" })
    }

    /// The number of nodes.
    pub(super) fn nodes(&self) -> u64 {
        self.position.array.shape[1]
    }

    /// The number of coordinates of each node, and whether the third is zero everywhere.
    pub(super) fn coordinates(&self) -> (u64, bool) {
        let is_flat = self.tracks().all(|(_, track)| track.is_flat);
        (self.position.array.shape[2], is_flat)
    }

    /// A digest of its times, positions, velocities and words, 64 hexadecimal digits.
    pub(super) fn digest(&self) -> String {
        let mut hash = Sha256::new();
        self.times.iter().for_each(|time| hash.update(time.to_le_bytes()));
        hash.update(self.step.unwrap_or_default().to_le_bytes());
        hash.update(self.source());
        for (name, track) in self.tracks() {
            hash.update(name);
            track.digests.iter().for_each(|digest| hash.update(digest));
        }
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Its states after numbers of steps (s).
    pub(crate) fn player(self: &Arc<Self>, step: f64) -> Player {
        Player { recorded: Arc::clone(self), step, rows: VecDeque::new() }
    }

    /// The state at the start.
    pub(super) fn start(self: &Arc<Self>) -> State {
        let mut state = State::default();
        self.player(1.0).show(0, &mut state);
        state
    }

    /// Fails if a row could not be read since it was opened.
    pub(crate) fn fault(&self) -> io::Result<()> {
        match &*self.fault.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(what) => Err(io::Error::new(io::ErrorKind::InvalidData, format!("{} {what}", self.path.display()))),
            None => Ok(()),
        }
    }

    fn tracks(&self) -> impl Iterator<Item = (&'static str, &Track)> {
        std::iter::once(("position", &self.position)).chain(self.velocity.iter().map(|track| ("velocity", track)))
    }

    /// The vectors of a track in a recorded moment.
    fn row(&self, track: &Track, moment: usize) -> Result<Vec<DVec3>, String> {
        let mut bytes = vec![0; track.row()];
        self.archive().part(&track.array, (moment * bytes.len()) as u64, &mut bytes)?;
        if Sha256::digest(&bytes)[..] != track.digests[moment] {
            return Err("has changed since it was opened".to_owned());
        }
        let mut numbers = track.array.numbers(&bytes);
        let mut next = || numbers.next().unwrap_or_default();
        let (nodes, is_plane) = (self.nodes(), track.array.shape[2] == 2);
        Ok((0..nodes).map(|_| DVec3::new(next(), next(), if is_plane { 0.0 } else { next() })).collect())
    }
}

impl Track {
    /// The length of a row (bytes).
    fn row(&self) -> usize {
        self.array.shape[1..].iter().product::<u64>() as usize * self.array.width()
    }

    /// Reads every number once.
    fn check(&mut self, npz: &mut Npz, name: &str) -> Result<(), Flaw> {
        let (row, moments) = (self.row(), self.array.shape[0] as usize);
        let columns = self.array.shape[2] as usize;
        let at_once = (BLOCK / row).clamp(1, moments.max(1));
        let mut bytes = vec![0; at_once * row];
        self.digests.reserve_exact(moments);
        let mut third: f64 = 0.0;
        for first in (0..moments).step_by(at_once) {
            let bytes = &mut bytes[..at_once.min(moments - first) * row];
            npz.part(&self.array, (first * row) as u64, bytes).map_err(|what| Flaw::new(name, what))?;
            for (moment, bytes) in (first..).zip(bytes.chunks_exact(row)) {
                let is_beyond = |number: f64| number.is_nan() || number.abs() > LARGEST;
                if let Some(at) = self.array.numbers(bytes).position(is_beyond) {
                    let number = self.array.numbers(bytes).nth(at).unwrap_or_default();
                    let place = format!("{name}[{moment}][{}][{}]", at / columns, at % columns);
                    let expected = match number.is_finite() {
                        true => format!("a magnitude up to {LARGEST:e}"),
                        false => "a finite number; write only the moments before the motion failed".to_owned(),
                    };
                    return Err(Flaw::new(place, format!("is {number}; expected {expected}")));
                }
                if columns == 3 && third == 0.0 {
                    third = self.array.numbers(bytes).skip(2).step_by(3).fold(third, |most, z| most.max(z.abs()));
                }
                self.digests.push(Sha256::digest(bytes).into());
            }
        }
        self.is_flat = third == 0.0;
        Ok(())
    }
}

/// The name of an array of a run.
pub(super) fn full(run: &str, key: &str) -> String {
    if run.is_empty() { key.to_owned() } else { format!("{run}.{key}") }
}

/// The name of the run to show among the arrays of an archive; empty for plain names.
fn choose(names: &[String], chosen: Option<&str>, shown_as: &str) -> Result<String, Flaw> {
    let runs: Vec<&str> = names.iter().filter_map(|name| name.strip_suffix(".position")).collect();
    let all = || list(&runs, "and", quoted);
    if let Some(chosen) = chosen {
        if runs.contains(&chosen) {
            return Ok(chosen.to_owned());
        }
        let help = match (nearest(chosen, &runs), &runs[..]) {
            (Some(near), _) => format!("did you mean {}?", quoted(near)),
            (None, []) => "its runs have arrays `NAME.position`".to_owned(),
            (None, _) => format!("its runs are {}", all()),
        };
        return Err(Flaw { help: Some(help), ..Flaw::new("", format!("has no run {}", quoted(chosen))) });
    }
    match runs[..] {
        _ if names.iter().any(|name| name == "position") => Ok(String::new()),
        [only] => Ok(only.to_owned()),
        _ if runs.contains(&shown_as) => Ok(shown_as.to_owned()),
        [] => {
            let found = if names.is_empty() {
                "it is empty".to_owned()
            } else {
                format!("it has {}", list(names, "and", |name| format!("`{name}`")))
            };
            let help =
                "expected `position`, one row for each moment and node; docs/recordings.md tells how to write it";
            Err(Flaw { help: Some(help.to_owned()), ..Flaw::new("", format!("has no array `position`; {found}")) })
        }
        [first, ..] => {
            let help = format!("choose one, as by run = {}", quoted(first));
            Err(Flaw { help: Some(help), ..Flaw::new("", format!("has the runs {}", all())) })
        }
    }
}

/// The arrays of a run in an archive.
struct Arrays<'a> {
    npz: &'a mut Npz,
    run: &'a str,
}

impl Arrays<'_> {
    /// The name of an array in the archive: that of the run's own, or else of all runs. `None` if there is neither.
    fn name(&mut self, key: &str) -> Option<String> {
        let names = self.npz.names();
        [full(self.run, key), key.to_owned()].into_iter().find(|name| names.contains(name))
    }

    /// The header of an array of vectors, with a vector for each node in each moment.
    fn track(&mut self, key: &str, like: Option<&Track>) -> Result<Option<Track>, Flaw> {
        let name = full(self.run, key);
        let Some(array) = self.npz.array(&name) else { return Ok(None) };
        let array = array.map_err(|message| Flaw::new(&name, message))?;
        let wrong = |expected: String| {
            let found = format!("has the shape {}; expected {expected}", array.shape_in_words());
            Err(Flaw::new(&name, found))
        };
        if let Some(Track { array: other, .. }) = like.filter(|like| like.array.shape != array.shape) {
            return wrong(format!("{}, as `position`", other.shape_in_words()));
        }
        if !matches!(array.shape[..], [_, _, 2 | 3]) || array.shape.contains(&0) {
            return wrong("moments × nodes × 3, in the plane × 2".to_owned());
        }
        if !array.is_float() {
            let message = format!("is {}; expected float64 or float32", array.type_in_words());
            return Err(Flaw::new(name, message));
        }
        if !array.is_by_rows() {
            let message = "is stored column by column; expected rows, as by numpy.ascontiguousarray";
            return Err(Flaw::new(name, message));
        }
        if array.is_packed() {
            let message = "is compressed; expected an archive of numpy.savez, of which single moments can be read";
            return Err(Flaw::new(name, message));
        }
        if !self.npz.has_room_for(&array) {
            return Err(Flaw::new(name, "is longer than the file, which is damaged"));
        }
        Ok(Some(Track { array, digests: Vec::new(), is_flat: true }))
    }

    /// The times of the moments, rising.
    fn times(&mut self, moments: u64) -> Result<Vec<f64>, Flaw> {
        let Some(name) = self.name("time") else {
            let message = format!("has no array `{}`, the time of each moment (s)", full(self.run, "time"));
            return Err(Flaw::new("", message));
        };
        let times = self.numbers(&name, &[moments], &format!("{moments}, one time for each moment of `position`"))?;
        for (at, &time) in times.iter().enumerate() {
            let place = || format!("{name}[{at}]");
            if time.is_nan() || time.abs() > LARGEST {
                return Err(Flaw::new(place(), format!("is {time}; expected a finite time (s)")));
            }
            match at.checked_sub(1).map(|before| times[before]) {
                Some(before) if time <= before => {
                    let message = format!("is {time}, after {before}; expected rising times");
                    return Err(Flaw::new(place(), message));
                }
                None if time > 0.0 => {
                    let message =
                        format!("is {time}: the recording begins at {time} s; expected the start of the scene, 0 s");
                    return Err(Flaw::new(place(), message));
                }
                _ => {}
            }
        }
        match times.last() {
            Some(end) if *end < 0.0 => {
                let message = format!("ends at {end} s, before the start of the scene, 0 s");
                Err(Flaw::new(name, message))
            }
            _ => Ok(times),
        }
    }

    /// The time step (s), if there is one.
    fn step(&mut self) -> Result<Option<f64>, Flaw> {
        let Some(name) = self.name("step") else { return Ok(None) };
        let step = self.numbers(&name, &[], "one number, the time step (s)")?[0];
        let is_step = step.is_normal() && step > 0.0 && step <= LARGEST;
        if is_step {
            Ok(Some(step))
        } else {
            Err(Flaw::new(name, format!("is {step}; expected a time step (s) above 0")))
        }
    }

    /// The name of the program that made it, if it is there.
    fn engine(&mut self) -> Result<Option<String>, Flaw> {
        let Some(name) = self.name("engine") else { return Ok(None) };
        let text = self.npz.text(&name).map_err(|message| Flaw::new(&name, message))?;
        let is_short = text.chars().count() <= 80 && !text.chars().any(char::is_control);
        let message = "has no place in a caption; expected the name of a program, up to 80 letters on one line";
        if is_short { Ok(Some(text).filter(|text| !text.trim().is_empty())) } else { Err(Flaw::new(name, message)) }
    }

    /// The numbers of an array of a shape.
    fn numbers(&mut self, name: &str, shape: &[u64], expected: &str) -> Result<Vec<f64>, Flaw> {
        let flaw = |message: String| Flaw::new(name, message);
        let array = self.npz.array(name).unwrap_or_else(|| Err("is missing".to_owned())).map_err(flaw)?;
        // One number may be an array of one.
        let is_right = array.shape == shape || shape.is_empty() && array.shape == [1];
        if !is_right {
            return Err(flaw(format!("has the shape {}; expected {expected}", array.shape_in_words())));
        }
        let values = self.npz.values(&array).map_err(flaw)?;
        Ok((0..values.rows()).map(|row| values.double(row, 0)).collect())
    }
}

/// The states of a recording after numbers of steps. Moments between two recorded ones are linear in time.
#[derive(Debug)]
pub(crate) struct Player {
    recorded: Arc<Recorded>,
    /// Time of a step (s).
    step: f64,
    /// The rows read last: whether of velocities, their moments and vectors.
    rows: VecDeque<(bool, usize, Arc<[DVec3]>)>,
}

impl Player {
    /// Positions or velocities in a recorded moment.
    fn row(&mut self, of_velocities: bool, moment: usize) -> Result<Arc<[DVec3]>, String> {
        if let Some((_, _, row)) = self.rows.iter().find(|(of, at, _)| (*of, *at) == (of_velocities, moment)) {
            return Ok(Arc::clone(row));
        }
        let Recorded { position, velocity, .. } = &*self.recorded;
        let track = velocity.as_ref().filter(|_| of_velocities).unwrap_or(position);
        let row: Arc<[DVec3]> = self.recorded.row(track, moment)?.into();
        if self.rows.len() == KEPT {
            self.rows.pop_front();
        }
        self.rows.push_back((of_velocities, moment, Arc::clone(&row)));
        Ok(row)
    }

    /// The velocities in a recorded moment: the recorded ones, or central differences of positions. At the first and last
    /// moment, differences on one side.
    fn velocity(&mut self, moment: usize) -> Result<Vec<DVec3>, String> {
        if self.recorded.has_velocities() {
            return Ok(self.row(true, moment)?.to_vec());
        }
        let recorded = Arc::clone(&self.recorded);
        let times = &recorded.times;
        let here = self.row(false, moment)?;
        let mut slope = |other: Option<usize>| -> Result<Option<(f64, Vec<DVec3>)>, String> {
            let Some(other) = other.filter(|&other| other < times.len()) else { return Ok(None) };
            let (there, apart) = (self.row(false, other)?, times[other] - times[moment]);
            Ok(Some((apart.abs(), there.iter().zip(&*here).map(|(&there, &here)| (there - here) / apart).collect())))
        };
        Ok(match (slope(moment.checked_sub(1))?, slope(Some(moment + 1))?) {
            // The slope of the parabola through three moments: with equal intervals the mean of both slopes.
            (Some((before, falling)), Some((after, rising))) => {
                let share = before / (before + after);
                falling.iter().zip(&rising).map(|(falling, rising)| falling.lerp(*rising, share)).collect()
            }
            (Some((_, slope)), None) | (None, Some((_, slope))) => slope,
            (None, None) => vec![DVec3::ZERO; here.len()],
        })
    }

    /// Positions and velocities at a time (s).
    fn at(&mut self, time: f64) -> Result<[Vec<DVec3>; 2], String> {
        let (times, last) = (&self.recorded.times, self.recorded.times.len() - 1);
        let before = times.partition_point(|&moment| moment <= time).saturating_sub(1);
        let share = if before == last { 0.0 } else { (time - times[before]) / (times[before + 1] - times[before]) };
        let exact = match share {
            ..=AT => Some(before),
            _ if share >= 1.0 - AT => Some(before + 1),
            _ => None,
        };
        if let Some(moment) = exact {
            return Ok([self.row(false, moment)?.to_vec(), self.velocity(moment)?]);
        }
        let between = |one: &[DVec3], other: &[DVec3]| {
            one.iter().zip(other).map(|(one, other)| one.lerp(*other, share)).collect()
        };
        let (from, to) = (self.velocity(before)?, self.velocity(before + 1)?);
        let velocity = between(&from, &to);
        Ok([between(&self.row(false, before)?, &self.row(false, before + 1)?), velocity])
    }
}

impl Recording for Player {
    fn end(&self) -> Divergence {
        let time = self.recorded.times.last().copied().unwrap_or_default();
        // A moment shows the nearest step.
        Divergence {
            time,
            step: ((time / self.step).round() as u64).saturating_add(1),
            part: 0,
            element: None,
            is_end: true,
        }
    }

    fn show(&mut self, steps: u64, state: &mut State) {
        match self.at(steps as f64 * self.step) {
            Ok([position, velocity]) => (state.position, state.velocity) = (position, velocity),
            Err(what) => {
                let mut fault = self.recorded.fault.lock().unwrap_or_else(PoisonError::into_inner);
                fault.get_or_insert(what);
            }
        }
    }
}
