//! The way of one scene through the program: simulate, show, write down.

use super::console;
use super::failure::{Failure, Status};
use super::interrupt;
use super::options::{PrintOptions, RunOptions};
use super::report;
use super::scenes::Job;
use crate::history::History;
use crate::output::{
    Clock, DIAGNOSTICS_FILE, DiagnosticsWriter, FRAME_FILES, Outcome, OutputError, STATES_FILE, Spent, StatesWriter,
    StoredStates, Summary, Timings, thread_time,
};
use crate::runner::{Frames, Next, Runner};
use crate::scene::Scene;
use crate::sim::body::Body;
use crate::sim::diagnostics::Diagnostic;
use crate::sim::snapshot::Frame;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// What turns frames into pictures, for one scene.
pub(super) trait Pictures {
    /// Writes down in the summary how the pictures are made.
    fn describe(&self, summary: &mut Summary);
    /// The diagnostics whose time series over the whole scene are needed before the first frame, if its course is.
    fn time_series(&self) -> Option<&[Diagnostic]>;
    /// Sets the time series of the scene.
    fn take_history(&mut self, history: &History);
    /// Draws a frame and sees to it that it is written, now or a little later.
    fn draw(&mut self, frame: &Frame) -> Result<(), Failure>;
    /// Waits until all frames are written, and writes down how many and how long it took.
    fn finish(self: Box<Self>, summary: &mut Summary, times: &mut Timings) -> Result<(), Failure>;
}

/// What makes pictures of scenes.
pub(super) trait Studio {
    /// Begins the pictures of some frames of a scene in a folder.
    fn begin<'s>(&'s self, scene: &'s Scene, folder: &Path, frames: &[u64]) -> Result<Box<dyn Pictures + 's>, Failure>;
}

/// Runs all scenes, one after the other, and reports on each.
pub(super) fn run_all(
    jobs: Vec<Job>,
    options: &RunOptions,
    words: &[OsString],
    timings: bool,
    studio: Option<&dyn Studio>,
) -> Result<Status, Failure> {
    interrupt::listen();
    let pool = pool(options.threads.count())?;
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
        summary.frames.shard = job.shard.map(|shard| [shard.number, shard.of]);
        result = record(job, &mut summary, &pool, options, studio);
        if options.printing.json {
            let mut document = json!({ "folder": path.to_string_lossy() });
            merge(&mut document, serde_json::to_value(&summary).expect("plain data"));
            documents.push(document);
        } else if !options.printing.quiet && result.is_ok() {
            console::print(&format!("{blank}{}", report::report(&summary, &path, timings)))?;
        }
        if result.is_err() {
            break;
        }
        interrupted = summary.outcome == Outcome::Interrupted;
    }
    // Finished scenes are reported before the failure.
    let printed = if options.printing.json { console::print_json(&json!({ "scenes": documents })) } else { Ok(()) };
    result.and(printed)?;
    Ok(if interrupted { Status::Interrupted } else { Status::Done })
}

/// Runs one scene. However it ends, the summary says so.
fn record(
    job: Job,
    summary: &mut Summary,
    pool: &ThreadPool,
    options: &RunOptions,
    studio: Option<&dyn Studio>,
) -> Result<(), Failure> {
    let Job { scene, runs, frames, folder, stored, .. } = job;
    let begin = || -> Result<_, Failure> {
        let folder = folder.prepare()?;
        let pictures = studio.map(|studio| studio.begin(&scene, folder.path(), &frames)).transpose()?;
        Ok((folder, pictures))
    };
    let result = begin().and_then(|(folder, pictures)| {
        let times = Timings::default();
        let path = folder.path();
        let recording = Recording { scene: &scene, runs, frames, folder: path, summary, last: None, times };
        recording.run(pool, options, pictures, stored)
    });
    if result.is_err() {
        summary.outcome = Outcome::Failed;
    }
    result
}

/// One frame of some runs of a scene, and the time series of the scene if its pictures need them; `None` if the user asked to stop.
/// States wait in `folder`.
#[cfg(feature = "render")]
pub(super) fn one_frame(
    scene: &Scene,
    runs: &[usize],
    frame: u64,
    pool: &ThreadPool,
    options: &RunOptions,
    folder: &Path,
) -> Result<Option<(Frame, Option<History>)>, Failure> {
    let wanted = scene.time_series();
    let mut frames = pool.install(|| {
        let runner = Runner::new(scene, runs).with_diagnostics(&scene.frame_diagnostics());
        let runner = match wanted {
            Some(wanted) => runner.with_time_series(wanted).with_difference(),
            None => runner,
        };
        Frames::new(runner, &[frame], wanted.is_some(), folder)
    });
    let bar = options.printing.progress(&scene.title, frames.steps()[1]);
    let (slice, mut history) = (slice(&scene.body), None);
    while !interrupt::requested() {
        let next = pool.install(|| frames.next(slice)).map_err(OutputError::writing(folder))?;
        bar.set_position(frames.steps()[0]);
        match next {
            Next::Working => {}
            Next::TimeSeries(found) => history = Some(found),
            Next::Frame(frame) => {
                bar.finish_and_clear();
                return Ok(Some((frame, history)));
            }
            Next::Done => break,
        }
    }
    bar.finish_and_clear();
    Ok(None)
}

