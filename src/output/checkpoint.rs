//! Checkpoints: the exact states of a simulation, from which another process continues after an interruption.
//!
//! A checkpoint is a hidden file beside the results, replaced as a whole. Results that grow with the frames, such as
//! `diagnostics.csv`, have hidden files of their own. The checkpoint stores how long they were when it was written.

use super::atomic::{remove, sync_folder};
use super::states::CourseSoFar;
use super::{Extremes, OutputError, Whose, read_file, write_whole};
use crate::runner::Progress;
use crate::runner::cause::Cause;
use crate::runner::growing::Grown;
use crate::scene::Origin;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// The name of the file in its folder. A command that does not continue from it removes it as a leftover.
const CHECKPOINT_FILE: &str = ".localshape-checkpoint.partial";

/// The first bytes of the file; a digest of the rest follows.
const MARK: &[u8] = b"localshape checkpoint\n";
/// The beginning of the marks of earlier builds, which had a number after it.
const ANY_MARK: &[u8] = b"localshape checkpoint";

/// The output of a command in the folder of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Manifest {
    /// Names of the recorded states of the runs, in the scene's order.
    pub runs: Vec<String>,
    /// Numbers of the frames, rising.
    pub frames: Vec<u64>,
    /// Whether states are written.
    pub states: bool,
    /// Patterns of the files for other programs, below the folder.
    pub files: Vec<String>,
    /// The pictures, if frames are drawn.
    pub pictures: Option<FramePictures>,
}

/// The pictures of frames. All in a folder have the same size and runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct FramePictures {
    /// Width and height (px).
    pub size: [u32; 2],
    /// Whether they are kept after the command.
    pub are_kept: bool,
}

impl Manifest {
    /// Width and height of the frames in the folder (px), if frames are drawn and kept.
    pub(crate) fn kept_size(&self) -> Option<[u32; 2]> {
        self.pictures.filter(|drawn| drawn.are_kept).map(|drawn| drawn.size)
    }
}

/// The progress of a command.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// The command line.
    pub(crate) command: Vec<String>,
    /// Digest of the manifest.
    manifest: [u8; 32],
    /// The simulation.
    pub(crate) progress: Progress,
    /// The known cause of the divergence of each run.
    pub(crate) causes: Vec<Option<Cause>>,
    /// The least and the greatest values of each run in frames.
    pub(crate) extremes: Vec<Extremes>,
    /// The rows of the frames written so far; `None` if no frame is written before the end of the simulation.
    pub(crate) rows: Option<Grown>,
    /// The states written so far, if states are written.
    pub(crate) course: Option<(CourseSoFar, Grown)>,
    /// Checksums of the files for other programs of the frames written so far.
    pub(crate) exported: Vec<u64>,
}

impl Checkpoint {
    /// The checkpoint of a command with a manifest.
    pub(crate) fn new(command: Vec<String>, manifest: &Manifest, progress: Progress) -> Self {
        Self { command, manifest: digest(manifest), progress, ..Self::default() }
    }

    /// Writes the checkpoint into a folder, replacing an earlier one. The files that it refers to must be on the disk.
    ///
    /// # Errors
    /// If it cannot be written; an earlier one is then unchanged.
    pub(crate) fn write(&self, folder: &Path, whose: &Whose) -> Result<(), OutputError> {
        let origin = Origin::new(&whose.digest, &whose.title);
        let mut rest = postcard::to_allocvec(&origin).expect("plain data");
        rest.extend(postcard::to_allocvec(self).expect("plain data"));
        // The names of frames and of hidden files must be on the disk before the checkpoint is.
        [folder, &passing_frames(folder)].into_iter().for_each(sync_folder);
        write_whole(&folder.join(CHECKPOINT_FILE), &[MARK, &Sha256::digest(&rest), &rest].concat())
    }

    /// Reads the checkpoint in a folder, if there is one.
    ///
    /// # Errors
    /// If it cannot be read, is damaged, or belongs to another version, scene or command.
    pub(super) fn read(folder: &Path, whose: &Whose, manifest: &Manifest) -> Result<Option<Self>, OutputError> {
        let path = folder.join(CHECKPOINT_FILE);
        let Some(bytes) = read_file(&path)? else { return Ok(None) };
        let found = Self::parse(&bytes, whose, manifest);
        found.map(Some).map_err(|what| OutputError::Checkpoint { path: folder.to_owned(), what: what.into() })
    }

