//! Advances runs of a scene, in parallel, to requested moments: frames, states of a figure, moments of a time series.
//! All other code simulates through this module.

pub(crate) mod cause;
mod frame;
mod frames;
pub(crate) mod growing;
pub(crate) mod history;
mod last_fit;
mod meetings;
pub(crate) mod moments;
mod stored;

use crate::look::Plot;
use crate::scene::measure::Meter;
use crate::scene::{Recorded, Run, Scene};
use crate::sim::{Crew, Diagnostic, Diagnostics, Moment, State, Status, World};
pub use frame::{Frame, RunFrame};
pub(crate) use frames::{Frames, Next, Progress};
pub(crate) use history::TableRow;
pub use history::{History, TimeSeries};
use last_fit::{Fitting, Search, fits};
use meetings::Watch;
pub(crate) use meetings::crossing;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::io;
use std::path::Path;
use std::sync::{Arc, OnceLock};
pub(crate) use stored::Stored;

/// Simulates runs of a scene and returns frames in rising order.
///
/// It uses the rayon thread pool of the caller; the frames have the same bits for any number of threads.
pub struct Runner<'a> {
    scene: &'a Scene,
    runs: Vec<Running<'a>>,
}

/// One run with its world and time series.
struct Running<'a> {
    scene: &'a Scene,
    /// Index of the run in the scene, and the run.
    run: usize,
    of: &'a Run,
    world: World,
    /// Moments of the time series, rising.
    notes: Vec<Moment>,
    /// The diagnostics of the time series.
    wanted: Vec<Diagnostic>,
    /// What other charts show.
    meters: Vec<Meter<'a>>,
    series: TimeSeries,
    /// Its rows between frames, until they are taken; `None` if none are wanted.
    rows: Option<VecDeque<TableRow>>,
    /// The threads within the run.
    threads: usize,
    /// Whether the run is drawn.
    is_drawn: bool,
    /// The recording whose states it shows.
    recording: Option<Arc<Recorded>>,
    /// The drawn state after a divergence, found as soon as it is needed.
    last_fit: OnceLock<Option<Fitting>>,
    /// The search for that state, while it runs.
    search: Option<Search>,
    /// Watches its bodies, until two of them go through each other.
    watch: Option<Watch>,
    /// The message about these, until it is taken.
    meeting: Option<String>,
}

impl<'a> Runner<'a> {
    /// The given runs of a scene at their start.
    ///
    /// # Panics
    /// The scene has no such run.
    pub fn new(scene: &'a Scene, runs: &[usize]) -> Self {
        Self::among(runs.len(), scene, runs)
    }

    /// The given runs of a scene at their start, of whose course is kept what pictures show: charts, paths, cameras that follow. See
    /// [`Self::take_history`].
    ///
    /// # Panics
    /// The scene has no such run.
    pub fn for_pictures(scene: &'a Scene, runs: &[usize]) -> Self {
        Self::new(scene, runs).with_time_series(scene.time_series())
    }

    /// A runner for some of `all` runs that share the threads.
    pub(crate) fn among(all: usize, scene: &'a Scene, runs: &[usize]) -> Self {
        let running = |&run: &usize| {
            let of = &scene.runs[run];
            let threads = of.threads(all);
            let mut world = scene.world(run);
            world.set_crew(Crew::new(threads));
            let running = Running {
                scene,
                run,
                of,
                world,
                notes: Vec::new(),
                wanted: Vec::new(),
                meters: Vec::new(),
                series: TimeSeries { run, ..TimeSeries::default() },
                rows: None,
                threads,
                is_drawn: true,
                recording: None,
                last_fit: OnceLock::new(),
                search: None,
                watch: None,
                meeting: None,
            };
            match &of.recording {
                Some(recording) => running.showing(recording),
                None => running,
            }
        };
        Self { scene, runs: runs.iter().map(running).collect() }
    }

