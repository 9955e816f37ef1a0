//! Who writes in a folder: locks that the system frees when their holder ends, however it ends, and that leave no file.
//!
//! The folder itself is locked. Programs on other machines that share it do not see that.

use super::atomic::remove_leftovers;
use super::{OutputError, SUMMARY_FILE};
use std::fs::{self, File};
use std::path::Path;

/// A folder that this program writes in, locked until this is dropped. Where folders cannot be locked, nobody is
/// kept out.
#[derive(Debug)]
pub struct FolderLock {
    /// The open folder, which holds the lock.
    folder: Option<File>,
}

impl FolderLock {
    /// Locks a folder, which exists, for one who alone writes in it. What killed programs have left unfinished in it
    /// goes.
    ///
    /// # Errors
    /// If somebody else writes in it, or it cannot be written to.
    pub fn alone(path: &Path) -> Result<Self, OutputError> {
        let lock = Self::open(path);
        if !lock.take(true) {
            return Err(in_use(path));
        }
        remove_leftovers(path)?;
        Ok(lock)
    }

    /// Locks a folder, which exists, for one who writes files of its own in it beside those of others. While nobody else
    /// writes in it, what killed programs have left unfinished in it goes, if it can.
    pub fn beside_others(path: &Path) -> Self {
        let lock = Self::open(path);
        if lock.take(true) {
            let _ = remove_leftovers(path);
        }
        // Not to be had where somebody writes alone, who has tidied up already.
        lock.take(false);
        lock
    }

    /// Looks whether somebody alone writes in a folder, which need not exist.
    ///
    /// # Errors
    /// If somebody does.
    pub fn look(path: &Path) -> Result<(), OutputError> {
        if Self::open(path).take(false) { Ok(()) } else { Err(in_use(path)) }
    }

    fn open(path: &Path) -> Self {
        Self { folder: File::open(path).ok() }
    }

    /// Takes the lock for one alone or beside others; `false` if somebody else keeps it.
    #[cfg(unix)]
    fn take(&self, alone: bool) -> bool {
        use rustix::fs::{FlockOperation, flock};
        use rustix::io::Errno;
        let how = if alone { FlockOperation::NonBlockingLockExclusive } else { FlockOperation::NonBlockingLockShared };
        self.folder.as_ref().is_none_or(|folder| flock(folder, how) != Err(Errno::WOULDBLOCK))
    }

    /// Folders cannot be locked there.
    #[cfg(not(unix))]
    fn take(&self, alone: bool) -> bool {
        let _ = (&self.folder, alone);
        true
    }
}

/// What is said of a folder that somebody else writes in.
fn in_use(path: &Path) -> OutputError {
    let process = holder(path).map_or("another process".to_owned(), |id| format!("process {id}"));
    let title = fs::read(path.join(SUMMARY_FILE)).ok().and_then(|bytes| {
        let summary: serde_json::Value = serde_json::from_slice(&bytes).ok()?;
        let title = summary["scene"]["title"].as_str()?;
        (summary["outcome"] == "unfinished").then(|| format!(" “{title}”"))
    });
    let what = format!("{process} is writing{} there", title.unwrap_or_default());
    OutputError::InUse { path: path.to_owned(), what: what.into() }
}

/// The process that has locked a folder, where the system tells.
fn holder(path: &Path) -> Option<u32> {
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::fs::MetadataExt;
        let inode = fs::metadata(path).ok()?.ino().to_string();
        // Such as `1: FLOCK  ADVISORY  WRITE 16548 fe:00:5309211 0 EOF`.
        let locks = fs::read_to_string("/proc/locks").ok()?;
        locks.lines().find_map(|line| {
            let words: Vec<_> = line.split_whitespace().collect();
            let is_it = *words.get(1)? == "FLOCK" && words.get(5)?.rsplit(':').next() == Some(inode.as_str());
            is_it.then(|| words[4].parse().ok())?
        })
    }
    #[cfg(not(target_os = "linux"))]
    {
        let _ = path;
        None
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn one_alone_or_several_beside_each_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let alone = FolderLock::alone(path).unwrap();
        assert!(matches!(FolderLock::alone(path), Err(OutputError::InUse { .. })));
        assert!(FolderLock::look(path).is_err());
        drop(alone);
        let several = [FolderLock::beside_others(path), FolderLock::beside_others(path)];
        assert!(FolderLock::alone(path).is_err());
        FolderLock::look(path).unwrap();
        drop(several);
        FolderLock::alone(path).unwrap();
        FolderLock::look(&path.join("absent")).unwrap();
    }

    #[test]
    fn work_of_others_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let leftover = folder.path().join(".localshape-abc123.partial");
        for is_alone in [true, false] {
            let path = folder.path();
            let _lock = if is_alone { FolderLock::alone(path).unwrap() } else { FolderLock::beside_others(path) };
            fs::write(&leftover, "").unwrap();
            FolderLock::beside_others(path);
            assert!(leftover.exists());
        }
        FolderLock::beside_others(folder.path());
        assert!(!leftover.exists());
    }
}