    fn parse(bytes: &[u8], whose: &Whose, manifest: &Manifest) -> Result<Self, String> {
        let damaged = || format!("is damaged or cut short ({CHECKPOINT_FILE})");
        if bytes.starts_with(ANY_MARK) && bytes.len() > MARK.len() && !bytes.starts_with(MARK) {
            return Err("was written by another build of localshape".to_owned());
        }
        let (digest_found, rest) =
            bytes.strip_prefix(MARK).and_then(|rest| rest.split_at_checked(32)).ok_or_else(damaged)?;
        if Sha256::digest(rest)[..] != *digest_found {
            return Err(damaged());
        }
        let (origin, rest): (Origin, _) = postcard::take_from_bytes(rest).map_err(|_| damaged())?;
        if let Some(why) = origin.refusal(&whose.digest, &whose.title) {
            return Err(why);
        }
        let found: Self = postcard::from_bytes(rest).map_err(|_| damaged())?;
        if found.manifest != digest(manifest) {
            return Err(format!(
                "belongs to a command with other frames, runs, states, files or size; to go on from it, type that command with --resume: {}",
                super::shell::line(&found.command)
            ));
        }
        Ok(found)
    }

    /// Removes the checkpoint of a finished command from a folder.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub(crate) fn remove(folder: &Path) -> Result<(), OutputError> {
        remove(&folder.join(CHECKPOINT_FILE))
    }

    /// Whether a folder has a checkpoint.
    pub(crate) fn is_in(folder: &Path) -> bool {
        folder.join(CHECKPOINT_FILE).is_file()
    }
}

/// The path of the hidden folder in a folder with drawn frames that are not kept after the command.
pub(crate) fn passing_frames(folder: &Path) -> PathBuf {
    folder.join(".localshape-pictures.partial")
}

/// The path of the hidden file in a folder whose states wait to be drawn.
pub(crate) fn waiting_states(folder: &Path) -> PathBuf {
    folder.join(".localshape-frames.partial")
}

fn digest(manifest: &Manifest) -> [u8; 32] {
    Sha256::digest(postcard::to_allocvec(manifest).expect("plain data")).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whose() -> Whose {
        Whose { digest: "ab".repeat(32), title: "Cubes".to_owned(), file: None }
    }

    fn manifest() -> Manifest {
        let (runs, frames) = (vec!["one".to_owned()], vec![0, 1, 2]);
        Manifest { runs, frames, states: false, files: Vec::new(), pictures: None }
    }

    #[test]
    fn it_comes_back_and_is_refused_when_cut_short_or_changed() {
        let folder = tempfile::tempdir().unwrap();
        let read = || Checkpoint::read(folder.path(), &whose(), &manifest());
        assert!(read().unwrap().is_none());
        let words = vec!["localshape".to_owned(), "render".to_owned()];
        Checkpoint::new(words.clone(), &manifest(), Progress::default()).write(folder.path(), &whose()).unwrap();
        assert_eq!(read().unwrap().expect("a checkpoint").command, words);
        let path = folder.path().join(CHECKPOINT_FILE);
        let bytes = std::fs::read(&path).unwrap();
        for cut in 0..bytes.len() {
            assert!(Checkpoint::parse(&bytes[..cut], &whose(), &manifest()).unwrap_err().contains("damaged"), "{cut}");
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1;
            let words = if at == ANY_MARK.len() { "another build of localshape" } else { "damaged" };
            assert!(Checkpoint::parse(&changed, &whose(), &manifest()).unwrap_err().contains(words), "{at}");
        }
        let other = Manifest { frames: vec![0, 1], ..manifest() };
        let what = Checkpoint::parse(&bytes, &whose(), &other).unwrap_err();
        assert!(
            what.starts_with("belongs to a command with other frames, runs, states, files or size; to go on"),
            "{what}"
        );
        assert!(what.ends_with("with --resume: localshape render"), "{what}");
        Checkpoint::remove(folder.path()).unwrap();
        assert!(!Checkpoint::is_in(folder.path()));
    }

    #[test]
    fn one_of_another_version_or_scene_is_refused() {
        let origin = |whose: &Whose| Origin::new(&whose.digest, &whose.title);
        let of = |origin: Origin| {
            let rest = postcard::to_allocvec(&origin).unwrap();
            Checkpoint::parse(&[MARK, &Sha256::digest(&rest), &rest].concat(), &whose(), &manifest()).unwrap_err()
        };
        let mut older = origin(&whose());
        "0.0.1".clone_into(&mut older.version);
        assert!(of(older).starts_with("was written by localshape 0.0.1, and this is "));
        let edited = Whose { digest: "cd".repeat(32), ..whose() };
        assert_eq!(of(origin(&edited)), "belongs to another version of “Cubes”; expected “Cubes” as it is now");
        let other = Whose { title: "Springs".to_owned(), ..edited };
        assert_eq!(of(origin(&other)), "belongs to another scene, “Springs”; expected “Cubes” as it is now");
        assert_eq!(of(origin(&whose())), format!("is damaged or cut short ({CHECKPOINT_FILE})"), "nothing follows");
    }
}
