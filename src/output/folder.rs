//! Ownership of output folders: a folder belongs to one scene, and files of other programs are never removed.

use super::atomic::{remove, remove_leftovers};
use super::checkpoint::{Checkpoint, Manifest};
use super::error::kind_of;
use super::export;
use super::frame_name::frame_number;
use super::{
    DIAGNOSTICS_FILE, FolderLock, OutputError, STATES_FILE, SUMMARY_FILE, Summary, Whose, is_folder, read_file,
    read_tags,
};
use crate::reading::beside::{entries, name_of};
use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// How a command uses its folder.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Access {
    /// Replaces every file with the name of an output file.
    pub overwrite: bool,
    /// Replaces the results of other versions of the scene's file.
    pub follows: bool,
    /// Continues from a checkpoint in the folder.
    pub resume: bool,
    /// Only adds the frames of a shard, while other processes may add theirs.
    pub shard: bool,
}

/// A folder for the output of one scene, inspected but not yet changed.
#[derive(Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    scene: Whose,
    manifest: Manifest,
    access: Access,
    /// The results that are replaced without `--overwrite`, in words.
    replaced: Option<String>,
}

impl Folder {
    /// Inspects a folder, which need not exist, before it is used for a scene.
    ///
    /// Unless `access` permits their replacement, the folder is refused if it has results of another scene, frames of
    /// this scene in another size or with other runs, or other files with the names of output files. It is always
    /// refused if another process writes to it, or if a folder or the like has the name of an output file.
    ///
    /// # Errors
    /// If the folder cannot be read, is refused or is not a folder.
    pub(crate) fn inspect(path: &Path, scene: Whose, manifest: Manifest, access: Access) -> Result<Self, OutputError> {
        let mut folder = Self { path: path.to_owned(), scene, manifest, access, replaced: None };
        if is_folder(path)? {
            drop(FolderLock::shared(path)?);
            if access.resume {
                Checkpoint::read(path, &folder.scene, &folder.manifest)?;
            }
            folder.replaced = folder.find()?.hindrance.filter(|_| !access.overwrite);
        }
        Ok(folder)
    }

    /// The results in the folder, if they do not prevent its use.
    fn find(&self) -> Result<Found, OutputError> {
        let owner = Owner::read(&self.path, &self.scene)?;
        let owner = owner.as_ref();
        let found = self.others(owner)?;
        let Access { overwrite, follows, resume, shard } = self.access;
        let greatest = found.iter().map(|(kind, _)| kind).max();
        let mut hindrance = greatest.map(|kind| self.words(owner, kind, &found));
        if hindrance.is_none() && !resume && !shard && Checkpoint::is_in(&self.path) {
            hindrance = Some("the checkpoint of an interrupted command, from which --resume goes on".to_owned());
        }
        let is_other_version = greatest.is_none_or(|kind| *kind == Kind::Version);
        if let Some(what) = hindrance.clone().filter(|_| shard || !(overwrite || follows && is_other_version)) {
            return Err(OutputError::Occupied { path: self.path.clone(), what });
        }
        let stale = found.into_iter().filter(|(kind, _)| *kind != Kind::Foreign).map(|(_, file)| file);
        let mut stale: Vec<_> = stale.collect();
        stale.sort_by_key(|path| path.ends_with(SUMMARY_FILE));
        Ok(Found { stale, hindrance, has_summary: owner.is_some_and(|owner| owner.kind.is_none()) })
    }

    /// The files in the folder with names of output files that are not this scene's.
    fn others(&self, owner: Option<&Owner>) -> Result<Vec<(Kind, PathBuf)>, OutputError> {
        let mut found = Vec::new();
        for path in entries(&self.path).map_err(OutputError::reading(&self.path))? {
            let name = name_of(&path);
            let is_record = [SUMMARY_FILE, DIAGNOSTICS_FILE, STATES_FILE].contains(&name.as_str());
            if is_record || frame_number(&name).is_some() {
                found.extend(self.kind_of(owner, &path, is_record)?.map(|kind| (kind, path)));
            }
        }
        let earlier = owner.map(|_| export::patterns_in(&self.path)).unwrap_or_default();
        let own = &self.manifest.files;
        let earlier = earlier.iter().filter(|pattern| !own.contains(pattern));
        for (pattern, is_own) in own.iter().map(|one| (one, true)).chain(earlier.map(|one| (one, false))) {
            for file in export::matching(&self.path, pattern) {
                let foreign = is_own.then_some(Kind::Foreign);
                let kind = export::scene_of(&file)?.map_or(foreign, |digest| self.kind(owner, &digest));
                found.extend(kind.map(|kind| (kind, file)));
            }
        }
        Ok(found)
    }

    /// The kind of results with this digest; `None` if they are this scene's.
    fn kind(&self, owner: Option<&Owner>, digest: &str) -> Option<Kind> {
        match owner {
            Some(owner) if owner.digest == digest => owner.kind.clone(),
            _ => (!self.scene.owns(digest)).then_some(Kind::Other),
        }
    }

