//! Writes the results of frames, and the checkpoints from which an interrupted command continues.

use super::failure::{Failure, note, with_causes};
use crate::output::export::Export;
use crate::output::{Checkpoint, Claimed, DiagnosticsWriter, OutputError, StatesWriter, Summary, Timings};
use crate::runner::history::History;
use crate::runner::{Frame, Frames, TableRow};
use std::time::{Duration, Instant};

/// Makes pictures of frames, for one scene.
pub(super) trait Pictures {
    /// Sets the time series of the scene.
    fn take_history(&mut self, history: &History);
    /// Draws a frame. It is written now or a little later.
    fn draw(&mut self, frame: &Frame) -> Result<(), Failure>;
    /// Waits until all frames so far are written.
    fn flush(&mut self) -> Result<(), Failure>;
    /// Keeps frames of an earlier command. If one of them has changed, returns its fault in words.
    fn keep(&mut self, frames: &[u64]) -> Result<Option<String>, Failure>;
    /// Waits until all frames are written, and records their number and the time taken.
    fn finish(self: Box<Self>, summary: &mut Summary, times: &mut Timings) -> Result<(), Failure>;
}

/// The results of one scene, frame by frame.
pub(super) struct Results<'a> {
    /// `None` in a shard.
    pub(super) diagnostics: Option<DiagnosticsWriter<'a>>,
    pub(super) states: Option<StatesWriter>,
    /// Files for other programs.
    pub(super) export: Export<'a>,
    pub(super) pictures: Option<Box<dyn Pictures + 'a>>,
    /// Whether the user has read that no checkpoint can be written, or wants no warnings.
    pub(super) warned: bool,
}

impl Results<'_> {
    /// Takes the time series of the scene, which are complete.
    pub(super) fn take_history(&mut self, history: History) {
        self.pictures.iter_mut().for_each(|pictures| pictures.take_history(&history));
        if let Some(states) = &mut self.states {
            states.set_history(history);
        }
    }

    /// Takes a frame with its states, and the rows of each run before it.
    pub(super) fn take(
        &mut self,
        frame: &Frame,
        between: &[Vec<TableRow>],
        frames: &Frames<'_>,
    ) -> Result<(), Failure> {
        let Self { diagnostics, states, export, pictures, .. } = self;
        diagnostics.iter_mut().try_for_each(|diagnostics| diagnostics.write(frame, between))?;
        if let Some(states) = states {
            states.write(frame, between, frames.states())?;
        }
        export.write(frame)?;
        pictures.as_deref_mut().map_or(Ok(()), |pictures| pictures.draw(frame))
    }

    /// Writes a checkpoint unless the simulation is finished. With `ahead`, it is finished before the first frame.
    ///
    /// # Errors
    /// If frames cannot be drawn or written. A checkpoint that cannot be written is only a warning: a disk without room
    /// for it may have enough for the results.
    pub(super) fn save(
        &mut self,
        frames: &mut Frames<'_>,
        ahead: bool,
        folder: &Claimed,
        summary: &Summary,
    ) -> Result<(), Failure> {
        let Self { diagnostics, states, export, pictures, warned } = self;
        if let Some(pictures) = pictures {
            pictures.flush()?;
        }
        let ((manifest, whose), path) = (folder.contents(), folder.path());
        let failed = |error| OutputError::writing(path)(error);
        let mut write = || {
            let Some(progress) = frames.progress().map_err(failed)? else { return Ok(()) };
            let mut checkpoint = Checkpoint::new(summary.command.clone(), manifest, progress);
            checkpoint.extremes = summary.runs.iter().map(|run| run.extremes.clone()).collect();
            checkpoint.causes = summary.runs.iter().map(|run| run.cause.clone()).collect();
            if !ahead {
                checkpoint.rows = diagnostics.as_mut().map(DiagnosticsWriter::sync).transpose().map_err(failed)?;
                checkpoint.course = states.as_mut().map(StatesWriter::sync).transpose().map_err(failed)?;
                checkpoint.exported = export.written.clone();
            }
            checkpoint.write(path, whose)
        };
        let result: Result<(), OutputError> = write();
        if let Err(error) = &result
            && !std::mem::replace(warned, true)
        {
            note(&format!("no checkpoint is written: {}", with_causes(error)));
        }
        Ok(())
    }
}

/// When a checkpoint is due, so that checkpoints take two per cent of the time.
pub(super) struct Pace {
    next: Instant,
}

impl Pace {
    /// The least time before the first checkpoint, and between two.
    const LEAST: Duration = Duration::from_secs(2);
    /// The time between two checkpoints, in times that one takes.
    const TIMES: u32 = 50;

    /// Starts the clock.
    pub(super) fn new() -> Self {
        Self { next: Instant::now() + Self::LEAST }
    }

    /// Whether a checkpoint is due.
    pub(super) fn is_due(&self) -> bool {
        Instant::now() >= self.next
    }

    /// Makes a checkpoint by calling `save`.
    pub(super) fn take<T>(&mut self, save: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let saved = save();
        self.next = Instant::now() + Self::LEAST.max(begun.elapsed() * Self::TIMES);
        saved
    }
}
