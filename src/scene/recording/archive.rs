//! Recordings in NumPy archives.

use super::course::{Course, StoredRun};
use super::flaw::{Flaw, check_length};
use super::recorded::Recorded;
use super::rows::{Axes, Quantity, Rows, Track};
use crate::reading::words::{hexadecimal, list, nearest, quoted};
use crate::scene::file::LARGEST;
use crate::scene::limits::Limits;
use crate::scene::npz::{Array, Npz};
use crate::sim::{Divergence, State};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// A run of an archive.
#[derive(Debug)]
pub(crate) struct Archive {
    path: PathBuf,
    npz: Npz,
    /// Its name in the archive; empty for plain names.
    run: String,
}

impl Archive {
    /// Opens a run of an archive: the `chosen` one, or the one with plain names, the only one, or the one called like the
    /// run that shows it.
    pub(crate) fn open(path: &Path, chosen: Option<&str>, shown_as: &str) -> Result<Self, Flaw> {
        Self::of(Npz::open(path).map_err(|message| Flaw::new("", message))?, path, chosen, shown_as)
    }

    /// A run of an archive, which messages call by a path.
    pub(in crate::scene) fn of(npz: Npz, path: &Path, chosen: Option<&str>, shown_as: &str) -> Result<Self, Flaw> {
        let run = choose(&npz.names(), chosen, shown_as)?;
        Ok(Self { path: path.to_owned(), npz, run })
    }

    /// The archive, and the name of the run in it, which is empty for plain names.
    pub(in crate::scene) fn parts(&mut self) -> (&mut Npz, &str) {
        (&mut self.npz, &self.run)
    }

    /// The recording of the run, in axes of its file. Every number is read once. Arrays of which single moments cannot be read
    /// are copied.
    pub(in crate::scene) fn recorded(mut self, axes: Axes, limits: &Limits) -> Result<Recorded, Flaw> {
        let mut tracks = self.tracks()?;
        for track in &mut tracks {
            let name = full(&self.run, track.of.key());
            if !track.array.is_by_rows() {
                check_length(track.array.shape[0], track.array.shape[1], limits)?;
                self.npz.unfold(&mut track.array).map_err(|what| Flaw::new(&name, what))?;
            }
            track.check(&mut self.npz, &name, axes)?;
        }
        // The course that this program wrote describes these numbers only.
        let own = Course::read(&mut self.npz).ok().and_then(|(_, mut course, _)| {
            let run = course.runs.iter().position(|run| run.name == self.run)?;
            let run = course.runs.swap_remove(run);
            tracks.iter().zip(&run.digests).all(|(track, digests)| track.digests == *digests).then_some(run)
        });
        let times = self.times(tracks[0].array.shape[0], &tracks[0].digests)?;
        let name = self.name("time").unwrap_or_default();
        match times[..] {
            [start, ..] if start > 0.0 => {
                let message =
                    format!("is {start}: the recording begins at {start} s; expected the start of the scene, 0 s");
                let help = format!("subtract {start} from all its times, or add the moment at 0 s");
                return Err(Flaw::new(format!("{name}[0]"), message).with_help(help));
            }
            [.., end] if end < 0.0 => {
                return Err(Flaw::new(name, format!("ends at {end} s, before the start of the scene, 0 s")));
            }
            _ => {}
        }
        self.of_tracks(tracks, times, own.as_ref(), axes)
    }

