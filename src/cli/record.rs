//! The way of one scene through the program: simulate, show, write down.

use super::console;
use super::failure::{Failure, Status};
use super::interrupt;
use super::options::RunOptions;
use super::report;
use super::scenes::Job;
use crate::output::{Clock, DiagnosticsWriter, Outcome, Spent, StatesWriter, Summary, Timings, thread_time};
use crate::scene::Scene;
use crate::sequence::Sequence;
use crate::sim::snapshot::Frame;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What turns frames into pictures, for one scene.
pub(super) trait Pictures {
    /// Writes down in the summary how the pictures are made.
    fn describe(&self, summary: &mut Summary);
    /// Draws a frame and sees to it that it is written, now or a little later.
    fn draw(&mut self, frame: &Frame) -> Result<(), Failure>;
    /// Waits until all frames are written, and writes down how many and how long it took.
    fn finish(self: Box<Self>, summary: &mut Summary, times: &mut Timings) -> Result<(), Failure>;
}

/// What makes pictures of scenes.
pub(super) trait Studio {
    /// Begins the pictures of a scene in a folder.
    fn begin<'s>(&self, scene: &'s Scene, folder: &Path) -> Result<Box<dyn Pictures + 's>, Failure>;
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
    let pool = pool(options)?;
    let command: Vec<_> = words.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    let mut documents: Vec<Value> = Vec::new();
    let mut interrupted = false;
    for (number, job) in jobs.into_iter().enumerate() {
        if interrupt::requested() {
            interrupted = true;
            break;
        }
        let Job { scene, runs, frames, folder } = job;
        let folder = folder.prepare()?;
        let mut recording = Recording {
            summary: Summary::new(&scene, &runs, frames.len(), &command),
            folder,
            scene: &scene,
            runs,
            frames,
            last: None,
            times: Timings::default(),
        };
        let pictures = studio.map(|studio| studio.begin(&scene, &recording.folder)).transpose()?;
        recording.run(&pool, options, pictures)?;
        let (summary, folder) = (&recording.summary, &recording.folder);
        if options.json {
            let mut document = json!({ "folder": folder.to_string_lossy() });
            merge(&mut document, serde_json::to_value(summary).expect("plain data"));
            documents.push(document);
        } else if !options.quiet {
            let blank = if number > 0 { "\n" } else { "" };
            console::print(&format!("{blank}{}", report::report(summary, folder, timings)))?;
        }
        interrupted = summary.outcome == Outcome::Interrupted;
    }
    if options.json {
        console::print_json(&json!({ "scenes": documents }))?;
    }
    Ok(if interrupted { Status::Interrupted } else { Status::Done })
}

fn merge(document: &mut Value, more: Value) {
    if let (Value::Object(document), Value::Object(more)) = (document, more) {
        document.extend(more);
    }
}

fn pool(options: &RunOptions) -> Result<ThreadPool, Failure> {
    let pool =
        ThreadPoolBuilder::new().num_threads(options.threads()).thread_name(|at| format!("simulate {at}")).build();
    pool.map_err(|error| Failure::usage(format!("--threads: the system does not start so many threads ({error})")))
}

/// One scene on its way.
struct Recording<'a> {
    scene: &'a Scene,
    runs: Vec<usize>,
    frames: Vec<u64>,
    folder: PathBuf,
    summary: Summary,
    last: Option<Frame>,
    times: Timings,
}

impl Recording<'_> {
    /// Makes all frames. Whatever happens on the way, what was made until then is finished and kept.
    fn run(
        &mut self,
        pool: &ThreadPool,
        options: &RunOptions,
        mut pictures: Option<Box<dyn Pictures + '_>>,
    ) -> Result<(), Failure> {
        let (total, simulating) = (Clock::process(), processor_time(pool));
        if let Some(pictures) = &pictures {
            pictures.describe(&mut self.summary);
        }
        // Written before the first frame, so that the folder is known as this scene's even if the program is killed.
        self.summary.write(&self.folder)?;
        let mut diagnostics = DiagnosticsWriter::create(&self.folder, self.scene)?;
        let mut states =
            options.states.then(|| StatesWriter::create(&self.folder, self.scene, &self.runs)).transpose()?;

        let bar = console::progress(&self.scene.title, self.frames.len(), options.quiet);
        let made = self.frames(pool, |frame| {
            diagnostics.write(frame)?;
            if let Some(states) = &mut states {
                states.write(frame)?;
            }
            if let Some(pictures) = &mut pictures {
                pictures.draw(frame)?;
            }
            bar.inc(1);
            Ok(())
        });
        bar.finish_and_clear();

        let drawn = pictures.map_or(Ok(()), |pictures| pictures.finish(&mut self.summary, &mut self.times));
        let recorded = diagnostics.finish();
        let kept = states.map_or(Ok(()), StatesWriter::finish);
        let result = made.and(drawn).and(recorded.map_err(Failure::from)).and(kept.map_err(Failure::from));

        self.times.simulate.cpu = processor_time(pool).zip(simulating).map(|(now, start)| (now - start).as_secs_f64());
        self.times.total = total.spent();
        let summary = &mut self.summary;
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
        let written = summary.write(&self.folder).map_err(Failure::from);
        result.and(written)
    }

    /// Simulates frame by frame until all are there or the user wants to stop.
    fn frames(
        &mut self,
        pool: &ThreadPool,
        mut take: impl FnMut(&Frame) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        // In the pool from the beginning, so that no other threads are ever started.
        let mut sequence = pool.install(|| Sequence::new(self.scene, &self.runs));
        for &index in &self.frames {
            if interrupt::requested() {
                break;
            }
            let clock = Clock::thread();
            let frame = pool.install(|| sequence.frame(index));
            self.times.simulate += Spent { cpu: None, ..clock.spent() };
            take(&frame)?;
            self.summary.frames.recorded += 1;
            self.last = Some(frame);
        }
        Ok(())
    }
}

/// Processor time of all threads of the pool so far.
fn processor_time(pool: &ThreadPool) -> Option<Duration> {
    pool.broadcast(|_| thread_time()).into_iter().sum()
}

/// The processor time that no other stage accounts for: that of drawing, wherever its driver spends it.
fn rest(times: &Timings) -> Option<f64> {
    let others = [Some(times.simulate), times.compose, times.encode].into_iter().flatten();
    let others: Option<f64> = others.map(|spent| spent.cpu).sum();
    times.total.cpu.zip(others).map(|(total, others)| (total - others).max(0.0))
}