/// Adds the keys of one document to another.
pub(super) fn merge(document: &mut Value, more: Value) {
    if let (Value::Object(document), Value::Object(more)) = (document, more) {
        document.extend(more);
    }
}

/// The threads that simulate.
pub(super) fn pool(threads: usize) -> Result<ThreadPool, Failure> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).thread_name(|at| format!("simulate {at}")).build();
    pool.map_err(|error| Failure::usage(format!("--threads: the system does not start so many threads ({error})")))
}

/// One scene on its way.
struct Recording<'a> {
    scene: &'a Scene,
    runs: Vec<usize>,
    frames: Vec<u64>,
    folder: &'a Path,
    summary: &'a mut Summary,
    last: Option<Frame>,
    times: Timings,
}

impl<'a> Recording<'a> {
    /// Makes all frames. Whatever happens on the way, what was made until then is finished and kept.
    fn run(
        mut self,
        pool: &ThreadPool,
        options: &RunOptions,
        mut pictures: Option<Box<dyn Pictures + '_>>,
        stored: Option<StoredStates>,
    ) -> Result<(), Failure> {
        let (total, simulating) = (Clock::process(), processor_time(pool));
        if let Some(pictures) = &pictures {
            pictures.describe(self.summary);
        }
        // Written before the first frame, so that the folder is known as this scene's even if the program is killed.
        self.summary.write(self.folder)?;
        let mut diagnostics = DiagnosticsWriter::create(self.folder, self.scene)?;
        let mut simulation = self.simulation(pool, options, pictures.as_deref(), stored)?;
        let begin = || StatesWriter::create(self.folder, self.scene, &self.runs, simulation.frames.states());
        let mut states = options.states.then(begin).transpose()?;

        let made = self.simulate(pool, options.printing, &mut simulation, |next, frames| match next {
            Next::TimeSeries(history) => {
                pictures.as_deref_mut().into_iter().for_each(|pictures| pictures.take_history(history));
                states.as_mut().into_iter().for_each(|states| states.set_history(history));
                Ok(())
            }
            Next::Frame(frame) => {
                diagnostics.write(frame)?;
                if let Some(states) = &mut states {
                    states.write(frame, frames.states())?;
                }
                pictures.as_deref_mut().map_or(Ok(()), |pictures| pictures.draw(frame))
            }
            Next::Working | Next::Done => Ok(()),
        });
        if let Some(states) = &mut states {
            (0..self.runs.len()).for_each(|place| states.set_last_fit(place, simulation.frames.last_fit(place)));
        }

        let drawn = pictures.map_or(Ok(()), |pictures| pictures.finish(self.summary, &mut self.times));
        let recorded = diagnostics.finish();
        let kept = states.map(StatesWriter::finish);
        self.summary.files = [
            (DIAGNOSTICS_FILE, recorded.is_ok()),
            (STATES_FILE, matches!(kept, Some(Ok(())))),
            (FRAME_FILES, self.summary.frames.written > Some(0) || self.summary.frames.kept > 0),
        ]
        .into_iter()
        .filter_map(|(name, written)| written.then_some(name))
        .collect();
        let result =
            made.and(drawn).and(recorded.map_err(Failure::from)).and(kept.unwrap_or(Ok(())).map_err(Failure::from));

        let of_pool = processor_time(pool).zip(simulating).map(|(now, start)| (now - start).as_secs_f64());
        self.times.simulate.cpu = of_pool.map(|pool| pool + self.times.simulate.cpu.unwrap_or(0.0));
        self.times.total = total.spent();
        let summary = &mut *self.summary;
        summary.outcome = match &result {
            Err(_) => Outcome::Failed,
            Ok(()) if summary.frames.recorded < summary.frames.asked => Outcome::Interrupted,
            Ok(()) => Outcome::Done,
        };
        if let Some(last) = &self.last {
            summary.note_last(last);
        }
        let drawing = rest(&self.times);
        if let Some(draw) = &mut self.times.draw {
            draw.cpu = drawing;
        }
        summary.times = Some(self.times);
        let written = summary.write(self.folder).map_err(Failure::from);
        result.and(written)
    }