    /// The kind of a table or summary, or of a frame; `None` if it is this scene's and may stay.
    fn kind_of(&self, owner: Option<&Owner>, path: &Path, is_record: bool) -> Result<Option<Kind>, OutputError> {
        match fs::metadata(path) {
            Ok(kind) if !kind.is_file() => {
                return Err(OutputError::NoFile { path: path.to_owned(), what: kind_of(&kind) });
            }
            Ok(_) => {}
            // A dangling link can be replaced like a file.
            Err(_) if path.is_symlink() => return Ok(Some(Kind::Foreign)),
            Err(error) => return Err(OutputError::reading(path)(error)),
        }
        if is_record {
            return Ok(owner.map_or(Some(Kind::Foreign), |owner| owner.kind.clone()));
        }
        let Some((size, tags)) = read_tags(path)?.filter(|(_, tags)| tags.frame().is_some()) else {
            return Ok(Some(Kind::Foreign));
        };
        let kind = tags.scenes.first().map_or(Some(Kind::Foreign), |digest| self.kind(owner, digest));
        let runs = tags.states.iter().map(|(_, run)| run);
        let own = self.manifest.kept_size().filter(|_| kind.is_none());
        Ok(match own.filter(|own| *own != size || !runs.clone().eq(&self.manifest.runs)) {
            Some(_) => {
                let runs: Vec<_> = runs.map(|run| format!("“{run}”")).collect();
                Some(Kind::Unlike(format!("{}×{} pixels with {}", size[0], size[1], runs.join(", "))))
            }
            None => kind,
        })
    }

