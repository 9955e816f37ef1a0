//! Compresses and writes frames on separate threads, in parallel to drawing.

use super::{Clock, Compression, OutputError, Spent, Texts, encode_print, frame_file_name, write_whole};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

/// A frame as drawn.
#[derive(Clone, Debug)]
pub(crate) struct PixelFrame {
    /// Width and height (px).
    pub size: [u32; 2],
    /// Pixels per inch, for print.
    pub dpi: Option<f64>,
    /// Red, green and blue of each pixel, in rows from the top left, sRGB; see [`encode`].
    pub pixels: Arc<Vec<u8>>,
    /// The number of the frame.
    pub frame: u64,
    /// The text chunks of the file.
    pub texts: Texts,
}

/// Threads that compress and write frames, started as needed, up to a bound. Memory is bounded: while all threads are
/// busy, [`Self::write`] blocks.
pub(crate) struct FrameWriter {
    queue: Option<SyncSender<PixelFrame>>,
    frames: Arc<Mutex<Option<Receiver<PixelFrame>>>>,
    folder: PathBuf,
    /// Greatest number of threads.
    most: usize,
    threads: Vec<JoinHandle<FramesWritten>>,
    written: FramesWritten,
}

/// The result of one thread or of all.
#[derive(Debug, Default)]
struct FramesWritten {
    frames: usize,
    spent: Spent,
    failure: Option<OutputError>,
}

impl FrameWriter {
    /// A writer with up to `most` threads (at least one) that write to `folder`, which exists.
    pub(crate) fn new(folder: &Path, most: usize) -> Self {
        // The channel has no buffer: a frame is passed to a free thread, or `write` blocks until one is free.
        let (queue, frames) = sync_channel(0);
        let frames = Arc::new(Mutex::new(Some(frames)));
        Self {
            queue: Some(queue),
            frames,
            folder: folder.to_owned(),
            most: most.max(1),
            threads: Vec::new(),
            written: FramesWritten::default(),
        }
    }

    /// Passes one frame to a thread.
    ///
    /// # Errors
    /// If an earlier frame could not be written. Then this frame and all later ones are dropped.
    pub(crate) fn write(&mut self, frame: PixelFrame) -> Result<(), OutputError> {
        let Some(queue) = &self.queue else { return self.wait() };
        let frame = match queue.try_send(frame) {
            Ok(()) => return Ok(()),
            Err(TrySendError::Full(frame) | TrySendError::Disconnected(frame)) => frame,
        };
        // A thread costs buffers of its own, so another one starts only when none is free.
        if self.threads.len() < self.most {
            let (folder, frames) = (self.folder.clone(), Arc::clone(&self.frames));
            self.threads.push(std::thread::spawn(move || write_frames(&folder, &frames)));
        }
        if queue.send(frame).is_ok() { Ok(()) } else { self.wait() }
    }

    /// Waits until all frames so far are written.
    ///
    /// # Errors
    /// If one could not be written and [`Self::write`] did not report it.
    pub(crate) fn flush(&mut self) -> Result<(), OutputError> {
        self.wait()?;
        let (queue, frames) = sync_channel(0);
        (self.queue, self.frames) = (Some(queue), Arc::new(Mutex::new(Some(frames))));
        Ok(())
    }

    /// Waits until all frames are written. Returns their number and the time spent, summed over threads.
    ///
    /// # Errors
    /// If one could not be written and [`Self::write`] did not report it.
    pub(crate) fn finish(&mut self) -> (usize, Spent, Result<(), OutputError>) {
        let result = self.wait();
        (self.written.frames, self.written.spent, result)
    }

    fn wait(&mut self) -> Result<(), OutputError> {
        self.queue = None;
        let all = &mut self.written;
        for thread in self.threads.drain(..) {
            let one = thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            all.frames += one.frames;
            all.spent += one.spent;
            all.failure = all.failure.take().or(one.failure);
        }
        all.failure.take().map_or(Ok(()), Err)
    }
}

/// Writes frames until there are no more or one fails. After a failure the channel is closed, so that no sender blocks.
fn write_frames(folder: &Path, queue: &Mutex<Option<Receiver<PixelFrame>>>) -> FramesWritten {
    let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let mut written = FramesWritten::default();
    loop {
        let Some(frame) = lock().as_ref().and_then(|frames| frames.recv().ok()) else { return written };
        let clock = Clock::thread();
        let PixelFrame { size, dpi, pixels, frame, texts } = frame;
        let bytes = encode_print(size, &pixels, &texts, Compression::Fast, dpi);
        let result = write_whole(&folder.join(frame_file_name(frame)), &bytes);
        written.spent += clock.spent();
        match result {
            Ok(()) => written.frames += 1,
            Err(failure) => {
                written.failure = Some(failure);
                *lock() = None;
                return written;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(index: u64) -> PixelFrame {
        PixelFrame { size: [2, 1], dpi: None, pixels: Arc::new(vec![0; 6]), frame: index, texts: Vec::new() }
    }

    #[test]
    fn all_frames_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = FrameWriter::new(folder.path(), 3);
        (0..20).for_each(|index| writer.write(frame(index)).unwrap());
        let (count, spent, result) = writer.finish();
        result.unwrap();
        assert_eq!(count, 20);
        assert!(spent.wall > 0.0);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 20);
    }

    #[test]
    fn a_failure_is_told_and_nobody_waits() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = FrameWriter::new(&folder.path().join("absent"), 2);
        let failure = (0..100).find_map(|index| writer.write(frame(index)).err()).expect("it fails before the end");
        assert!(failure.to_string().contains("frame_"));
        let (count, _, result) = writer.finish();
        assert_eq!(count, 0);
        result.expect("told once");
    }
}
