//! The array of an archive that only this program reads: the scene that its states come from, its frames, and how its runs
//! ended.

use super::flaw::Flaw;
use crate::scene::npz::Npz;
use crate::sim::Divergence;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The name of the array.
pub(crate) const COURSE: &str = "localshape";
/// The version of this crate, with a number for what it keeps for itself in archives and checkpoints: it rises with each change of that.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (format 2)");
/// The remedy for an archive without the states of a scene.
const AGAIN: &str = "simulate the scene again with --states";

/// The program and the scene that results come from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Origin {
    /// The version that wrote it. Other versions may read what follows differently.
    pub(crate) version: String,
    /// Digest of the scene.
    digest: String,
    title: String,
}

impl Origin {
    /// The origin of the results of a scene with a digest and a title in this program.
    pub(crate) fn new(digest: &str, title: &str) -> Self {
        Self { version: VERSION.to_owned(), digest: digest.to_owned(), title: title.to_owned() }
    }

    /// Why results of this origin cannot be used for a scene, in words; `None` if they can.
    pub(crate) fn refusal(&self, digest: &str, title: &str) -> Option<String> {
        if self.version != VERSION {
            let build = if self.version.starts_with(env!("CARGO_PKG_VERSION")) { "another build of " } else { "" };
            return Some(format!("was written by {build}localshape {}, and this is {VERSION}", self.version));
        }
        let found = &self.title;
        let other = if found == title { "another version of" } else { "another scene," };
        (self.digest != digest || digest.is_empty())
            .then(|| format!("belongs to {other} “{found}”; expected “{title}” as it is now"))
    }
}

/// The frames of an archive and the ends of its runs. The time series of the scene follow it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Course {
    /// Numbers of the frames, rising.
    pub(crate) frames: Vec<u64>,
    /// The runs, in the scene's order.
    pub(crate) runs: Vec<StoredRun>,
}

/// One run of a [`Course`].
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct StoredRun {
    pub(crate) name: String,
    /// The divergence of the run, if it diverged.
    pub(crate) divergence: Option<Divergence>,
    /// The drawn state of a run that diverges, if a frame shows it, as bytes.
    pub(crate) last_fit: Option<Vec<u8>>,
    /// The SHA-256 of positions, velocities and memory in each frame. Single frames are read, and the archive's own
    /// checksums cover all frames.
    pub(crate) digests: [Vec<[u8; 32]>; 3],
}

impl StoredRun {
    /// A run without frames.
    pub(crate) fn new(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }
}

impl Course {
    /// Whether the course can be continued with these runs.
    pub(crate) fn fits(&self, runs: &[StoredRun]) -> bool {
        let is_whole = |run: &StoredRun| run.digests.iter().all(|digests| digests.len() == self.frames.len());
        self.runs.iter().map(|run| &run.name).eq(runs.iter().map(|run| &run.name)) && self.runs.iter().all(is_whole)
    }

    /// The course in an archive, its origin, and the bytes after it.
    ///
    /// # Errors
    /// There is none, or it is damaged.
    pub(super) fn read(npz: &mut Npz) -> Result<(Origin, Self, Vec<u8>), Flaw> {
        let flaw = |message: String| Flaw::new(COURSE, message).with_help(AGAIN);
        let missing = || Flaw::new("", format!("has no array `{COURSE}`, which `localshape simulate --states` writes"));
        let array = npz.array(COURSE).ok_or_else(|| missing().with_help(AGAIN))?.map_err(flaw)?;
        // Packed data could unfold to any size, and this program packs nothing.
        if !npz.has_room_for(&array) {
            return Err(flaw("is packed, or longer than the file".to_owned()));
        }
        let values = npz.values(&array).map_err(flaw)?;
        let damaged = |_| flaw("was not written by this program".to_owned());
        let (origin, rest): (Origin, _) = postcard::take_from_bytes(&values.bytes).map_err(damaged)?;
        if origin.version != VERSION {
            return Ok((origin, Self::default(), Vec::new()));
        }
        let (course, rest): (Self, _) = postcard::take_from_bytes(rest).map_err(damaged)?;
        let rest = rest.to_vec();
        if !course.fits(&course.runs) || !course.frames.is_sorted() {
            return Err(flaw("does not fit its frames".to_owned()));
        }
        Ok((origin, course, rest))
    }

    /// The course in a file with the states of a scene, which has a digest and a title, and the bytes of its time series.
    ///
    /// # Errors
    /// The file cannot be read, or has other states.
    pub(crate) fn of_scene(path: &Path, digest: &str, title: &str) -> Result<(Self, Vec<u8>), Flaw> {
        let mut npz = Npz::open(path).map_err(|message| Flaw::new("", message))?;
        let (origin, course, rest) = Self::read(&mut npz)?;
        match origin.refusal(digest, title) {
            Some(why) => Err(Flaw::new("", why).with_help(AGAIN)),
            None => Ok((course, rest)),
        }
    }

    /// Refuses frames that the course does not have.
    pub(crate) fn check_frames(&self, frames: &[u64]) -> Result<(), Flaw> {
        let Some(missing) = frames.iter().find(|frame| self.frames.binary_search(frame).is_err()) else {
            return Ok(());
        };
        let there = match self.frames[..] {
            [] => "no frame".to_owned(),
            [frame] => format!("frame {frame} only"),
            [first, .., last] => format!("{} frames from {first} to {last}", self.frames.len()),
        };
        let help = "choose among them with --frames, or simulate all with --states";
        Err(Flaw::new("", format!("lacks frame {missing}: it has {there}")).with_help(help))
    }
}