    /// The states of the run as this program has stored them. Rows are compared with the digests of its course when they are
    /// read.
    ///
    /// # Errors
    /// The arrays are not those of the course.
    pub(crate) fn stored(mut self, course: &Course) -> Result<Recorded, Flaw> {
        let Some(run) = course.runs.iter().find(|run| run.name == self.run) else {
            return Err(Flaw::new("", format!("is damaged: it says nothing about {}", quoted(&self.run))));
        };
        let mut tracks = self.tracks()?;
        let name = full(&self.run, Quantity::Memory.key());
        let array = self.array(&name)?.ok_or_else(|| Flaw::new("", format!("has no array `{name}`")))?;
        tracks.push(Track { of: Quantity::Memory, array, digests: Vec::new(), is_flat: true });
        let moments = course.frames.len() as u64;
        for (track, digests) in tracks.iter_mut().zip(&run.digests) {
            let name = full(&self.run, track.of.key());
            if !track.array.is_by_rows() {
                return Err(Flaw::new(
                    name,
                    "is compressed or stored column by column; expected it as this program writes it",
                ));
            }
            if track.array.shape[0] != moments {
                let found = track.array.shape_in_words();
                let message = format!("has the shape {found}; expected {moments} rows, one for each frame");
                return Err(Flaw::new(name, message));
            }
            track.digests.clone_from(digests);
        }
        let times = self.times(moments, &tracks[0].digests)?;
        self.of_tracks(tracks, times, Some(run), Axes::default())
    }

    /// The recording of these tracks at these times, which may be those of a run of this program.
    fn of_tracks(
        mut self,
        tracks: Vec<Track>,
        mut times: Vec<f64>,
        own: Option<&StoredRun>,
        axes: Axes,
    ) -> Result<Recorded, Flaw> {
        let (step, engine) = (self.step()?, self.engine()?);
        let file = || self.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let source = engine.unwrap_or_else(file);
        let own = own.filter(|_| step.is_some());
        let divergence = own.and_then(|own| own.divergence);
        if let (Some(divergence), Some(step)) = (&divergence, step) {
            end_with(&mut times, divergence, step);
        }
        let mut hash = Sha256::new();
        times.iter().for_each(|time| hash.update(time.to_le_bytes()));
        hash.update(step.unwrap_or_default().to_le_bytes());
        // Captions have the name of the program or of the file, but not that of its folder.
        hash.update(&source);
        for track in &tracks {
            hash.update(track.of.key());
            track.digests.iter().for_each(|digest| hash.update(digest));
        }
        divergence.iter().for_each(|divergence| hash.update(divergence.step.to_le_bytes()));
        let position = &tracks[0].array.shape;
        let memory = tracks.iter().find(|track| track.of == Quantity::Memory);
        Ok(Recorded {
            path: self.path,
            name: self.run,
            times,
            step,
            source,
            nodes: position[1] as usize,
            columns: position[2] as usize,
            is_flat: tracks.iter().all(|track| track.is_flat),
            has_velocities: tracks.iter().any(|track| track.of == Quantity::Velocity),
            memory: memory.map(|track| track.array.shape[1] as usize),
            divergence,
            last_fit: own.and_then(|own| {
                let mut state = State::from_bytes(own.last_fit.as_ref()?)?;
                [&mut state.position, &mut state.velocity].into_iter().for_each(|vectors| axes.place(vectors));
                Some(state)
            }),
            axes,
            digest: hexadecimal(&hash.finalize()),
            rows: Mutex::new(Rows { npz: self.npz, tracks }),
            places: None,
            fault: Mutex::default(),
        })
    }

    /// Positions, and velocities if there are any, not yet read.
    fn tracks(&mut self) -> Result<Vec<Track>, Flaw> {
        let mut tracks: Vec<Track> = Vec::new();
        for of in [Quantity::Position, Quantity::Velocity] {
            let name = full(&self.run, of.key());
            let Some(array) = self.array(&name)? else { continue };
            let expected = match tracks.first() {
                Some(Track { array: like, .. }) if like.shape != array.shape => {
                    Some(format!("{}, as `position`", like.shape_in_words()))
                }
                _ if !matches!(array.shape[..], [_, _, 2 | 3]) || array.shape.contains(&0) => {
                    Some("moments × nodes × 3, in the plane × 2".to_owned())
                }
                _ => None,
            };
            if let Some(expected) = expected {
                let message = format!("has the shape {}; expected {expected}", array.shape_in_words());
                return Err(Flaw::new(name, message));
            }
            tracks.push(Track { of, array, digests: Vec::new(), is_flat: true });
        }
        Ok(tracks)
    }

