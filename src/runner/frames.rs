//! Frames in rising order: simulated or recorded on request, or all simulated before the first one. The progress can be
//! saved, so that another process continues.

use super::growing::{Growing, Grown};
use super::last_fit::Fitting;
use super::{Frame, History, RunFrame, Runner, Running, Stored, TableRow, TimeSeries};
use crate::sim::State;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::io;
use std::path::Path;

/// Frames of a scene in rising order. The scene is simulated once, even if the first frame needs the time series of the
/// whole scene, or not at all if its states are stored.
pub(crate) struct Frames<'a> {
    runner: Runner<'a>,
    frames: Vec<u64>,
    /// The number of frames that were returned or skipped.
    taken: usize,
    /// True when every run has reached the next frame.
    is_searching: bool,
    /// The stored time series, until they are returned.
    known: Option<History>,
    /// The states of frames, if everything is simulated before the first one: they wait until the time series are known.
    waiting: Option<Waiting>,
}

/// The progress of a simulation, from which it continues with the same bits.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Progress {
    /// The present state of each run, as bytes.
    states: Vec<Vec<u8>>,
    /// The time series so far.
    history: History,
    /// The rows between frames of each run that are not taken yet.
    rows: Vec<Option<VecDeque<TableRow>>>,
    /// The results of [`Frames::last_fit`] for each run, with states as bytes.
    last_fits: Vec<Option<Option<Vec<u8>>>>,
    /// Whether the bodies of each run need not be watched any more.
    met: Vec<bool>,
    /// The number of frames returned.
    pub(crate) taken: usize,
    /// The file of waiting states and the end of each in it, if states wait until the end of the simulation.
    waiting: Option<(Grown, Vec<u64>)>,
}

impl Progress {
    /// The file with waiting states.
    pub(crate) fn waiting(&self) -> Option<Grown> {
        self.waiting.as_ref().map(|(grown, _)| *grown)
    }
}

/// The states of frames, stored until they are drawn.
struct Waiting {
    file: Growing,
    /// The end of each state in the file.
    ends: Vec<u64>,
    /// The number of frames reached by the simulation.
    reached: usize,
    is_known: bool,
}

/// The next result.
#[derive(Debug)]
pub(crate) enum Next {
    /// Some more steps were taken.
    Working,
    /// The time series of the scene from start to end, before the first frame.
    TimeSeries(History),
    /// The next frame.
    Frame(Frame),
    /// No frames are left.
    Done,
}

impl<'a> Frames<'a> {
    /// Frames of a runner at its start, in rising order. With a file for `waiting` states the runner must record time
    /// series, and everything is simulated before the first frame is returned.
    pub(crate) fn new(runner: Runner<'a>, frames: &[u64], waiting: Option<Growing>) -> Self {
        let waiting = waiting.map(Waiting::new);
        Self { runner, frames: frames.to_vec(), taken: 0, is_searching: false, known: None, waiting }
    }

    /// The progress of the simulation; `None` once it is finished. Waiting states are on the disk then.
    ///
    /// # Errors
    /// The waiting states cannot be written.
    pub(crate) fn progress(&mut self) -> io::Result<Option<Progress>> {
        let Self { runner, frames, taken, waiting, .. } = self;
        let waiting = match waiting {
            None if *taken < frames.len() => None,
            Some(Waiting { file, ends, is_known: false, .. }) => Some((file.sync()?, ends.clone())),
            _ => return Ok(None),
        };
        let states = runner.runs.iter_mut().map(|running| {
            running.world.settle();
            running.look();
            running.world.state().to_bytes()
        });
        let states = states.collect();
        let series = runner.runs.iter().map(|running| running.series.clone()).collect();
        let history = History { end: 0.0, series };
        let rows = runner.runs.iter().map(|running| running.rows.clone()).collect();
        let met = runner.runs.iter().map(|running| running.watch.is_none()).collect();
        let (taken, runs) = (*taken, 0..runner.runs.len());
        let last_fit = |place| Some(self.last_fit(place)?.map(State::to_bytes));
        let last_fits = runs.map(last_fit).collect();
        Ok(Some(Progress { states, history, rows, last_fits, met, taken, waiting }))
    }

