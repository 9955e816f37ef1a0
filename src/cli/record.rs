//! Simulates one scene, draws it, and writes the results.

use super::failure::{Failure, Status, note, note_no_room, with_causes};
use super::options::{PrintOptions, RunOptions};
use super::results::{Pace, Pictures, Results};
use super::scenes::{Job, with_option};
use super::{console, interrupt, report};
use crate::look::Plot;
use crate::output::export::Export;
use crate::output::{
    Checkpoint, Claimed, Clock, DIAGNOSTICS_FILE, DiagnosticsWriter, FRAME_FILES, Outcome, OutputError, STATES_FILE,
    Spent, StatesWriter, Summary, Timings, thread_time, waiting_states,
};
use crate::reading::setting::Setting;
use crate::runner::Frame;
use crate::runner::cause::Cause;
use crate::runner::growing::Growing;
use crate::runner::{Frames, Next, Progress, Runner, Stored, crossing};
use crate::scene::{Run, Scene};
use crate::sim::{self, State};
use rayon::ThreadPool;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::error::Error;
use std::ffi::OsString;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Begins the pictures of some frames of a scene, in a folder.
pub(super) type Begin<'d> = dyn for<'s> Fn(&'s Scene, &Path, &[u64]) -> Result<Box<dyn Pictures + 's>, Failure> + 'd;

/// Runs all scenes in order and reports on each. If pictures are made, `begin` begins those of a scene.
pub(super) fn run_all(
    jobs: Vec<Job>,
    options: &RunOptions,
    settings: &[Setting],
    words: &[OsString],
    timings: bool,
    begin: Option<&Begin<'_>>,
) -> Result<Status, Failure> {
    interrupt::listen();
    let pool = options.threads.pool()?;
    let command: Vec<_> = words.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    let mut documents: Vec<Value> = Vec::new();
    let mut interrupted = false;
    let mut result = Ok(());
    for (number, job) in jobs.into_iter().enumerate() {
        if interrupt::requested() {
            interrupted = true;
            break;
        }
        let path = job.folder.path().to_owned();
        let mut blank = if number > 0 { "\n" } else { "" };
        if let Some(replaced) = job.folder.replaced().filter(|_| options.printing.prints_text()) {
            console::print(&format!("{blank}{}: replacing {replaced}\n", path.display()))?;
            blank = "";
        }
        let mut summary = Summary::new(&job.scene, &job.runs, job.frames.len(), &command);
        summary.set = settings.iter().map(|setting| setting.text().to_owned()).collect();
        summary.adapter = job.adapter.clone();
        // Frames that are not kept count as simulated only.
        summary.frames.size = job.folder.contents().0.kept_size();
        summary.frames.written = summary.frames.size.map(|_| 0);
        result = record(job, &mut summary, &pool, options, begin);
        if options.printing.json {
            let mut document = json!({ "folder": path.to_string_lossy() });
            merge(&mut document, serde_json::to_value(&summary).expect("plain data"));
            documents.push(document);
        } else if !options.printing.quiet && result.is_ok() {
            console::print(&format!("{blank}{}", report::report(&summary, &path, timings)))?;
            if summary.outcome == Outcome::Interrupted {
                console::print(&format!("to go on: {}\n", with_option(words, "--resume")))?;
            }
        }
        if !options.printing.quiet {
            report::unsolved(&summary).for_each(|message| note(&message));
            if let Some(size) = summary.frames.size {
                note_no_room(
                    summary.scene.file.as_ref().unwrap_or(&summary.scene.title),
                    size,
                    &summary.frames.left_out,
                );
            }
        }
        if result.is_err() {
            break;
        }
        interrupted = summary.outcome == Outcome::Interrupted;
    }
    // Finished scenes are reported before the failure.
    let printed = if options.printing.json { console::print_json(&json!({ "scenes": documents })) } else { Ok(()) };
    result.and(printed)?;
    Ok(if interrupted || interrupt::requested() { Status::Interrupted } else { Status::Done })
}

/// Runs one scene. Its summary has the outcome in every case.
fn record(
    job: Job,
    summary: &mut Summary,
    pool: &ThreadPool,
    options: &RunOptions,
    begin_pictures: Option<&Begin<'_>>,
) -> Result<(), Failure> {
    let Job { scene, runs, frames, all, folder, stored, .. } = job;
    let begin = || -> Result<_, Failure> {
        let mut first = summary.clone();
        if folder.is_shard() {
            (first.outcome, first.frames.asked) = (Outcome::Shards, all.len());
        }
        let (folder, checkpoint) = folder.prepare(&first)?;
        let pictures = begin_pictures.map(|begin| begin(&scene, folder.path(), &frames)).transpose()?;
        let export = Export::begin(folder.path(), &scene, &runs, &options.formats(), &all)?;
        Ok((folder, checkpoint, pictures, export))
    };
    let result = begin().and_then(|(folder, checkpoint, pictures, export)| {
        let session = Session {
            scene: &scene,
            runs: runs.clone(),
            frames: frames.clone(),
            folder: &folder,
            summary,
            last: None,
            sound: Vec::new(),
            times: Timings::default(),
        };
        session.run(pool, options, (pictures, export), stored, checkpoint)
    });
    if result.is_err() {
        summary.outcome = Outcome::Failed;
    }
    result
}

/// Adds the keys of one document to another.
pub(super) fn merge(document: &mut Value, more: Value) {
    if let (Value::Object(document), Value::Object(more)) = (document, more) {
        document.extend(more);
    }
}

/// A scene whose results are being made.
struct Session<'a> {
    scene: &'a Scene,
    runs: Vec<usize>,
    frames: Vec<u64>,
    folder: &'a Claimed,
    summary: &'a mut Summary,
    last: Option<Frame>,
    /// The last sound state of each run in a frame, from which the cause of its divergence is searched for.
    sound: Vec<State>,
    times: Timings,
}

