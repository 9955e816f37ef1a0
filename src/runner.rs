//! Advances runs of a scene, in parallel, to requested moments: frames, states of a figure, moments of a time series.
//! All other code simulates through this one, which makes it long: runs, their time series and their stored frames share one state.

pub use crate::history::{History, TimeSeries};
use crate::last_fit::{Fitting, Search, fits};
use crate::look::Traced;
use crate::scene::Scene;
use crate::sim::apart;
use crate::sim::body::Body;
use crate::sim::crew::Crew;
use crate::sim::diagnostics::Diagnostic;
use crate::sim::integrate::Integrator;
use crate::sim::snapshot::{Frame, RunFrame, Status};
use crate::sim::state::State;
use crate::sim::world::{Moment, Stepping, Surroundings, World};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, OnceLock};

/// Simulates runs of a scene and returns frames in rising order.
///
/// It uses the rayon thread pool of the caller; the frames have the same bits for any number of threads.
pub struct Runner<'a> {
    scene: &'a Scene,
    runs: Vec<Running>,
    apart: Option<Apart>,
}

/// The time series of the difference of two runs.
struct Apart {
    /// The places of the runs among those that are simulated.
    runs: [usize; 2],
    after_fit: bool,
    /// Its moments, rising.
    notes: Vec<Moment>,
    /// Times (s) and distances (m).
    course: Vec<[f64; 2]>,
}

/// One run with its world and time series.
struct Running {
    run: usize,
    world: World,
    /// Time step (s).
    step: f64,
    /// Moments of the time series, rising.
    notes: Vec<Moment>,
    /// The diagnostics of the time series.
    wanted: Vec<Diagnostic>,
    /// The points whose paths it has.
    traced: Vec<Traced>,
    body: Arc<Body>,
    series: TimeSeries,
    /// Threads within the run.
    threads: usize,
    /// Whether it is drawn.
    is_drawn: bool,
    /// What pictures show of it from there on if it diverges, known as soon as it is needed.
    last_fit: OnceLock<Option<Fitting>>,
    /// The search for that, while it goes on.
    search: Option<Search>,
}