    /// Continues from the progress of another process with the same runs and frames, before the first call of
    /// [`Self::next`].
    ///
    /// # Errors
    /// The progress belongs to other runs or frames.
    pub(crate) fn resume(&mut self, progress: Progress) -> io::Result<()> {
        let Self { runner, frames, taken, waiting, .. } = self;
        let Progress { states, history, rows, last_fits, met, taken: returned, waiting: before } = progress;
        let runs = runner.runs.len();
        let reached = match (waiting, before) {
            (None, None) => Some(returned),
            (Some(to_fill), Some((grown, ends)))
                if returned == 0 && ends.is_sorted() && ends.last().copied().unwrap_or(0) == grown.length =>
            {
                (to_fill.reached, to_fill.ends) = (ends.len() / runs.max(1), ends);
                Some(to_fill.reached)
            }
            _ => None,
        };
        let reached = reached.filter(|&reached| reached <= frames.len()).ok_or(io::ErrorKind::InvalidData)?;
        let end = runner.scene.last_frame();
        // The next frame and the next moment of a time series must lie ahead.
        let next = runner.scene.moment(frames.get(reached).copied().unwrap_or(end));
        let fit = [states.len(), history.series.len(), rows.len(), last_fits.len(), met.len()] == [runs; 5];
        if !fit || !history.series.iter().zip(&runner.runs).all(|(series, running)| series.fits(&running.series)) {
            return Err(io::ErrorKind::InvalidData.into());
        }
        let found = runner.runs.iter_mut().zip(states).zip(history.series).zip(rows).zip(last_fits).zip(met);
        for (((((running, state), series), rows), last_fit), met) in found {
            let state = State::from_bytes(&state).filter(|state| running.world.takes(state));
            running.world.set_state(state.ok_or(io::ErrorKind::InvalidData)?);
            (running.series, running.rows) = (series, rows);
            running.watch = running.watch.take().filter(|_| !met);
            running.watch.iter_mut().for_each(|watch| watch.goes_on(&running.world));
            if let Some(found) = last_fit {
                let read = |bytes: Vec<u8>| {
                    let state = State::from_bytes(&bytes).filter(|state| running.world.takes(state));
                    state.ok_or(io::Error::from(io::ErrorKind::InvalidData))
                };
                let found = found.map(read).transpose()?;
                running.last_fit = found.map(|state| Fitting::new(&mut running.world, state)).into();
            }
            let note = running.notes.get(running.series.times.len()).filter(|_| running.series.divergence.is_none());
            let first = note.map_or(u64::MAX, |&note| running.world.steps_at(note)).min(running.world.steps_at(next));
            if running.world.steps() > first {
                return Err(io::ErrorKind::InvalidData.into());
            }
        }
        *taken = returned;
        Ok(())
    }

    /// Stored frames of a runner at its start, in rising order.
    ///
    /// # Errors
    /// The stored states do not belong to these runs.
    pub(crate) fn stored(runner: Runner<'a>, frames: &[u64], stored: Stored) -> io::Result<Self> {
        let mut runner = runner.playing(&stored.recordings).ok_or(io::ErrorKind::InvalidData)?;
        let mut rows = stored.rows;
        runner.runs.iter_mut().for_each(|running| running.rows = rows.remove(&running.run));
        Ok(Self { known: stored.history, ..Self::new(runner, frames, None) })
    }