    /// Where the frames come from. Only pictures, now or from the states that are written, need the scene's field, and some of
    /// them its time series, which are those of the whole scene.
    fn simulation(
        &self,
        pool: &ThreadPool,
        options: &RunOptions,
        pictures: Option<&dyn Pictures>,
        stored: Option<StoredStates>,
    ) -> Result<Simulation<'a>, Failure> {
        let scene = self.scene;
        let is_whole = self.frames.last() == Some(&scene.last_frame());
        let wanted = match pictures {
            Some(pictures) => pictures.time_series(),
            None => scene.time_series().filter(|_| options.states && is_whole),
        };
        let is_drawn = pictures.is_some();
        let ahead = wanted.is_some() && is_drawn;
        pool.install(|| {
            let mut runner = Runner::new(scene, &self.runs);
            if let Some(stored) = stored {
                let read_from = stored.path().to_owned();
                let frames = Frames::stored(runner, &self.frames, stored).map_err(OutputError::reading(&read_from))?;
                return Ok(Simulation { frames, ahead: false, notes: false, read_from: Some(read_from) });
            }
            if !is_drawn && !options.states {
                runner = runner.without_pictures();
            }
            if let Some(wanted) = &wanted {
                runner = runner.with_time_series(wanted).with_difference();
            }
            let frames = Frames::new(runner, &self.frames, ahead, self.folder);
            Ok(Simulation { frames, ahead, notes: wanted.is_some() && !ahead, read_from: None })
        })
    }

    /// Takes all frames, and the time series if there are any, until all are there or the user wants to stop.
    fn simulate(
        &mut self,
        pool: &ThreadPool,
        printing: PrintOptions,
        simulation: &mut Simulation<'_>,
        mut take: impl FnMut(&Next, &Frames<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let Simulation { frames, ahead, notes, read_from } = simulation;
        let bar = printing.progress(&self.scene.title, frames.steps()[1]);
        if *ahead {
            bar.set_message("simulating ahead");
        }
        let slice = slice(&self.scene.body);
        while !interrupt::requested() {
            let clock = Clock::thread();
            let next = pool.install(|| frames.next(slice));
            self.times.simulate += Spent { cpu: None, ..clock.spent() };
            bar.set_position(frames.steps()[0]);
            let next = next.map_err(|error| match read_from {
                Some(file) => OutputError::reading(file)(error),
                None => OutputError::writing(self.folder)(error),
            })?;
            if let Next::Frame(_) = next {
                bar.set_message(format!("frame {} of {}", frames.taken(), self.frames.len()));
            }
            take(&next, frames)?;
            match next {
                Next::Working | Next::TimeSeries(_) => {}
                Next::Frame(frame) => {
                    self.summary.frames.recorded += 1;
                    self.last = Some(frame);
                }
                Next::Done => {
                    if *notes {
                        let history = frames.take_history();
                        take(&Next::TimeSeries(history), frames)?;
                    }
                    break;
                }
            }
        }
        for (run, steps) in self.summary.runs.iter_mut().zip(frames.simulated()) {
            run.steps = steps;
        }
        self.times.simulate.cpu = helpers_time(frames).map(|time| time.as_secs_f64());
        bar.finish_and_clear();
        Ok(())
    }
}

/// Where frames come from.
struct Simulation<'a> {
    frames: Frames<'a>,
    /// Whether all is simulated before the first frame.
    ahead: bool,
    /// Whether the time series are known after the last one.
    notes: bool,
    /// The file from which states are read instead.
    read_from: Option<PathBuf>,
}

/// Steps of each run after which the user is listened to: some milliseconds' worth, at some 2 ns for each corner of an
/// element, and ten times that with the reference code. A frame seldom takes more.
pub(super) fn slice(body: &Body) -> u64 {
    const CORNERS: usize = 2_500_000;
    (CORNERS / body.elements.indices().len().max(1)).max(1) as u64
}

/// Processor time of all threads of the pool so far.
fn processor_time(pool: &ThreadPool) -> Option<Duration> {
    pool.broadcast(|_| thread_time()).into_iter().sum()
}

/// Processor time so far of the threads that were lent to runs.
fn helpers_time(frames: &mut Frames<'_>) -> Option<Duration> {
    let times = Mutex::new(Vec::new());
    frames.ask_helpers(&|| times.lock().unwrap_or_else(PoisonError::into_inner).push(thread_time()));
    times.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().sum()
}

/// The processor time that no other stage accounts for: that of drawing, wherever its driver spends it.
fn rest(times: &Timings) -> Option<f64> {
    let others = [Some(times.simulate), times.compose, times.encode].into_iter().flatten();
    let others: Option<f64> = others.map(|spent| spent.cpu).sum();
    times.total.cpu.zip(others).map(|(total, others)| (total - others).max(0.0))
}
