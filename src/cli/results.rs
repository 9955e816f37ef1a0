//! What becomes of frames, and the checkpoints from which an interrupted command goes on.

use super::failure::{Failure, note, with_causes};
use super::record::Pictures;
use crate::output::{Checkpoint, Claimed, DiagnosticsWriter, OutputError, StatesWriter};
use crate::runner::{Frames, Next};
use std::time::{Duration, Instant};

/// The results of one scene, frame by frame.
pub(super) struct Results<'a> {
    pub(super) diagnostics: DiagnosticsWriter,
    pub(super) states: Option<StatesWriter>,
    pub(super) pictures: Option<Box<dyn Pictures + 'a>>,
    /// Whether the user was told that no checkpoint can be written, or wants no warnings.
    pub(super) warned: bool,
}

impl Results<'_> {
    /// Takes what comes next of the frames.
    pub(super) fn take(&mut self, next: &Next, frames: &Frames<'_>) -> Result<(), Failure> {
        let Self { diagnostics, states, pictures, .. } = self;
        match next {
            Next::TimeSeries(history) => {
                pictures.iter_mut().for_each(|pictures| pictures.take_history(history));
                states.iter_mut().for_each(|states| states.set_history(history));
                Ok(())
            }
            Next::Frame(frame) => {
                diagnostics.write(frame)?;
                if let Some(states) = states {
                    states.write(frame, frames.states())?;
                }
                pictures.as_deref_mut().map_or(Ok(()), |pictures| pictures.draw(frame))
            }
            Next::Working | Next::Done => Ok(()),
        }
    }

    /// Writes a checkpoint, if anything is left to simulate, by the command of these words. With `ahead` all is simulated
    /// before the first frame.
    ///
    /// # Errors
    /// If frames cannot be drawn or written. A checkpoint that cannot be written is only warned of: a disk without room
    /// for it may have enough for the results.
    pub(super) fn save(
        &mut self,
        frames: &mut Frames<'_>,
        ahead: bool,
        folder: &Claimed,
        words: &[String],
    ) -> Result<(), Failure> {
        let Self { diagnostics, states, pictures, warned } = self;
        if let Some(pictures) = pictures {
            pictures.flush()?;
        }
        let ((plan, whose), path) = (folder.contents(), folder.path());
        let failed = |error| OutputError::writing(path)(error);
        let mut write = || {
            let Some(progress) = frames.progress().map_err(failed)? else { return Ok(()) };
            let mut checkpoint = Checkpoint::new(words.to_vec(), plan, progress);
            if !ahead {
                checkpoint.rows = Some(diagnostics.sync().map_err(failed)?);
                checkpoint.course = states.as_mut().map(StatesWriter::sync).transpose().map_err(failed)?;
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

/// When a checkpoint is due: as often as costs two per cent of the time.
pub(super) struct Pace {
    next: Instant,
}

impl Pace {
    /// From the start to the first checkpoint, and between two at least.
    const LEAST: Duration = Duration::from_secs(2);
    /// The time between two, in times that one takes.
    const TIMES: u32 = 50;

    /// From now on.
    pub(super) fn new() -> Self {
        Self { next: Instant::now() + Self::LEAST }
    }

    /// Whether it is time.
    pub(super) fn is_due(&self) -> bool {
        Instant::now() >= self.next
    }

    /// Takes one by calling `save`.
    pub(super) fn take<T>(&mut self, save: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let saved = save();
        self.next = Instant::now() + Self::LEAST.max(begun.elapsed() * Self::TIMES);
        saved
    }
}