    /// The header of an array with a row for each moment, if the archive has it.
    fn array(&mut self, name: &str) -> Result<Option<Array>, Flaw> {
        let Some(array) = self.npz.array(name) else { return Ok(None) };
        let array = array.map_err(|message| Flaw::new(name, message))?;
        let wrong = match () {
            () if array.shape.len() < 2 => {
                format!("has the shape {}; expected moments × nodes × 3, in the plane × 2", array.shape_in_words())
            }
            () if array.is_by_rows() && !self.npz.has_room_for(&array) => {
                "is longer than the file, which is damaged".to_owned()
            }
            () => return Ok(Some(array)),
        };
        Err(Flaw::new(name, wrong))
    }

    /// The name of an array in the archive: that of the run's own, or else of all runs. `None` if there is neither.
    fn name(&mut self, key: &str) -> Option<String> {
        let names = self.npz.names();
        [full(&self.run, key), key.to_owned()].into_iter().find(|name| names.contains(name))
    }

    /// The times of the moments, rising. Moments of the same state may have the same time, as frames of this program that are nearer
    /// than a step, or come after a divergence. `digests` are those of the positions.
    fn times(&mut self, moments: u64, digests: &[[u8; 32]]) -> Result<Vec<f64>, Flaw> {
        let Some(name) = self.name("time") else {
            let message = format!("has no array `{}`, the time of each moment (s)", full(&self.run, "time"));
            return Err(Flaw::new("", message));
        };
        let times = self.numbers(&name, &[moments], &format!("{moments}, one time for each moment of `position`"))?;
        for (at, &time) in times.iter().enumerate() {
            let place = || format!("{name}[{at}]");
            if time.is_nan() || time.abs() > LARGEST {
                return Err(Flaw::new(place(), format!("is {time}; expected a finite time (s)")));
            }
            let falls = |&before: &usize| {
                time < times[before] || time == times[before] && digests.get(before) != digests.get(at)
            };
            if let Some(before) = at.checked_sub(1).filter(falls).map(|before| times[before]) {
                return Err(Flaw::new(place(), format!("is {time}, after {before}; expected rising times")));
            }
        }
        Ok(times)
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
        Ok((0..values.rows).map(|row| values.double(row, 0)).collect())
    }
}

/// The name of an array of a run.
pub(in crate::scene) fn full(run: &str, key: &str) -> String {
    if run.is_empty() { key.to_owned() } else { format!("{run}.{key}") }
}

/// Lets the times of the frames of a run that diverged end with its last finite state, which all later frames have, in the
/// step before.
fn end_with(times: &mut Vec<f64>, divergence: &Divergence, step: f64) {
    let last = divergence.step.saturating_sub(1) as f64 * step;
    let before = times.partition_point(|&time| time < last);
    if let Some(time) = times.get_mut(before) {
        *time = last;
        times.truncate(before + 1);
    }
}

/// The name of the run to show among the arrays of an archive; empty for plain names.
fn choose(names: &[String], chosen: Option<&str>, shown_as: &str) -> Result<String, Flaw> {
    let runs: Vec<&str> = names.iter().filter_map(|name| name.strip_suffix(".position")).collect();
    let all = || list(&runs, "and", quoted);
    if let Some(chosen) = chosen {
        if runs.contains(&chosen) {
            return Ok(chosen.to_owned());
        }
        let only = if runs.is_empty() {
            "; its runs have arrays `NAME.position`".to_owned()
        } else {
            format!(", only {}", all())
        };
        let help = nearest(chosen, &runs).map(|near| format!("did you mean {}?", quoted(near)));
        return Err(Flaw { help, ..Flaw::new("", format!("has no run {}{only}", quoted(chosen))) });
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
            Err(Flaw::new("", format!("has no array `position`; {found}")).with_help(help))
        }
        [first, ..] => {
            let help = format!("choose one, as by run = {}", quoted(first));
            Err(Flaw::new("", format!("has the runs {}", all())).with_help(help))
        }
    }
}