impl<'a> Runner<'a> {
    /// The given runs of a scene at their start.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn new(scene: &'a Scene, runs: &[usize]) -> Self {
        Self::among(runs.len(), scene, runs)
    }

    /// The same, for `all` runs in total that share the threads.
    pub(crate) fn among(all: usize, scene: &'a Scene, runs: &[usize]) -> Self {
        /// Least number of elements for each additional thread within a run.
        const LEAST: usize = 2000;
        let threads = (rayon::current_num_threads() / all.max(1)).min(scene.body.elements.len() / LEAST).max(1);
        let running = |&run: &usize| {
            let mut world = scene.world(run);
            world.set_crew(Crew::new(threads));
            Running {
                run,
                world,
                step: scene.runs[run].step,
                notes: Vec::new(),
                wanted: Vec::new(),
                traced: Vec::new(),
                body: Arc::clone(&scene.body),
                series: TimeSeries::new(run),
                threads,
                is_drawn: true,
                last_fit: OnceLock::new(),
                search: None,
            }
        };
        Self { scene, runs: runs.iter().map(running).collect(), apart: None }
    }

    /// The same without computing what only pictures need: the field by which the scene is coloured, and the last states
    /// that fit of runs that diverge.
    pub(crate) fn without_pictures(mut self) -> Self {
        for running in &mut self.runs {
            running.world.show(None);
            running.is_drawn = false;
        }
        self
    }

    /// The same with these diagnostics only in its frames.
    pub(crate) fn with_diagnostics(mut self, wanted: &[Diagnostic]) -> Self {
        self.runs.iter_mut().for_each(|running| running.world.want(wanted));
        self
    }

    /// The same, recording time series of some diagnostics of all runs.
    pub(crate) fn with_time_series(self, wanted: &[Diagnostic]) -> Self {
        self.with_closer_time_series(wanted, None, &[])
    }

    /// The same with more moments: the interval `closer` (s), if given, has as many moments as the whole scene usually
    /// has, and the steps nearest to each of `shown` (s) are added.
    pub(crate) fn with_closer_time_series(
        mut self,
        wanted: &[Diagnostic],
        closer: Option<[f64; 2]>,
        shown: &[f64],
    ) -> Self {
        for running in &mut self.runs {
            running.wanted = wanted.to_vec();
            running.traced = self.scene.view.paths.clone();
            running.series.paths = vec![Vec::new(); running.traced.len()];
            running.notes = crate::history::moments(self.scene, &running.world, closer, shown);
        }
        self
    }

    /// The same, recording the difference of the two runs that the scene compares, if both are simulated.
    pub(crate) fn with_difference(mut self) -> Self {
        let place = |run: usize| self.runs.iter().position(|running| running.run == run);
        let places = self.scene.view.difference.map(|difference| (difference, difference.runs.map(place)));
        if let Some((difference, [Some(one), Some(other)])) = places {
            let notes = crate::history::moments(self.scene, &self.runs[one].world, None, &[]);
            let after_fit = difference.after_fit;
            self.apart = Some(Apart { runs: [one, other], after_fit, notes, course: Vec::new() });
        }
        self
    }

    /// Advances each run towards a moment by at most `most_steps`, and returns whether all have reached it. The states
    /// have the same bits however the steps are divided into calls.
    ///
    /// # Panics
    /// If the moment has passed.
    pub fn advance_towards(&mut self, moment: Moment, most_steps: u64) -> bool {
        let mut left = most_steps;
        while let Some(note) = self.next_difference(moment) {
            let before: Vec<_> = self.runs.iter().map(|running| running.world.steps()).collect();
            if !self.advance_runs(note, left) {
                return false;
            }
            let taken = self.runs.iter().zip(before).map(|(running, before)| running.world.steps() - before);
            left -= taken.max().unwrap_or(0).min(left);
            self.note_difference();
        }
        self.advance_runs(moment, left)
    }

    fn advance_runs(&mut self, moment: Moment, most_steps: u64) -> bool {
        let scene = self.scene;
        let arrived = self.runs.par_iter_mut().map(|running| running.advance_towards(scene, moment, most_steps));
        arrived.reduce(|| true, |one, other| one && other)
    }

    /// The next moment of the time series of the difference, if it is not after another one.
    fn next_difference(&self, moment: Moment) -> Option<Moment> {
        let apart = self.apart.as_ref()?;
        let note = apart.notes.get(apart.course.len()).copied()?;
        let are_sound = apart.runs.iter().all(|&at| self.runs[at].world.status() == Status::Ok);
        (are_sound && note.count * moment.rate <= moment.count * note.rate).then_some(note)
    }

    /// Records the difference of the present states, unless a run has just diverged.
    fn note_difference(&mut self) {
        let Some(apart) = &mut self.apart else { return };
        let worlds = apart.runs.map(|at| &self.runs[at].world);
        if worlds.iter().any(|world| world.status() != Status::Ok) {
            return;
        }
        let positions = worlds.map(|world| &world.state().position[..]);
        let distance = apart::largest(self.scene.body.dimension, positions, apart.after_fit);
        let first = &self.runs[apart.runs[0]];
        apart.course.push([first.world.steps() as f64 * first.step, distance]);
    }

    /// Steps taken so far, summed over all runs.
    pub fn steps(&self) -> u64 {
        self.runs.iter().fold(0, |sum, running| sum.saturating_add(running.world.steps()))
    }

    /// Steps that all runs together have taken at a moment.
    pub(crate) fn steps_at(&self, moment: Moment) -> u64 {
        self.runs.iter().fold(0, |sum, running| sum.saturating_add(running.world.steps_at(moment)))
    }

    /// The runs at the last moment that all have reached.
    pub fn snapshots(&self) -> Vec<RunFrame> {
        self.runs.par_iter().map(|running| running.frame(self.scene)).collect()
    }

    /// Advances to a frame and returns it.
    ///
    /// # Panics
    /// If the frame is before the last moment that was reached.
    pub fn frame(&mut self, index: u64) -> Frame {
        self.advance_towards(self.scene.moment(index), u64::MAX);
        self.taken(index)
    }

    /// The present states as a frame.
    fn taken(&self, index: u64) -> Frame {
        let runs = self.snapshots();
        let time = runs.first().map_or_else(|| self.scene.frame_time(index), |run| run.snapshot.time);
        Frame { index, time, runs }
    }

    /// Calls `ask` on each helper thread of the runs.
    pub(crate) fn ask_helpers(&mut self, ask: &(dyn Fn() + Sync)) {
        for running in &mut self.runs {
            running.world.crew().run(&|number| {
                if number > 0 {
                    ask();
                }
            });
        }
    }

    /// The time series recorded so far. From then on nothing is.
    pub(crate) fn take_history(&mut self) -> History {
        let take = |running: &mut Running| {
            running.notes.clear();
            let run = running.series.run;
            std::mem::replace(&mut running.series, TimeSeries::new(run))
        };
        let series = self.runs.iter_mut().map(take).collect();
        let difference = self.apart.take().map_or_else(Vec::new, |apart| apart.course);
        History { end: self.scene.frame_time(self.scene.last_frame()), series, difference }
    }
}

