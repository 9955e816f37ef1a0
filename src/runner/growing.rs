//! Files that grow while a scene is simulated and outlive their process, so that another one continues them.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// A growing file, with the digest of its bytes so far.
#[derive(Debug)]
pub(crate) struct Growing {
    file: File,
    length: u64,
    digest: Sha256,
}

/// The bytes of a growing file at some time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Grown {
    /// Their number.
    pub(crate) length: u64,
    /// Their SHA-256.
    digest: [u8; 32],
}

impl Growing {
    /// Continues an empty file.
    pub(crate) fn new(file: File) -> Self {
        Self { file, length: 0, digest: Sha256::new() }
    }

    /// Opens a file: a new one, or one that begins with the bytes `before` of another process. Later bytes are cut off.
    ///
    /// # Errors
    /// If it cannot be opened, or does not begin with these bytes. It is unchanged then.
    pub(crate) fn open(path: &Path, before: Option<Grown>) -> io::Result<Self> {
        let is_new = before.is_none();
        let file = File::options().read(true).write(true).create(is_new).truncate(is_new).open(path)?;
        let mut growing = Self::new(file);
        if let Some(before) = before {
            let mut reader = BufReader::new((&growing.file).take(before.length));
            loop {
                let bytes = reader.fill_buf()?;
                growing.digest.update(bytes);
                let length = bytes.len();
                if length == 0 {
                    break;
                }
                growing.length += length as u64;
                reader.consume(length);
            }
            if growing.grown() != before {
                let what = "it is damaged: its bytes are not those that were written";
                return Err(io::Error::new(ErrorKind::InvalidData, what));
            }
            growing.cut()?;
        }
        Ok(growing)
    }

    /// Appends bytes. After an error the file has some of them, and the next bytes replace these.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.length))?;
        self.file.write_all(bytes)?;
        self.digest.update(bytes);
        self.length += bytes.len() as u64;
        Ok(())
    }

    /// Reads bytes at a place.
    pub(crate) fn read_at(&mut self, place: u64, bytes: &mut [u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(place))?;
        self.file.read_exact(bytes)
    }

    /// Makes the appended bytes survive a power failure.
    pub(crate) fn sync(&self) -> io::Result<Grown> {
        self.file.sync_data()?;
        Ok(self.grown())
    }

    /// Cuts off the rest of bytes that could not be appended.
    pub(crate) fn cut(&self) -> io::Result<()> {
        self.file.set_len(self.length)
    }

    fn grown(&self) -> Grown {
        Grown { length: self.length, digest: self.digest.clone().finalize().into() }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/growing.rs"]
mod tests;
