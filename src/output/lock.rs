//! Locks of output folders. The system releases them when their process ends for any reason, and they leave no file.
//!
//! The folder itself is locked. Processes on other machines that share it do not see the lock.

use super::OutputError;
use std::fs::{File, TryLockError};
use std::path::Path;
use std::time::{Duration, Instant};

/// How long another process may hold a lock without writing to the folder: to remove leftovers, which takes
/// milliseconds, or between being killed and ending.
const MOMENT: Duration = Duration::from_secs(1);

/// A folder to which this process writes, locked until this is dropped. Where the system cannot lock folders, there is
/// no protection.
#[derive(Debug)]
pub(crate) struct FolderLock {
    /// The open folder, which holds the lock.
    folder: Option<File>,
}

impl FolderLock {
    /// Locks an existing folder for exclusive use. Leftovers of killed processes stay, since one may be a checkpoint to
    /// continue from.
    ///
    /// # Errors
    /// If another process writes to it.
    pub(super) fn alone(path: &Path) -> Result<Self, OutputError> {
        Self::held(path, true)
    }

    /// Locks a folder, which need not exist, for adding files together with other processes.
    ///
    /// # Errors
    /// If a process has locked it for exclusive use.
    pub(super) fn shared(path: &Path) -> Result<Self, OutputError> {
        Self::held(path, false)
    }

    fn held(path: &Path, alone: bool) -> Result<Self, OutputError> {
        let lock = Self::open(path);
        if lock.take(alone) { Ok(lock) } else { Err(OutputError::InUse { path: path.to_owned() }) }
    }

    /// Locks an existing folder for writing single files beside those of other processes. Leftovers are kept, as they
    /// may belong to other processes.
    pub(crate) fn beside_others(path: &Path) -> Self {
        let lock = Self::open(path);
        // A process that keeps an exclusive lock for longer has removed its leftovers: there is no need to wait for it.
        let _ = lock.take(false);
        lock
    }

    fn open(path: &Path) -> Self {
        // Opening a pipe would block. Some systems cannot open folders.
        Self { folder: if path.is_dir() { File::open(path).ok() } else { None } }
    }

    /// Takes the lock, exclusive or shared; `false` if another process holds it for longer than a moment.
    fn take(&self, alone: bool) -> bool {
        let lock = if alone { File::try_lock } else { File::try_lock_shared };
        let Some(folder) = &self.folder else { return true };
        let started = Instant::now();
        while matches!(lock(folder), Err(TryLockError::WouldBlock)) {
            if started.elapsed() > MOMENT {
                return false;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        true
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
        assert!(FolderLock::shared(path).is_err());
        drop(alone);
        let several = [FolderLock::beside_others(path), FolderLock::beside_others(path)];
        assert!(FolderLock::alone(path).is_err());
        drop(FolderLock::shared(path).unwrap());
        drop(several);
        FolderLock::alone(path).unwrap();
        drop(FolderLock::shared(&path.join("absent")).unwrap());
    }

    #[test]
    fn work_of_others_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let leftover = folder.path().join(".localshape-abc123.partial");
        std::fs::write(&leftover, "").unwrap();
        drop(FolderLock::beside_others(folder.path()));
        assert!(leftover.exists());
    }

    /// Otherwise another process could remove its files as leftovers.
    #[test]
    fn nobody_is_left_without_a_lock_who_comes_while_another_tidies_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let tidying = FolderLock::alone(path).unwrap();
        std::thread::scope(|scope| {
            let beside = scope.spawn(|| FolderLock::beside_others(path));
            std::thread::sleep(MOMENT / 10);
            drop(tidying);
            let _beside = beside.join().unwrap();
            assert!(matches!(FolderLock::alone(path), Err(OutputError::InUse { .. })));
        });
    }
}