    /// Advances each run by at most `most_steps`.
    ///
    /// # Errors
    /// Stored states cannot be written or read.
    pub(crate) fn next(&mut self, most_steps: u64) -> io::Result<Next> {
        let Self { runner, frames, taken, is_searching, known, waiting } = self;
        if let Some(history) = known.take() {
            return Ok(Next::TimeSeries(history));
        }
        if let Some(waiting) = waiting.as_mut().filter(|waiting| !waiting.is_known) {
            let frame = frames.get(waiting.reached).copied();
            let moment = runner.scene.moment(frame.unwrap_or(runner.scene.last_frame()));
            if !runner.advance_towards(moment, most_steps) {
                return Ok(Next::Working);
            }
            if frame.is_some() {
                runner.runs.iter().try_for_each(|running| waiting.put(&running.world.state().to_bytes()))?;
                waiting.reached += 1;
                return Ok(Next::Working);
            }
            runner.check()?;
            waiting.is_known = true;
            return Ok(Next::TimeSeries(runner.take_history()));
        }
        let Some(&frame) = frames.get(*taken) else { return Ok(Next::Done) };
        let moment = runner.scene.moment(frame);
        if waiting.is_none() && !runner.advance_towards(moment, most_steps) {
            return Ok(Next::Working);
        }
        runner.check()?;
        let first = *taken * runner.runs.len();
        if let (Some(waiting), false) = (waiting, *is_searching) {
            for (place, running) in runner.runs.iter_mut().enumerate() {
                let state = State::from_bytes(&waiting.get(first + place)?);
                let state = state.filter(|state| running.world.takes(state));
                running.world.set_state(state.ok_or(io::ErrorKind::InvalidData)?);
            }
        }
        let found = runner.runs.par_iter_mut().map(|running| running.find_last_fit(most_steps));
        *is_searching = !found.reduce(|| true, |one, other| one && other);
        if *is_searching {
            return Ok(Next::Working);
        }
        *taken += 1;
        Ok(Next::Frame(runner.taken(frame)))
    }

    /// The steps taken so far and the steps at the end, of all runs together.
    pub(crate) fn steps(&self) -> [u64; 2] {
        let scene = self.runner.scene;
        let last = match self.waiting {
            Some(_) => scene.last_frame(),
            None => self.frames.last().copied().unwrap_or(0),
        };
        [self.reached().into_iter().fold(0, u64::saturating_add), self.runner.steps_at(scene.moment(last))]
    }

    /// The time that all runs have reached, and the time of the last frame (s); `None` once the simulation is finished.
    pub(crate) fn on_the_way(&self) -> Option<[f64; 2]> {
        let end = match &self.waiting {
            None => *self.frames.get(self.taken..)?.last()?,
            Some(waiting) if !waiting.is_known => self.runner.scene.last_frame(),
            Some(_) => return None,
        };
        let times = self.runner.runs.iter().map(|running| running.world.steps() as f64 * running.of.step);
        Some([times.fold(f64::INFINITY, f64::min), self.runner.scene.frame_time(end)])
    }

    /// The simulated steps of each run so far, with those of earlier processes.
    pub(crate) fn simulated(&self) -> Vec<u64> {
        let runs = self.reached().into_iter().zip(&self.runner.runs);
        runs.map(|(steps, running)| if running.recording.is_some() { 0 } else { steps }).collect()
    }

    /// The steps of each run so far.
    fn reached(&self) -> Vec<u64> {
        let end = self.runner.scene.moment(self.runner.scene.last_frame());
        let steps = |running: &Running| match &self.waiting {
            // Finished runs are then set back to each frame.
            Some(waiting) if waiting.is_known => running.world.steps_at(end),
            _ => running.world.steps(),
        };
        self.runner.runs.iter().map(steps).collect()
    }

    /// The states of all runs in the last returned frame; before the first one, those at the start.
    pub(crate) fn states(&self) -> impl Iterator<Item = &State> {
        self.runner.runs.iter().map(|running| running.world.state())
    }