    /// Shows the recordings of its runs from now on, in place of steps; `None` if they are those of other bodies or models.
    fn playing(mut self, recordings: &[Arc<Recorded>]) -> Option<Self> {
        let play = |(running, recording): (Running<'a>, &Arc<Recorded>)| {
            let State { position, memory, .. } = running.world.state();
            let memory = memory.shown().count();
            if (recording.nodes, recording.memory) != (position.len(), Some(memory)) {
                return None;
            }
            let world = running.world.playing(Box::new(recording.player(running.of.step)));
            Some(Running { world, ..running }.showing(recording))
        };
        self.runs = self.runs.into_iter().zip(recordings).map(play).collect::<Option<_>>()?;
        Some(self)
    }

    /// Fails if the states shown could not be read.
    fn check(&self) -> io::Result<()> {
        self.fault().map_or(Ok(()), |(_, what)| Err(io::Error::new(io::ErrorKind::InvalidData, what)))
    }

    /// The file with a recording of which a row could not be read, and why. The states shown are then wrong.
    fn fault(&self) -> Option<(&Path, String)> {
        let recordings = self.runs.iter().filter_map(|running| running.recording.as_ref());
        recordings.filter_map(|recording| Some((&*recording.path, recording.fault()?))).next()
    }

    /// Leaves out computations for pictures: the field that colours the scene, and the last fitting states of runs that
    /// diverge.
    pub(crate) fn without_pictures(mut self) -> Self {
        for running in &mut self.runs {
            running.world.show(None);
            running.is_drawn = false;
        }
        self
    }

    /// Watches bodies that go through each other, which [`Frames::meetings`] tells.
    pub(crate) fn watching(mut self) -> Self {
        self.runs.iter_mut().for_each(|running| running.watch = Watch::new(self.scene, running.run, &running.world));
        self
    }

    /// Computes only these diagnostics in frames.
    pub(crate) fn with_diagnostics(mut self, wanted: &[Diagnostic]) -> Self {
        self.runs.iter_mut().for_each(|running| running.world.want(wanted));
        self
    }

    /// Keeps what some charts tell of contact, if they do, beside what the charts of the scene tell.
    pub(crate) fn keeping_contact(mut self, plots: &[Plot]) -> Self {
        let scene = self.scene;
        if plots.iter().any(Plot::is_of_forces) {
            self.runs.iter_mut().for_each(|running| scene.keep_contact(running.run, &mut running.world));
        }
        self
    }