impl Running {
    /// The present state, and what pictures show instead if it has diverged.
    fn frame(&self, scene: &Scene) -> RunFrame {
        let Self { run, world, threads, is_drawn, last_fit, .. } = self;
        let frame = RunFrame::new(*run, world.snapshot());
        if !is_drawn || self.shows_itself(scene) {
            return frame;
        }
        let search = || Search::new(scene, *run, *threads).advance(scene, u64::MAX).flatten();
        let found = last_fit.get_or_init(search);
        let shown = found.as_ref().map(|found| &found.shown).filter(|shown| shown.snapshot.step < frame.snapshot.step);
        RunFrame { last_fit: shown.cloned().map(Box::new), ..frame }
    }

    /// Whether pictures show its present state.
    fn shows_itself(&self, scene: &Scene) -> bool {
        self.world.status() == Status::Ok && fits(scene, &self.world.state().position)
    }

    /// Looks for what pictures show instead, through about so many steps; returns whether it is known or not needed.
    fn find_last_fit(&mut self, scene: &Scene, most_steps: u64) -> bool {
        if !self.is_drawn || self.last_fit.get().is_some() || self.shows_itself(scene) {
            return true;
        }
        let search = self.search.get_or_insert_with(|| Search::new(scene, self.run, self.threads));
        let Some(found) = search.advance(scene, most_steps) else { return false };
        self.search = None;
        self.last_fit = found.into();
        true
    }

    fn advance_towards(&mut self, scene: &Scene, moment: Moment, most_steps: u64) -> bool {
        let (target, mut left) = (self.world.steps_at(moment), most_steps);
        while let (Some(&note), None) = (self.notes.get(self.series.times.len()), self.series.divergence) {
            if self.world.steps_at(note) > target {
                break;
            }
            let before = self.world.steps();
            let is_there = self.world.advance_towards(note, left);
            if let Status::Diverged(divergence) = self.world.status() {
                // The last finite state is that before the rejected step.
                let (last, noted) = (divergence.step - 1, self.series.times.len());
                if noted == 0 || last > self.world.steps_at(self.notes[noted - 1]) {
                    self.note(scene, last);
                }
                self.series.divergence = Some(divergence);
            } else if is_there {
                left -= self.world.steps() - before;
                self.note(scene, self.world.steps());
            } else {
                return false;
            }
        }
        self.world.advance_towards(moment, left)
    }

    /// Records the present state as that after a step.
    fn note(&mut self, scene: &Scene, step: u64) {
        let diagnostics = self.world.some_diagnostics(&self.wanted);
        let position = &self.world.state().position;
        self.series.note(scene, step as f64 * self.step, diagnostics, position);
        for (traced, path) in self.traced.iter().zip(&mut self.series.paths) {
            path.push(traced.of(&self.body, position));
        }
    }
}