    /// The drawn state of a run that diverges, if the returned frames show another than the present one: the last state
    /// that fits. The inner `None` means that the run does not diverge.
    pub(crate) fn last_fit(&self, place: usize) -> Option<Option<&State>> {
        let found = self.runner.runs[place].last_fit.get()?;
        Some(found.as_ref().map(|found| &found.state))
    }

    /// The time series so far, empty once they were returned.
    pub(crate) fn series(&self) -> impl Iterator<Item = &TimeSeries> {
        self.runner.runs.iter().map(|running| &running.series)
    }

    /// The rows of each run after the last frame, to the step of this one, which was returned; none before the first frame.
    pub(crate) fn take_rows(&mut self, frame: &Frame) -> Vec<Vec<TableRow>> {
        let is_first = self.taken == 1;
        let of_run = |(running, run): (&mut Running, &RunFrame)| {
            let (time, rows) = (run.snapshot.time, running.rows.get_or_insert_default());
            let later = rows.split_off(rows.partition_point(|row| row.time <= time));
            let until = std::mem::replace(rows, later);
            if is_first { Vec::new() } else { until.into() }
        };
        self.runner.runs.iter_mut().zip(&frame.runs).map(of_run).collect()
    }

    /// The time series so far, unless they were returned.
    pub(crate) fn take_history(&mut self) -> History {
        self.runner.take_history()
    }

    /// The messages about bodies that have gone through each other, each once.
    pub(crate) fn meetings(&mut self) -> Vec<String> {
        self.runner.runs.iter_mut().filter_map(|running| running.meeting.take()).collect()
    }

    /// The file with states that could not be read, after an error.
    pub(crate) fn unreadable(&self) -> Option<&Path> {
        Some(self.runner.fault()?.0)
    }

    /// The number of frames returned.
    pub(crate) fn taken(&self) -> usize {
        self.taken
    }

    /// Calls `ask` on each helper thread of the runs, which are not in the rayon pool.
    pub(crate) fn ask_helpers(&mut self, ask: &(dyn Fn() + Sync)) {
        self.runner.ask_helpers(ask);
    }
}

impl Waiting {
    fn new(file: Growing) -> Self {
        Self { file, ends: Vec::new(), reached: 0, is_known: false }
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.append(bytes)?;
        self.ends.push(self.ends.last().unwrap_or(&0) + bytes.len() as u64);
        Ok(())
    }

    fn get(&mut self, piece: usize) -> io::Result<Vec<u8>> {
        let (start, end) = (piece.checked_sub(1).map_or(0, |before| self.ends[before]), self.ends[piece]);
        let mut bytes = vec![0; (end - start) as usize];
        self.file.read_at(start, &mut bytes)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_come_back() {
        let mut store = Waiting::new(Growing::new(tempfile::tempfile().unwrap()));
        let piece = |at: usize| vec![at as u8; [300, 30, 9000, 0, 1][at]];
        (0..5).for_each(|at| store.put(&piece(at)).unwrap());
        assert!([4, 0, 2, 3, 1].into_iter().all(|at| store.get(at).unwrap() == piece(at)));
    }

    #[test]
    fn progress_that_cannot_be_is_refused() {
        use crate::sim::{Divergence, Status};
        let scene = crate::runner::tests::read(crate::internals::untrusted::SCENE);
        let begun = || Frames::new(Runner::new(&scene, &[0, 1]), &[2, 4], None);
        let resumed = |step, part, element| {
            let mut progress = begun().progress().unwrap().unwrap();
            let mut state = State::from_bytes(&progress.states[1]).unwrap();
            state.status = Status::Diverged(Divergence { time: 0.0, step, part, element, is_end: false });
            progress.states[1] = state.to_bytes();
            begun().resume(progress).is_ok()
        };
        assert!(resumed(1, 0, None) && resumed(1, 0, Some(0)));
        assert!(!resumed(0, 0, None) && !resumed(1, 1, None) && !resumed(1, 0, Some(1)));
    }
}