impl<'a> Session<'a> {
    /// Makes all frames, or those after a checkpoint. After an error, the results until then are finished and kept.
    fn run(
        mut self,
        pool: &ThreadPool,
        options: &RunOptions,
        (mut pictures, mut export): (Option<Box<dyn Pictures + '_>>, Export<'_>),
        stored: Option<Stored>,
        mut checkpoint: Option<Checkpoint>,
    ) -> Result<(), Failure> {
        let (total, simulating) = (Clock::process(), processor_time(pool));
        if let Some(found) = &mut checkpoint {
            self.keep(found, pictures.as_deref_mut(), &mut export)?;
        }
        let (progress, rows, course) = match checkpoint {
            Some(Checkpoint { progress, causes, extremes, rows, course, .. }) => {
                for ((run, cause), extremes) in self.summary.runs.iter_mut().zip(causes).zip(extremes) {
                    (run.cause, run.extremes) = (cause, extremes);
                }
                (Some(progress), rows, course)
            }
            None => (None, None, None),
        };
        let (folder, scene) = (self.folder.path(), self.scene);
        let diagnostics = match rows {
            _ if self.folder.is_shard() => None,
            Some(rows) => {
                let resumed = DiagnosticsWriter::resume(folder, scene, rows);
                Some(resumed.map_err(|error| self.unusable(&error))?)
            }
            None => Some(DiagnosticsWriter::create(folder, scene)?),
        };
        self.summary.frames.recorded = progress.as_ref().map_or(0, |progress| progress.taken);
        let mut simulation = self.simulation(pool, options, pictures.is_some(), stored, progress)?;
        let goes_on = course.is_some();
        let begin = || {
            let made = StatesWriter::create(folder, scene, &self.runs, simulation.frames.states(), course);
            made.map_err(|error| if goes_on { self.unusable(&error) } else { error })
        };
        let keeps = options.states || options.write.iter().any(|format| format.is_of_course());
        let states = keeps.then(begin).transpose()?;

        let mut results = Results { diagnostics, states, export, pictures, warned: options.printing.quiet };
        let made = self.simulate(pool, options.printing, &mut simulation, &mut results);
        for place in 0..self.runs.len() {
            let last_fit = simulation.frames.last_fit(place);
            results.states.iter_mut().for_each(|states| states.set_last_fit(place, last_fit));
        }
        let result = self.finish(made, results, options.states);
        let of_pool = processor_time(pool).zip(simulating).map(|(now, start)| (now - start).as_secs_f64());
        self.times.simulate.cpu = of_pool.map(|pool| pool + self.times.simulate.cpu.unwrap_or(0.0));
        self.times.total = total.spent();
        self.conclude(result)
    }