/// Frames of a scene in rising order, simulated once, also if the time series of the whole scene have to be known
/// before the first frame is drawn, or not at all if their states are stored.
pub(crate) struct Frames<'a> {
    runner: Runner<'a>,
    frames: Vec<u64>,
    /// Number of frames returned, or that need not be.
    taken: usize,
    /// Whether the runs have the states of the next frame.
    is_set: bool,
    /// Steps that each run had taken in an earlier process.
    before: Vec<u64>,
    source: Source<'a>,
}

/// How far a simulation has come, with all that it needs to go on with the same bits.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Progress {
    /// The present state of each run, as bytes.
    states: Vec<Vec<u8>>,
    /// The time series so far.
    history: History,
    /// What [`Frames::last_fit`] returns of each run, with states as bytes.
    last_fits: Vec<Option<StoredFit>>,
    /// Number of frames returned.
    pub(crate) taken: usize,
    /// If states wait until the end of the simulation, where each of those that do so ends in their file.
    waiting: Option<Vec<u64>>,
}

/// A last state that fits, as bytes, and how many times wider the body is at the end; `None` if a run does not diverge.
type StoredFit = Option<(Vec<u8>, f64)>;

impl Progress {
    /// Length of the file with waiting states (bytes).
    pub(crate) fn waiting_length(&self) -> u64 {
        self.waiting.as_ref().and_then(|ends| ends.last()).copied().unwrap_or(0)
    }
}

/// Where the states of frames come from.
enum Source<'a> {
    /// From the simulation, one after the other.
    Simulated,
    /// From the simulation, after all of it: they wait until the time series are known.
    Waiting(Waiting),
    /// From an earlier simulation, with its time series until they are returned.
    Stored(Box<dyn Stored + 'a>, Option<History>),
}

/// What an earlier simulation of the same runs of the same scene has stored.
pub(crate) trait Stored: Send {
    /// The state of the run at this place among the runs, in a frame, which it reaches after so many steps.
    ///
    /// # Errors
    /// If it cannot be read.
    fn state(&mut self, place: usize, frame: u64, steps: u64) -> io::Result<State>;

    /// Takes the time series, if there are any.
    fn take_history(&mut self) -> Option<History>;

    /// What [`Frames::last_fit`] returned of a run.
    fn last_fit(&self, place: usize) -> Option<Option<(State, f64)>>;
}

/// The states of frames, stored until they are drawn.
struct Waiting {
    states: Store,
    /// Number of frames reached by the simulation.
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
    /// There are no more.
    Done,
}

impl<'a> Frames<'a> {
    /// Frames of a runner at its start, in rising order. With a file for `waiting` states the runner has to record time
    /// series, and everything is simulated before the first frame is returned.
    pub(crate) fn new(runner: Runner<'a>, frames: &[u64], waiting: Option<File>) -> Self {
        let source = match waiting {
            Some(file) => Source::Waiting(Waiting { states: Store::new(file), reached: 0, is_known: false }),
            None => Source::Simulated,
        };
        let before = vec![0; runner.runs.len()];
        Self { runner, frames: frames.to_vec(), taken: 0, is_set: false, before, source }
    }