    /// Records time series for some charts of all runs, if any are wanted.
    pub(crate) fn with_time_series<'w>(self, plots: impl Into<Option<&'w [Plot]>>) -> Self {
        match plots.into() {
            Some(plots) => self.with_closer_time_series(plots, None, &[]),
            None => self,
        }
    }

    /// Records more moments: the interval `closer` (s), if given, has as many moments as the whole scene usually has,
    /// and the steps nearest to each of `shown` (s) are added.
    pub(crate) fn with_closer_time_series(mut self, plots: &[Plot], closer: Option<[f64; 2]>, shown: &[f64]) -> Self {
        let (scene, of) = (self.scene, plots.iter().filter_map(Plot::of));
        let wanted: Vec<_> = plots.iter().filter_map(Plot::diagnostic).collect();
        for running in &mut self.runs {
            running.wanted = wanted.clone();
            running.meters = of.clone().map(|of| Meter::new(scene, running.of, of)).collect();
            running.series.readings = vec![Vec::new(); running.meters.len()];
            running.series.paths = vec![Vec::new(); scene.view.paths.len()];
            let bodies = running.of.of.len();
            running.series.of_bodies = vec![Vec::new(); if bodies > 1 && !wanted.is_empty() { bodies } else { 0 }];
            running.notes = history::moments(scene, &running.world, closer, shown);
        }
        self
    }

    /// Records the rows of `diagnostics.csv` between frames, if the scene asks for them; see [`Self::take_rows`].
    pub fn with_rows(mut self) -> Self {
        let is_asked = self.scene.every.is_some();
        self.runs.iter_mut().for_each(|running| running.rows = is_asked.then(VecDeque::new));
        self
    }

    /// Advances each run towards a moment by at most `most_steps`, and returns whether all have reached it. The states
    /// have the same bits however the steps are divided into calls.
    ///
    /// # Panics
    /// The moment has passed.
    pub fn advance_towards(&mut self, moment: Moment, most_steps: u64) -> bool {
        let arrived = self.runs.par_iter_mut().map(|running| running.advance_towards(moment, most_steps));
        arrived.reduce(|| true, |one, other| one && other)
    }

    /// The steps taken so far, summed over all runs.
    pub fn steps(&self) -> u64 {
        self.runs.iter().fold(0, |sum, running| sum.saturating_add(running.world.steps()))
    }

    /// The steps of all runs together at a moment.
    pub(crate) fn steps_at(&self, moment: Moment) -> u64 {
        self.runs.iter().fold(0, |sum, running| sum.saturating_add(running.world.steps_at(moment)))
    }

    /// The states of the runs at the last moment that all have reached.
    pub fn snapshots(&self) -> Vec<RunFrame> {
        let mut runs: Vec<_> = self.runs.par_iter().map(Running::frame).collect();
        let to = self.scene.view.colour.and_then(|scale| scale.to).filter(|_| self.runs.iter().any(|run| run.is_drawn));
        if let Some(other) = to.and_then(|to| runs.iter().find(|run| run.run == to).cloned()) {
            runs.iter_mut().for_each(|run| run.measure(&other));
        }
        runs
    }

    /// Advances to a frame and returns it.
    ///
    /// # Panics
    /// The frame is before the last moment that was reached.
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

    /// Takes the rows of each run so far, those at frames, too: time (s), and diagnostics of all bodies together and of each of several.
    pub fn take_rows(&mut self) -> Vec<Vec<(f64, Diagnostics, Vec<Diagnostics>)>> {
        let row = |TableRow { time, all, of_bodies, .. }| (time, all, of_bodies);
        let taken = |running: &mut Running| running.rows.iter_mut().flat_map(std::mem::take).map(row).collect();
        self.runs.iter_mut().map(taken).collect()
    }

    /// What was kept of the course so far. No more is kept.
    pub fn take_history(&mut self) -> History {
        let take = |running: &mut Running| {
            running.notes.clear();
            let empty = TimeSeries { run: running.run, ..TimeSeries::default() };
            std::mem::replace(&mut running.series, empty)
        };
        let series = self.runs.iter_mut().map(take).collect();
        History { end: self.scene.frame_time(self.scene.last_frame()), series }
    }
}