    /// Keeps the pictures and exported files of the frames before a checkpoint, or refuses it if one of them has changed.
    fn keep(
        &self,
        checkpoint: &mut Checkpoint,
        pictures: Option<&mut (dyn Pictures + '_)>,
        export: &mut Export<'_>,
    ) -> Result<(), Failure> {
        let taken = self.frames.get(..checkpoint.progress.taken).unwrap_or_default();
        let mut wrong = pictures.map_or(Ok(None), |pictures| pictures.keep(taken))?;
        if wrong.is_none() {
            wrong = export.keep(taken, std::mem::take(&mut checkpoint.exported))?;
        }
        let Some(wrong) = wrong else { return Ok(()) };
        let what = format!("counts on {wrong}").into();
        Err(OutputError::Checkpoint { path: self.folder.path().to_owned(), what }.into())
    }

    /// Finishes all files but the summary, which gets their names.
    fn finish(&mut self, made: Result<(), Failure>, results: Results<'_>, keeps: bool) -> Result<(), Failure> {
        let Results { diagnostics, mut states, export, pictures, .. } = results;
        let drawn = pictures.map_or(Ok(()), |pictures| pictures.finish(self.summary, &mut self.times));
        let recorded = diagnostics.map(DiagnosticsWriter::finish);
        let of_shards = self.folder.is_shard();
        let exported = export.finish((!of_shards).then_some(self.summary.frames.recorded), states.as_mut());
        let kept = states.filter(|_| keeps).map(StatesWriter::finish);
        let files = &self.folder.contents().0.files;
        self.summary.files = [
            (DIAGNOSTICS_FILE, matches!(recorded, Some(Ok(())))),
            (STATES_FILE, matches!(kept, Some(Ok(())))),
            (FRAME_FILES, self.summary.frames.written > Some(0) || self.summary.frames.kept > 0),
        ]
        .into_iter()
        .filter(|&(_, written)| written)
        .map(|(name, _)| name.to_owned())
        .chain(files.iter().filter(|_| exported.is_ok()).cloned())
        .collect();
        let tables = recorded.unwrap_or(Ok(())).and(kept.unwrap_or(Ok(()))).and(exported);
        made.and(drawn).and(tables.map_err(Failure::from))
    }

    /// Writes the summary, which marks the folder as finished.
    fn conclude(mut self, result: Result<(), Failure>) -> Result<(), Failure> {
        let drawing = rest(&self.times);
        self.times.draw.iter_mut().for_each(|draw| draw.cpu = drawing);
        let summary = self.summary;
        summary.outcome = match &result {
            Err(_) => Outcome::Failed,
            Ok(()) if summary.frames.recorded < summary.frames.asked => Outcome::Interrupted,
            Ok(()) => Outcome::Done,
        };
        if let Some(last) = &self.last {
            summary.note_last(self.scene, last);
        }
        summary.times = Some(self.times);
        if self.folder.is_shard() {
            return result;
        }
        let folder = self.folder.path();
        let written = summary.write(folder).map_err(Failure::from);
        if summary.outcome == Outcome::Done && written.is_ok() {
            Checkpoint::remove(folder)?;
        }
        result.and(written)
    }

    /// Finds the causes of divergences since the last frame.
    fn find_causes(&mut self, states: &[&State]) {
        let runs = self.summary.runs.iter_mut().zip(&self.runs).zip(&mut self.sound);
        for (((summary, &run), sound), state) in runs.zip(states) {
            match state.status {
                sim::Status::Ok => sound.clone_from(state),
                sim::Status::Diverged(divergence) if sound.status == sim::Status::Ok => {
                    summary.cause = Cause::find(self.scene, run, sound, divergence, rayon::current_num_threads());
                    sound.clone_from(state);
                }
                sim::Status::Diverged(_) => {}
            }
        }
    }

    /// The error for a checkpoint without its files.
    fn unusable(&self, error: &dyn Error) -> OutputError {
        let what = format!("cannot be used ({})", with_causes(error)).into();
        OutputError::Checkpoint { path: self.folder.path().to_owned(), what }
    }

    /// The source of frames. Only pictures, now or from written states, need the field of the scene, and some of them
    /// the time series of the whole scene.
    fn simulation(
        &self,
        pool: &ThreadPool,
        options: &RunOptions,
        is_drawn: bool,
        stored: Option<Stored>,
        progress: Option<Progress>,
    ) -> Result<Simulation<'a>, Failure> {
        let (scene, folder) = (self.scene, self.folder.path());
        let is_whole = self.frames.last() == Some(&scene.last_frame());
        let shown = scene.time_series().filter(|_| is_drawn || options.states && is_whole);
        let ahead = shown.is_some() && is_drawn;
        let noted = shown.unwrap_or_default().to_vec();
        pool.install(|| {
            let mut runner = Runner::new(scene, &self.runs);
            if let Some(stored) = stored {
                let path = stored.path.clone();
                let frames = Frames::stored(runner, &self.frames, stored).map_err(OutputError::reading(&path))?;
                return Ok(Simulation { frames, ahead: false, notes: false, noted, is_stored: true });
            }
            // Bodies are watched for messages alone.
            if !options.printing.quiet {
                runner = runner.watching();
            }
            if !is_drawn && !options.states && options.write.is_empty() {
                runner = runner.without_pictures();
            }
            runner = runner.with_time_series(shown);
            if !self.folder.is_shard() {
                runner = runner.with_rows();
            }
            let before = progress.as_ref().and_then(Progress::waiting);
            let file = waiting_states(folder);
            let open = || match self.folder.is_shard() {
                // This file is not continued after an interruption.
                true => tempfile::tempfile_in(folder).map(Growing::new),
                false => Growing::open(&file, before),
            };
            let waiting = ahead.then(open).transpose().map_err(|error| match before {
                Some(_) => self.unusable(&OutputError::reading(&file)(error)),
                None => OutputError::writing(folder)(error),
            })?;
            let mut frames = Frames::new(runner, &self.frames, waiting);
            progress.map_or(Ok(()), |progress| frames.resume(progress)).map_err(|error| self.unusable(&error))?;
            let notes = shown.is_some() && !ahead && is_whole;
            Ok(Simulation { frames, ahead, notes, noted, is_stored: false })
        })
    }