    /// Where the simulation has come to; `None` if there is nothing left to simulate. Waiting states are on the disk then.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(crate) fn progress(&mut self) -> io::Result<Option<Progress>> {
        let Self { runner, frames, taken, source, .. } = self;
        let waiting = match source {
            Source::Simulated if *taken < frames.len() => None,
            Source::Waiting(Waiting { states, is_known: false, .. }) => {
                states.file.sync_data()?;
                Some(states.ends.clone())
            }
            _ => return Ok(None),
        };
        let states = runner.runs.iter_mut().map(|running| {
            running.world.settle();
            running.world.state().to_bytes()
        });
        let states = states.collect();
        let series = runner.runs.iter().map(|running| running.series.clone()).collect();
        let difference = runner.apart.as_ref().map_or_else(Vec::new, |apart| apart.course.clone());
        let history = History { end: 0.0, series, difference };
        let (taken, runs) = (*taken, 0..runner.runs.len());
        let last_fit = |place| Some(self.last_fit(place)?.map(|(state, wider)| (state.to_bytes(), wider)));
        let last_fits = runs.map(last_fit).collect();
        Ok(Some(Progress { states, history, last_fits, taken, waiting }))
    }

    /// Goes on where another process has come to with the same runs and frames, before the first call of [`Self::next`].
    ///
    /// # Errors
    /// If it was not with these.
    pub(crate) fn resume(&mut self, progress: Progress) -> io::Result<()> {
        let Self { runner, frames, taken, before, source, .. } = self;
        let Progress { states, history, last_fits, taken: returned, waiting } = progress;
        let runs = runner.runs.len();
        let reached = match (source, waiting) {
            (Source::Simulated, None) => Some(returned),
            (Source::Waiting(to_fill), Some(ends)) if returned == 0 && ends.is_sorted() => {
                (to_fill.reached, to_fill.states.ends) = (ends.len() / runs.max(1), ends);
                Some(to_fill.reached)
            }
            _ => None,
        };
        let reached = reached.filter(|&reached| reached <= frames.len()).ok_or(io::ErrorKind::InvalidData)?;
        let end = runner.scene.last_frame();
        // Neither the next frame nor the next moment of a time series may have passed.
        let next = runner.scene.moment(frames.get(reached).copied().unwrap_or(end));
        let fit = [states.len(), history.series.len(), last_fits.len()] == [runs; 3];
        if !fit || !history.series.iter().zip(&runner.runs).all(|(series, running)| series.fits(&running.series)) {
            return Err(io::ErrorKind::InvalidData.into());
        }
        let found = runner.runs.iter_mut().zip(states).zip(history.series).zip(last_fits);
        for (((running, state), series), last_fit) in found {
            let state = State::from_bytes(&state).filter(|state| running.world.takes(state));
            running.world.set_state(state.ok_or(io::ErrorKind::InvalidData)?);
            running.series = series;
            if let Some(found) = last_fit {
                let read = |(bytes, wider): (Vec<u8>, f64)| {
                    let state = State::from_bytes(&bytes).filter(|state| running.world.takes(state));
                    Ok::<_, io::Error>((state.ok_or(io::ErrorKind::InvalidData)?, wider))
                };
                let found = found.map(read).transpose()?;
                let present = running.world.state().clone();
                let found = found.map(|(state, wider)| Fitting::new(&mut running.world, state, wider));
                running.world.set_state(present);
                running.last_fit = found.into();
            }
            let note = running.notes.get(running.series.times.len()).filter(|_| running.series.divergence.is_none());
            let first = note.map_or(u64::MAX, |&note| running.world.steps_at(note)).min(running.world.steps_at(next));
            if running.world.steps() > first {
                return Err(io::ErrorKind::InvalidData.into());
            }
        }
        if let Some(apart) = &mut runner.apart {
            apart.course = history.difference;
            let note = apart.notes.get(apart.course.len());
            let is_late =
                |running: &Running| note.is_some_and(|&note| running.world.steps() > running.world.steps_at(note));
            if apart.runs.iter().any(|&at| runner.runs[at].world.status() == Status::Ok && is_late(&runner.runs[at])) {
                return Err(io::ErrorKind::InvalidData.into());
            }
        }
        *taken = returned;
        *before = runner.runs.iter().map(|running| running.world.steps()).collect();
        Ok(())
    }

    /// Frames of a runner, in rising order, that an earlier simulation has stored.
    ///
    /// # Errors
    /// If what is stored does not belong to these runs.
    pub(crate) fn stored(mut runner: Runner<'a>, frames: &[u64], mut stored: impl Stored + 'a) -> io::Result<Self> {
        for (place, running) in runner.runs.iter_mut().enumerate() {
            let Some(found) = stored.last_fit(place) else { continue };
            if found.as_ref().is_some_and(|(state, _)| !running.world.takes(state)) {
                return Err(io::ErrorKind::InvalidData.into());
            }
            let found = found.map(|(state, times_wider)| Fitting::new(&mut running.world, state, times_wider));
            running.last_fit = found.into();
        }
        let history = stored.take_history();
        let source = Source::Stored(Box::new(stored), history);
        Ok(Self { source, ..Self::new(runner, frames, None) })
    }

    /// Advances each run by at most `most_steps`.
    ///
    /// # Errors
    /// If stored states cannot be written or read.
    pub(crate) fn next(&mut self, most_steps: u64) -> io::Result<Next> {
        let Self { runner, frames, taken, is_set, source, .. } = self;
        if let Source::Stored(_, history) = source
            && let Some(history) = history.take()
        {
            return Ok(Next::TimeSeries(history));
        }
        if let Source::Waiting(waiting) = source
            && !waiting.is_known
        {
            let frame = frames.get(waiting.reached).copied();
            let moment = runner.scene.moment(frame.unwrap_or(runner.scene.last_frame()));
            if !runner.advance_towards(moment, most_steps) {
                return Ok(Next::Working);
            }
            if frame.is_some() {
                runner.runs.iter().try_for_each(|running| waiting.states.put(&running.world.state().to_bytes()))?;
                waiting.reached += 1;
                return Ok(Next::Working);
            }
            waiting.is_known = true;
            return Ok(Next::TimeSeries(runner.take_history()));
        }
        let Some(&frame) = frames.get(*taken) else { return Ok(Next::Done) };
        let moment = runner.scene.moment(frame);
        if matches!(source, Source::Simulated) && !runner.advance_towards(moment, most_steps) {
            return Ok(Next::Working);
        }
        let (first, scene) = (*taken * runner.runs.len(), runner.scene);
        for (place, running) in runner.runs.iter_mut().enumerate().filter(|_| !*is_set) {
            let state = match source {
                Source::Simulated => continue,
                Source::Waiting(waiting) => State::from_bytes(&waiting.states.get(first + place)?),
                Source::Stored(stored, _) => Some(stored.state(place, frame, running.world.steps_at(moment))?),
            };
            let state = state.filter(|state| running.world.takes(state));
            running.world.set_state(state.ok_or(io::ErrorKind::InvalidData)?);
        }
        let found = runner.runs.par_iter_mut().map(|running| running.find_last_fit(scene, most_steps));
        *is_set = !found.reduce(|| true, |one, other| one && other);
        if *is_set {
            return Ok(Next::Working);
        }
        *taken += 1;
        Ok(Next::Frame(runner.taken(frame)))
    }

    /// Steps taken so far, and steps at the end, of all runs together.
    pub(crate) fn steps(&self) -> [u64; 2] {
        let scene = self.runner.scene;
        let last = match self.source {
            Source::Stored(..) => return [0; 2],
            Source::Waiting(_) => scene.last_frame(),
            Source::Simulated => self.frames.last().copied().unwrap_or(0),
        };
        [self.reached().into_iter().fold(0, u64::saturating_add), self.runner.steps_at(scene.moment(last))]
    }

    /// The time that all runs have reached, and that of the last frame (s); `None` if nothing is left to simulate.
    pub(crate) fn on_the_way(&self) -> Option<[f64; 2]> {
        let end = match &self.source {
            Source::Simulated => *self.frames.get(self.taken..)?.last()?,
            Source::Waiting(waiting) if !waiting.is_known => self.runner.scene.last_frame(),
            _ => return None,
        };
        let times = self.runner.runs.iter().map(|running| running.world.steps() as f64 * running.step);
        Some([times.fold(f64::INFINITY, f64::min), self.runner.scene.frame_time(end)])
    }

    /// Steps that each run has taken so far in this process.
    pub(crate) fn simulated(&self) -> Vec<u64> {
        self.reached().into_iter().zip(&self.before).map(|(steps, before)| steps - before).collect()
    }

    /// Steps that each run has taken so far.
    fn reached(&self) -> Vec<u64> {
        let end = self.runner.scene.moment(self.runner.scene.last_frame());
        let steps = |running: &Running| match &self.source {
            Source::Stored(..) => 0,
            // Runs that have gone all the way are then set back to each frame.
            Source::Waiting(waiting) if waiting.is_known => running.world.steps_at(end),
            _ => running.world.steps(),
        };
        self.runner.runs.iter().map(steps).collect()
    }

    /// The states of all runs in the last frame that was returned; before the first, those at the start.
    pub(crate) fn states(&self) -> impl Iterator<Item = &State> {
        self.runner.runs.iter().map(|running| running.world.state())
    }

    /// What pictures of the frames returned so far show of a run that diverges, if they show anything but its states: the
    /// last state that fits, and how many times wider the body is at the end. `None` inside if it does not diverge.
    pub(crate) fn last_fit(&self, place: usize) -> Option<Option<(&State, f64)>> {
        let found = self.runner.runs[place].last_fit.get()?;
        Some(found.as_ref().map(|found| (&found.state, found.shown.times_wider)))
    }

    /// The time series recorded so far, if they were not returned.
    pub(crate) fn take_history(&mut self) -> History {
        self.runner.take_history()
    }

    /// Number of frames returned.
    pub(crate) fn taken(&self) -> usize {
        self.taken
    }

    /// Calls `ask` on each helper thread of the runs; these do not belong to the rayon pool.
    pub(crate) fn ask_helpers(&mut self, ask: &(dyn Fn() + Sync)) {
        self.runner.ask_helpers(ask);
    }
}

