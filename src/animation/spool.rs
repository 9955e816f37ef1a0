//! Frames that are still being rendered, as the [`Reel`] of an animation that is written at the same time.

use super::{AnimationError, Image, Reel};
use crate::golden::{PictureError, Pixels};
use crate::output::OutputError;
use std::collections::HashMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Compressed frames in an unnamed temporary file. Reading a frame that does not exist yet blocks until it does.
#[derive(Debug)]
pub(crate) struct Spool {
    size: [u32; 2],
    /// The folder of the file, for messages.
    folder: PathBuf,
    kept: Mutex<Kept>,
    changed: Condvar,
}

#[derive(Debug)]
struct Kept {
    file: File,
    /// Offset and length of each frame in the file (bytes).
    places: HashMap<usize, (u64, usize)>,
    end: u64,
    ended: bool,
}

impl Spool {
    /// For frames of a width and height (px), stored in an existing folder.
    pub(crate) fn new(folder: &Path, size: [u32; 2]) -> Result<Self, OutputError> {
        let file = tempfile::tempfile_in(folder).map_err(OutputError::writing(folder))?;
        let kept = Kept { file, places: HashMap::new(), end: 0, ended: false };
        Ok(Self { size, folder: folder.to_owned(), kept: Mutex::new(kept), changed: Condvar::new() })
    }

    /// Stores a frame, which is a PNG file.
    pub(crate) fn put(&self, frame: usize, picture: &[u8]) -> Result<(), OutputError> {
        let mut kept = self.lock();
        let end = kept.end;
        let written = kept.file.seek(SeekFrom::Start(end)).and_then(|_| kept.file.write_all(picture));
        written.map_err(OutputError::writing(&self.folder))?;
        kept.places.insert(frame, (end, picture.len()));
        kept.end += picture.len() as u64;
        self.changed.notify_all();
        Ok(())
    }

    /// Ends the sequence: readers of frames that do not exist get an error.
    pub(crate) fn end(&self) {
        self.lock().ended = true;
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Reel for Spool {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn image(&self, frame: usize) -> Result<Image, AnimationError> {
        let mut kept = self.lock();
        let (start, length) = loop {
            match kept.places.get(&frame) {
                Some(place) => break *place,
                None if kept.ended => return Err(AnimationError::Stopped),
                None => kept = self.changed.wait(kept).unwrap_or_else(PoisonError::into_inner),
            }
        };
        let mut picture = vec![0; length];
        let read = kept.file.seek(SeekFrom::Start(start)).and_then(|_| kept.file.read_exact(&mut picture));
        drop(kept);
        let failed = |source| AnimationError::Picture { path: self.folder.clone(), source };
        read.map_err(PictureError::from).map_err(failed)?;
        Pixels::from_bytes(&picture).map(Image::from).map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::{Compression, encode};

    #[test]
    fn frames_are_waited_for_until_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let spool = Spool::new(folder.path(), [2, 1]).unwrap();
        let picture = |byte: u8| encode([2, 1], &[byte; 6], &[], Compression::Fast);
        std::thread::scope(|scope| {
            let asked = scope.spawn(|| spool.image(1));
            spool.put(0, &picture(10)).unwrap();
            spool.put(1, &picture(11)).unwrap();
            assert_eq!(asked.join().unwrap().unwrap().pixels, [11; 6]);
            let asked = scope.spawn(|| spool.image(2));
            spool.end();
            assert!(matches!(asked.join().unwrap(), Err(AnimationError::Stopped)));
        });
        assert_eq!(spool.image(0).unwrap().pixels, [10; 6]);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