    /// Takes all frames, and the time series if there are any, until the last frame or an interruption.
    fn simulate(
        &mut self,
        pool: &ThreadPool,
        printing: PrintOptions,
        simulation: &mut Simulation<'_>,
        results: &mut Results<'_>,
    ) -> Result<(), Failure> {
        let bar = printing.progress(&self.scene.title, simulation.frames.steps()[1]);
        if simulation.ahead {
            bar.set_message("simulating ahead");
        }
        let slice = slice(self.runs.iter().map(|&run| &self.scene.runs[run]));
        self.sound = simulation.frames.states().cloned().collect();
        // Runs that diverged between the last frame and the checkpoint.
        for ((summary, &run), sound) in self.summary.runs.iter().zip(&self.runs).zip(&mut self.sound) {
            if !simulation.is_stored && sound.status != sim::Status::Ok && summary.cause.is_none() {
                *sound = self.scene.world(run).state().clone();
            }
        }
        // States that are read need no checkpoint.
        let can_resume = !simulation.is_stored && !self.folder.is_shard();
        let tell_meetings = |frames: &mut Frames<'_>| {
            frames.meetings().iter().filter(|_| !printing.quiet).for_each(|message| bar.suspend(|| note(message)));
        };
        let mut crossed = BTreeSet::new();
        let mut pace = Pace::new();
        while !interrupt::requested() {
            if can_resume && pace.is_due() {
                pace.take(|| results.save(&mut simulation.frames, simulation.ahead, self.folder, self.summary))?;
            }
            let frames = &mut simulation.frames;
            let clock = Clock::thread();
            let next = pool.install(|| frames.next(slice));
            self.times.simulate += Spent { cpu: None, ..clock.spent() };
            bar.set_position(frames.steps()[0]);
            tell_meetings(frames);
            let next = next.map_err(|error| match frames.unreadable() {
                Some(file) => OutputError::reading(file)(error),
                None => OutputError::writing(self.folder.path())(error),
            })?;
            if let Next::Frame(frame) = &next {
                bar.set_message(format!("frame {} of {}", frames.taken(), self.frames.len()));
                let found = frame.runs.iter().filter_map(|run| Some((run.run, crossing(self.scene, run)?)));
                found
                    .filter(|&(run, _)| !printing.quiet && crossed.insert(run))
                    .for_each(|(_, message)| bar.suspend(|| note(&message)));
            }
            if !self.take(next, pool, simulation, results)? {
                break;
            }
        }
        if interrupt::requested() {
            self.summary.reached = simulation.frames.on_the_way();
        }
        if can_resume && interrupt::requested() {
            results.save(&mut simulation.frames, simulation.ahead, self.folder, self.summary)?;
            tell_meetings(&mut simulation.frames);
        }
        let frames = &mut simulation.frames;
        self.summary.note_series(&simulation.noted, frames.series());
        for (run, steps) in self.summary.runs.iter_mut().zip(frames.simulated()) {
            run.steps = steps;
        }
        self.times.simulate.cpu = helpers_time(frames).map(|time| time.as_secs_f64());
        bar.finish_and_clear();
        Ok(())
    }

    /// Takes one result of the simulation. Returns whether more are to come.
    fn take(
        &mut self,
        next: Next,
        pool: &ThreadPool,
        simulation: &mut Simulation<'_>,
        results: &mut Results<'_>,
    ) -> Result<bool, Failure> {
        let Simulation { frames, notes, noted, is_stored, .. } = simulation;
        let is_done = matches!(next, Next::Done);
        let history = match next {
            Next::TimeSeries(history) => Some(history),
            Next::Done if *notes => Some(frames.take_history()),
            Next::Frame(frame) => {
                let between = frames.take_rows(&frame);
                results.take(&frame, &between, frames)?;
                self.summary.frames.recorded += 1;
                self.summary.note(self.scene, &frame, &between);
                if !*is_stored {
                    let states: Vec<_> = frames.states().collect();
                    pool.install(|| self.find_causes(&states));
                }
                self.last = Some(frame);
                None
            }
            Next::Working | Next::Done => None,
        };
        if let Some(history) = history {
            self.summary.note_series(noted, &history.series);
            results.take_history(history);
        }
        Ok(!is_done)
    }
}