/// Blocks of bytes in a file.
struct Store {
    file: File,
    /// Where each block ends.
    ends: Vec<u64>,
}

impl Store {
    fn new(file: File) -> Self {
        Self { file, ends: Vec::new() }
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        let end = self.file.seek(SeekFrom::End(0))?;
        self.file.write_all(bytes)?;
        self.ends.push(end + bytes.len() as u64);
        Ok(())
    }

    fn get(&mut self, piece: usize) -> io::Result<Vec<u8>> {
        let (start, end) = (piece.checked_sub(1).map_or(0, |before| self.ends[before]), self.ends[piece]);
        let mut bytes = vec![0; (end - start) as usize];
        self.file.seek(SeekFrom::Start(start))?;
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

impl Scene {
    /// The world of one run, at its start.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn world(&self, run: usize) -> World {
        let run = &self.runs[run];
        let surroundings =
            Surroundings { gravity: self.gravity, obstacles: self.obstacles.clone(), grips: self.grips.clone() };
        let tolerance = run.tolerance.unwrap_or(Integrator::TOLERANCE);
        let stepping = Stepping { integrator: run.integrator, step: run.step, tolerance, kernel: run.kernel };
        let mut world = World::new(&self.body, self.initial.clone(), run.model.as_ref(), surroundings, stepping);
        world.show(self.view.colour.map(|scale| scale.field));
        world
    }
}

impl History {
    /// Simulates runs of a scene from start to end: what charts and cameras that follow need, see [`Composer::set_history`].
    ///
    /// [`Composer::set_history`]: crate::picture::Composer::set_history
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn new(scene: &Scene, runs: &[usize]) -> Self {
        let mut runner =
            Runner::new(scene, runs).without_pictures().with_time_series(Diagnostic::ALL).with_difference();
        runner.advance_towards(scene.moment(scene.last_frame()), u64::MAX);
        runner.take_history()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Limits;

    /// Two runs with different time steps.
    const SCENE: &str = "
        gravity = [0, -9.8, 0]
        time = { duration = 0.1, frames_per_second = 20 }
        body.lattice = { cells = [2, 1, 1], side = 0.1 }
        body.velocity = [0, -2, 0]
        obstacle = [{ kind = 'floor', restitution = 0.5 }]
        [[run]]
        name = 'shape'
        model = { kind = 'shape-based', stiffness = 1e4 }
        [[run]]
        name = 'springs'
        model = { kind = 'mass-spring', stiffness = 1e4 }
        step = 'T/70'
    ";

    #[test]
    fn the_way_to_a_frame_may_be_cut_up() {
        let scene = Scene::parse(SCENE, "small.toml", &Limits::default()).unwrap();
        let mut whole = Runner::new(&scene, &[0, 1]);
        let whole: Vec<Frame> = (0..=2).map(|index| whole.frame(index)).collect();
        for slice in [1, 3, 1000] {
            let mut runner = Runner::new(&scene, &[0, 1]);
            for frame in &whole {
                let (moment, mut slices) = (scene.moment(frame.index), 1);
                while !runner.advance_towards(moment, slice) {
                    slices += 1;
                }
                assert_eq!(runner.steps(), runner.steps_at(moment));
                let last = if frame.index > 0 { whole[frame.index as usize - 1].runs[1].snapshot.step } else { 0 };
                assert_eq!(slices, (frame.runs[1].snapshot.step - last).div_ceil(slice).max(1));
                // A run without rotations has no residual. NaN is not equal to itself, so texts are compared.
                assert_eq!(format!("{:?}", runner.frame(frame.index)), format!("{frame:?}"));
            }
        }
    }

    #[test]
    fn frames_that_wait_for_the_time_series_are_the_same() {
        let scene = Scene::parse(SCENE, "small.toml", &Limits::default()).unwrap();
        let take = |whole_series: bool, slice: u64| {
            let runner = Runner::new(&scene, &[0, 1]).with_time_series(Diagnostic::ALL);
            let waiting = whole_series.then(|| tempfile::tempfile().unwrap());
            let mut frames = Frames::new(runner, &[0, 2], waiting);
            let (mut taken, mut series) = (Vec::new(), None);
            loop {
                let [done, all] = frames.steps();
                assert!(done <= all);
                match frames.next(slice).expect("a file") {
                    Next::Working => {}
                    Next::TimeSeries(history) => {
                        assert!(taken.is_empty());
                        series = Some(history);
                    }
                    Next::Frame(frame) => taken.push(format!("{frame:?}")),
                    Next::Done => break,
                }
            }
            assert_eq!(frames.steps()[0], frames.steps()[1]);
            (taken, series)
        };
        let (streamed, none) = take(false, 1000);
        assert!(none.is_none() && streamed.len() == 2);
        for slice in [3, 1000] {
            let (waited, series) = take(true, slice);
            assert_eq!(waited, streamed);
            assert_eq!(format!("{:?}", series.unwrap()), format!("{:?}", History::new(&scene, &[0, 1])));
        }
    }

    /// Processor time is measured on each helper thread, too.
    #[test]
    fn each_thread_that_was_lent_is_asked() {
        let large = SCENE.replace("[2, 1, 1]", "[20, 20, 20]");
        for (text, threads) in [(SCENE, [0, 0]), (&large, [1, 3])] {
            let scene = Scene::parse(text, "large.toml", &Limits::default()).unwrap();
            for (runs, helpers) in [(&[0, 1][..], 2 * threads[0]), (&[0], threads[1])] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
                let asked = std::sync::Mutex::new(std::collections::HashSet::new());
                pool.install(|| {
                    let ask = || {
                        asked.lock().unwrap().insert(std::thread::current().id());
                    };
                    Runner::new(&scene, runs).ask_helpers(&ask);
                });
                assert_eq!(asked.into_inner().unwrap().len(), helpers);
            }
        }
    }

    #[test]
    fn pieces_come_back() {
        let mut store = Store::new(tempfile::tempfile().unwrap());
        let piece = |at: usize| vec![at as u8; [300, 30, 9000, 0, 1][at]];
        (0..5).for_each(|at| store.put(&piece(at)).unwrap());
        assert!([4, 0, 2, 3, 1].into_iter().all(|at| store.get(at).unwrap() == piece(at)));
    }
}