impl Running<'_> {
    /// The present state, and the drawn one if the run has diverged.
    fn frame(&self) -> RunFrame {
        let Self { scene, run, world, threads, is_drawn, last_fit, .. } = self;
        let frame = RunFrame::new(*run, world.snapshot());
        if !is_drawn || self.shows_itself() {
            return frame;
        }
        let search = || Search::new(scene, *run, *threads).advance(scene, u64::MAX).flatten();
        let found = last_fit.get_or_init(search);
        let shown = found.as_ref().map(|found| &found.shown).filter(|shown| shown.step < frame.snapshot.step);
        RunFrame { last_fit: shown.cloned().map(Box::new), ..frame }
    }

    /// Whether pictures show the present state.
    fn shows_itself(&self) -> bool {
        self.world.status() == Status::Ok && fits(self.of, &self.world.state().position)
    }

    /// Shows a recording of its world, with the recorded end; nothing is searched for.
    fn showing(mut self, recording: &Arc<Recorded>) -> Self {
        let Self { world, .. } = &mut self;
        let mut last_fit = None;
        if let Some(state) = &recording.last_fit {
            let mut state = state.clone();
            if recording.memory.is_none() {
                // Nothing of its model is known here.
                state.memory = world.state().memory.clone();
                if let Status::Diverged(divergence) = &mut state.status {
                    (divergence.part, divergence.element) = (0, None);
                }
            }
            last_fit = world.takes(&state).then(|| Fitting::new(world, state));
        }
        Self { recording: Some(Arc::clone(recording)), last_fit: last_fit.into(), ..self }
    }

    /// Searches for the drawn state through about this many steps. Returns whether it is known or not needed.
    fn find_last_fit(&mut self, most_steps: u64) -> bool {
        if !self.is_drawn || self.last_fit.get().is_some() || self.shows_itself() {
            return true;
        }
        let search = self.search.get_or_insert_with(|| Search::new(self.scene, self.run, self.threads));
        let Some(found) = search.advance(self.scene, most_steps) else { return false };
        self.search = None;
        self.last_fit = found.into();
        true
    }

    fn advance_towards(&mut self, moment: Moment, most_steps: u64) -> bool {
        // Recorded states take no steps.
        let most_steps = if self.recording.is_some() { u64::MAX } else { most_steps };
        let (target, mut left) = (self.world.steps_at(moment), most_steps);
        while let Some(next) = self.next_note().filter(|next| self.world.steps_at(*next) <= target) {
            let before = self.world.steps();
            let is_there = self.walk(next, left);
            if let Status::Diverged(divergence) = self.world.status() {
                // The last finite state is that before the rejected step.
                let (last, noted) = (divergence.step - 1, self.series.times.len());
                if !self.notes.is_empty() && (noted == 0 || last > self.world.steps_at(self.notes[noted - 1])) {
                    let diagnostics = self.world.diagnostics_by_body(&self.wanted);
                    self.note(last, diagnostics);
                }
                self.series.divergence = Some(divergence);
            } else if is_there {
                left -= self.world.steps() - before;
                self.note_all(before);
            } else {
                return false;
            }
        }
        self.walk(moment, left)
    }

    /// The moment of the next note or row; `None` after a divergence.
    fn next_note(&self) -> Option<Moment> {
        let note = self.notes.get(self.series.times.len()).copied();
        let row = self.rows.as_ref().and_then(|_| self.scene.next_row(self.run, self.world.steps()));
        let next = note.into_iter().chain(row).min_by_key(|&next| self.world.steps_at(next));
        next.filter(|_| self.series.divergence.is_none())
    }

    /// Records the present state for pictures, as a row, or both. The steps `before` were recorded.
    fn note_all(&mut self, before: u64) {
        let Self { scene, run, of, world, notes, rows, wanted, series, .. } = self;
        let steps = world.steps();
        let is_now = |moment: Option<Moment>| moment.is_some_and(|moment| world.steps_at(moment) == steps);
        let row = rows.as_mut().filter(|_| steps > before && is_now(scene.next_row(*run, before)));
        let is_noted = is_now(notes.get(series.times.len()).copied());
        let (all, of_bodies) = world.diagnostics_by_body(if row.is_some() { Diagnostic::ALL } else { wanted });
        if let Some(rows) = row {
            let time = steps as f64 * of.step;
            let reactions = world.reactions().unwrap_or_default();
            let displaced = scene.all_displaced(of, &world.state().position);
            rows.push_back(TableRow { time, all, of_bodies: of_bodies.clone(), reactions, displaced });
        }
        if is_noted {
            self.note(steps, (all, of_bodies));
        }
    }

    /// Advances as [`World::advance_towards`] does, and watches the bodies.
    fn walk(&mut self, moment: Moment, most_steps: u64) -> bool {
        let Self { scene, run, world, watch: Some(watch), .. } = self else {
            return self.world.advance_towards(moment, most_steps);
        };
        let (is_there, found) = watch.advance(scene, *run, world, (moment, most_steps));
        self.meet(found);
        is_there
    }

    /// Looks at the bodies now, so that a copy of the present state needs no earlier one.
    fn look(&mut self) {
        let Self { scene, run, world, watch, .. } = self;
        let found = watch.as_mut().and_then(|watch| watch.look(scene, *run, world));
        self.meet(found);
    }

    /// Keeps the message about two bodies, and watches no more.
    fn meet(&mut self, found: Option<String>) {
        if found.is_some() || self.world.status() != Status::Ok {
            (self.meeting, self.watch) = (found, None);
        }
    }

    /// Records the present state after a step for pictures, with its diagnostics.
    fn note(&mut self, step: u64, diagnostics: (Diagnostics, Vec<Diagnostics>)) {
        let position = &self.world.state().position;
        let time = step as f64 * self.of.step;
        self.series.note(self.scene, time, diagnostics, position);
        if !self.meters.is_empty() {
            let forces = self.world.reactions().unwrap_or_default();
            let readings = self.meters.iter().map(|meter| meter.read(time, position, &forces));
            self.series.readings.iter_mut().zip(readings).for_each(|(of, reading)| of.push(reading));
        }
        // Without time series there are no paths.
        for (traced, path) in self.scene.view.paths.iter().zip(&mut self.series.paths) {
            path.push(traced.of(self.of.body(), position));
        }
    }
}