/// The source of frames.
struct Simulation<'a> {
    frames: Frames<'a>,
    /// Whether everything is simulated before the first frame.
    ahead: bool,
    /// Whether the time series are known after the last frame.
    notes: bool,
    /// The charts of the time series.
    noted: Vec<Plot>,
    /// Whether stored states are shown, whose causes of divergence are not searched for.
    is_stored: bool,
}

/// Steps of each of some runs between tests for an interruption: some milliseconds, at some 2 ns for each corner of an
/// element, and ten times that with the reference code. A frame seldom takes more.
pub(super) fn slice<'a>(runs: impl IntoIterator<Item = &'a Run>) -> u64 {
    const CORNERS: usize = 2_500_000;
    let corners = runs.into_iter().map(|run| run.body().elements().indices().len()).max();
    (CORNERS / corners.unwrap_or(0).max(1)).max(1) as u64
}

/// Processor time of all threads of the pool so far.
fn processor_time(pool: &ThreadPool) -> Option<Duration> {
    pool.broadcast(|_| thread_time()).into_iter().sum()
}

/// Processor time so far of the helper threads of runs.
fn helpers_time(frames: &mut Frames<'_>) -> Option<Duration> {
    let times = Mutex::new(Vec::new());
    frames.ask_helpers(&|| times.lock().unwrap_or_else(PoisonError::into_inner).push(thread_time()));
    times.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().sum()
}

/// The processor time that no other stage accounts for. It is that of drawing, on any thread of its driver.
fn rest(times: &Timings) -> Option<f64> {
    let others = [Some(times.simulate), times.compose, times.encode].into_iter().flatten();
    let others: Option<f64> = others.map(|spent| spent.cpu).sum();
    times.total.cpu.zip(others).map(|(total, others)| (total - others).max(0.0))
}