    /// The results of the greatest kind among those found, in words.
    fn words(&self, owner: Option<&Owner>, greatest: &Kind, found: &[(Kind, PathBuf)]) -> String {
        match greatest {
            Kind::Other => match owner.filter(|owner| owner.kind.is_some()) {
                Some(Owner { title, file: Some(file), .. }) => {
                    format!("the results of another scene (“{title}”, {file})")
                }
                Some(Owner { title, .. }) => format!("the results of another scene (“{title}”)"),
                None => "frames of another scene".to_owned(),
            },
            Kind::Foreign => {
                let below = |file: &PathBuf| file.strip_prefix(&self.path).unwrap_or(file).display().to_string();
                let foreign = found.iter().filter(|(kind, _)| *kind == Kind::Foreign).map(|(_, file)| below(file));
                let (first, all) = (foreign.clone().min().unwrap_or_default(), foreign.count());
                match all {
                    1 => format!("{first}, which was not written by localshape"),
                    all => format!("{first} and {} more, which were not written by localshape", all - 1),
                }
            }
            Kind::Unlike(words) => format!("frames of this scene of {words}"),
            Kind::Version => {
                let file = self.scene.file.as_ref().and_then(|file| file.file_name()).unwrap_or_default();
                format!("the results of another version of {}", file.display())
            }
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The planned output, and its scene.
    pub(crate) fn contents(&self) -> (&Manifest, &Whose) {
        (&self.manifest, &self.scene)
    }

    /// Whether only the frames of a shard are written.
    pub(crate) fn is_shard(&self) -> bool {
        self.access.shard
    }

    /// The results that are replaced although the user has not asked for it, in words: `the results of another version
    /// of sag.toml`.
    pub(crate) fn replaced(&self) -> Option<&str> {
        self.replaced.as_deref()
    }

    /// Creates the folder if necessary, locks it, removes replaced results, and writes a `summary`, which marks the
    /// folder as this scene's even if the program is killed. Leftovers of killed processes are removed, except for a
    /// checkpoint to continue from, which is returned, and its files.
    ///
    /// # Errors
    /// If the folder cannot be created or written to, or its checkpoint does not belong to the manifest; and the errors of
    /// [`Self::inspect`], which is repeated because the folder may have changed before it was locked.
    pub(crate) fn prepare(self, summary: &Summary) -> Result<(Claimed, Option<Checkpoint>), OutputError> {
        fs::create_dir_all(&self.path).map_err(OutputError::writing(&self.path))?;
        if self.access.shard {
            return Ok((self.prepare_shared(summary)?, None));
        }
        let lock = FolderLock::alone(&self.path)?;
        let read = || Checkpoint::read(&self.path, &self.scene, &self.manifest);
        let checkpoint = if self.access.resume { read()? } else { None };
        let found = self.find()?;
        if checkpoint.is_none() {
            // First, so that no checkpoint is left without its files.
            Checkpoint::remove(&self.path)?;
            self.remove_leftovers()?;
        }
        found.remove(&self.path)?;
        summary.write(&self.path)?;
        Ok((Claimed { folder: self, _lock: lock }, checkpoint))
    }

    /// Prepares the folder for a shard, beside processes with other shards. The summary is that of the first process.
    fn prepare_shared(self, summary: &Summary) -> Result<Claimed, OutputError> {
        let lock = FolderLock::shared(&self.path)?;
        if !self.find()?.has_summary {
            summary.write(&self.path)?;
        }
        self.remove_leftovers()?;
        Ok(Claimed { folder: self, _lock: lock })
    }

    /// Removes leftovers of killed processes that wrote the same files.
    fn remove_leftovers(&self) -> Result<(), OutputError> {
        let Manifest { frames, files, pictures, .. } = &self.manifest;
        let alone = !self.access.shard;
        remove_leftovers(&self.path, if pictures.is_some() { frames } else { &[] }, alone)?;
        let folders = files.iter().filter_map(|pattern| Some(self.path.join(pattern.split_once("/*")?.0)));
        folders.filter(|path| path.is_dir()).try_for_each(|path| remove_leftovers(&path, &[], alone))
    }
}

/// A locked folder. Until it is dropped, only processes that share the lock write to it.
#[derive(Debug)]
pub(crate) struct Claimed {
    folder: Folder,
    _lock: FolderLock,
}

impl Deref for Claimed {
    type Target = Folder;

    fn deref(&self) -> &Folder {
        &self.folder
    }
}

/// Without a checkpoint, unfinished files are of no use.
impl Drop for Claimed {
    fn drop(&mut self) {
        if !self.access.shard && !Checkpoint::is_in(self.path()) {
            // The next command tries again.
            let _ = self.remove_leftovers();
        }
    }
}

/// Existing results in a folder.
#[derive(Debug)]
struct Found {
    /// Results that are replaced. The summary is last, because it tells whose the others are.
    stale: Vec<PathBuf>,
    /// Why the folder is refused unless `stale` may be replaced, in words.
    hindrance: Option<String>,
    /// Whether there is a summary of this scene.
    has_summary: bool,
}

/// The kind of the results in a file, from the least to the greatest reason for refusing a folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// Of another version of the scene's file.
    Version,
    /// Frames of this scene in another size or with other runs: these, in words.
    Unlike(String),
    /// Of another program.
    Foreign,
    /// Of another scene.
    Other,
}

impl Found {
    /// Removes the stale results from a folder.
    fn remove(&self, folder: &Path) -> Result<(), OutputError> {
        self.stale.iter().try_for_each(|path| remove(path))?;
        // Folders of runs go with their last file.
        let folders = self.stale.iter().filter_map(|path| path.parent()).filter(|inner| *inner != folder);
        folders.for_each(|inner| _ = fs::remove_dir(inner));
        Ok(())
    }
}

/// The scene of a summary.
#[derive(Debug)]
struct Owner {
    digest: String,
    title: String,
    file: Option<String>,
    /// The kind of its results; `None` if they are those of the scene of the command.
    kind: Option<Kind>,
}

impl Owner {
    /// Reads the owner from `run.json` in a folder; `None` if there is none or another program wrote it.
    fn read(folder: &Path, scene: &Whose) -> Result<Option<Self>, OutputError> {
        let Some(bytes) = read_file(&folder.join(SUMMARY_FILE))? else { return Ok(None) };
        let Ok(summary) = serde_json::from_slice::<serde_json::Value>(&bytes) else { return Ok(None) };
        let text = |key: &str| summary["scene"][key].as_str().map(str::to_owned);
        let Some(digest) = text("digest").filter(|_| summary.get("localshape").is_some()) else { return Ok(None) };
        let file = text("file");
        // A scene that was moved together with the folder has the same file.
        let moved = text("relative_file").and_then(|file| folder.join(file).canonicalize().ok());
        let is_same_file = scene.file.is_some() && [file.as_ref().map(PathBuf::from), moved].contains(&scene.file);
        let other = if is_same_file { Kind::Version } else { Kind::Other };
        let kind = (!scene.owns(&digest)).then_some(other);
        Ok(Some(Self { digest, title: text("title").unwrap_or_default(), file, kind }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BodyBuilder, Limits, RunBuilder, Scene};
    use crate::sim::model::shape_based::ShapeBased;
    use std::sync::Arc;

    /// Scenes without a digest cannot be compared.
    #[test]
    fn scenes_with_models_of_their_own_are_never_taken_for_each_other() {
        let scene = |title: &str, side: f64| {
            let run = RunBuilder::own(Arc::new(ShapeBased::new(1e4)));
            let scene = Scene::builder(title, BodyBuilder::polygon(3, side)).run("run", run);
            scene.build(&Limits::default()).unwrap()
        };
        let (one, other) = (scene("one", 1.0), scene("other", 2.0));
        let place = tempfile::tempdir().unwrap();
        let (runs, frames, files) = Default::default();
        let manifest = Manifest { runs, frames, states: false, files, pictures: None };
        let inspect = |scene, access| Folder::inspect(place.path(), Whose::of(scene), manifest.clone(), access);
        let summary = Summary::new(&one, &[0], 0, &[]);
        inspect(&one, Access::default()).unwrap().prepare(&summary).unwrap();
        for follows in [false, true] {
            let message = inspect(&other, Access { follows, ..Access::default() }).unwrap_err().to_string();
            assert!(message.contains("the results of another scene (“one”)"), "{message}");
        }
        inspect(&other, Access { overwrite: true, ..Access::default() }).unwrap();
    }
}