impl History {
    /// Simulates runs of a scene from start to end, with all diagnostics, and what charts of the scene plot of single things.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn new(scene: &Scene, runs: &[usize]) -> Self {
        let single = scene.view.charts.iter().filter(|plot| plot.of().is_some()).cloned();
        Self::with(scene, runs, &Plot::diagnostics().into_iter().chain(single).collect::<Vec<_>>())
    }

    /// Simulates runs of a scene from start to end for their pictures: charts, paths, cameras that follow, and the size
    /// of plates and walls. Empty, without a simulation, if pictures show none of these.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn for_pictures(scene: &Scene, runs: &[usize]) -> Self {
        scene.time_series().map_or_else(Self::default, |wanted| Self::with(scene, runs, wanted))
    }

    fn with(scene: &Scene, runs: &[usize], plots: &[Plot]) -> Self {
        let mut runner = Runner::new(scene, runs).without_pictures().with_time_series(plots);
        runner.advance_towards(scene.moment(scene.last_frame()), u64::MAX);
        runner.take_history()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Limits;

    pub(super) fn read(text: &str) -> Scene {
        Scene::parse(text, "small.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Two runs, of which the second has a time step of its own.
    fn text(duration: &str, rate: &str, step: &str) -> String {
        format!(
            "gravity = [0, -9.8, 0]
            time = {{ duration = {duration}, frames_per_second = {rate} }}
            body.lattice = {{ cells = [2, 1, 1], side = 0.1 }}
            body.velocity = [0, -2, 0]
            obstacle = [{{ kind = 'floor', restitution = 0.5 }}]
            [[run]]
            name = 'shape'
            model = {{ kind = 'shape-based', stiffness = 1e4 }}
            [[run]]
            name = 'springs'
            model = {{ kind = 'mass-spring', stiffness = 1e4 }}
            step = '{step}'"
        )
    }

    pub(super) fn scene(duration: &str, rate: &str, step: &str) -> Scene {
        read(&text(duration, rate, step))
    }

    #[test]
    fn the_way_to_a_frame_may_be_cut_up() {
        let scene = scene("0.1", "20", "T/70");
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
        let scene = scene("0.1", "20", "T/70");
        let take = |whole_series: bool, slice: u64| {
            let runner = Runner::new(&scene, &[0, 1]).with_time_series(&Plot::diagnostics()[..]);
            let waiting = whole_series.then(|| growing::Growing::new(tempfile::tempfile().unwrap()));
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
        let small = text("0.1", "20", "T/70");
        let large = small.replace("[2, 1, 1]", "[20, 20, 20]");
        for (text, threads) in [(small, [0, 0]), (large, [1, 3])] {
            let scene = read(&text);
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
}
