//! Compares a scene with its golden, and accepts its results as the expected ones.

use super::comparison::{Comparison, paired};
use super::error::ComparisonError;
use super::folder::{Drawn, Golden};
use super::keys;
use super::record::RECORD_FILE;
use super::source::Source;
use super::states::{Run, moved};
use super::verdict::Verdict;
use crate::output::{AtomicFile, FolderLock, OutputError, read_file, shell};
use std::path::Path;

impl Comparison {
    /// Compares the states and pictures of a scene or figure with its golden.
    pub(crate) fn of_golden(golden: &Golden, drawn: &Drawn) -> Self {
        let pictures = drawn.pictures.clone().map(|actual| paired(golden.pictures.clone(), actual));
        let mut comparison = Self::of_pairs(pictures.unwrap_or_default(), &drawn.origin);
        let typed = [&golden.folder, &drawn.origin].map(|path| typed(path));
        comparison.command = Some(format!("localshape compare --bless {}", typed.join(" ")));
        comparison.notes = drawn.notes.clone();
        if drawn.pictures.is_none() {
            comparison.notes.push("no graphics adapter: states were compared, pictures were not".to_owned());
        }
        let Some(record) = &golden.record else {
            comparison.golden_is_missing = true;
            let folder = golden.folder.display();
            comparison.notes.insert(
                0,
                match &golden.damage {
                    None => format!("the golden {folder} is missing"),
                    Some(what) => format!("{folder}/{RECORD_FILE} cannot be read: {what}"),
                },
            );
            return comparison;
        };
        let [before, after] = [record, &drawn.record];
        comparison.moved = moved(&before.states, &after.states);
        comparison.keys = keys::changed(&before.keys, &after.keys);
        let runs = before.states.runs.iter().filter_map(|run| Some((run, after.states.run(&run.name)?)));
        let both =
            |(one, other): (&Run, &Run)| one.states.keys().filter(|frame| other.states.contains_key(frame)).count();
        comparison.states = Some(runs.map(both).sum());
        if before.subject != after.subject {
            comparison.notes.push(format!("the golden is of {}, and this is {}", before.subject, after.subject));
        }
        if let (Some(recorded), Some(end)) = (before.states.last(), after.states.last()) {
            comparison.ends_early = (end < recorded).then_some([recorded, end]);
            if end < recorded {
                comparison
                    .notes
                    .push(format!("the golden continues to frame {recorded}, the scene ends with frame {end}"));
            } else if end > recorded {
                comparison
                    .notes
                    .push(format!("the golden ends with frame {recorded}, the scene continues to frame {end}"));
            }
        }
        comparison
    }

    /// Refuses pictures that are only within the tolerance.
    pub(super) fn refuse_tolerance(&mut self) {
        for picture in self.pictures.iter_mut().filter(|picture| picture.verdict == Verdict::WithinTolerance) {
            picture.verdict = Verdict::DrawnDifferently;
            let unequal = picture.distance.map_or(0, |distance| distance.unequal);
            picture.note = Some(format!("unequal pixels: {unequal}, but none are allowed without lit bodies"));
        }
    }

    /// Makes the golden, or replaces its parts that changed, and returns a line on each change. Pictures within the
    /// tolerance are kept. All files are written under hidden names before the first one is renamed.
    ///
    /// # Errors
    /// If there are no pictures, or a file cannot be written.
    pub(crate) fn accept(&self, golden: &Golden, drawn: &Drawn) -> Result<Vec<String>, ComparisonError> {
        let pictures = drawn.pictures.as_ref().ok_or(ComparisonError::Undrawn)?;
        let folder = &golden.folder;
        std::fs::create_dir_all(folder).map_err(OutputError::writing(folder))?;
        let _lock = FolderLock::beside_others(folder);
        let mut staged = Vec::new();
        let mut write = |path: &Path, bytes: &[u8]| -> Result<(), OutputError> {
            let mut file = AtomicFile::create(path)?;
            file.append(bytes)?;
            staged.push((path.to_owned(), file));
            Ok(())
        };
        let mut gone = Vec::new();
        for picture in self.pictures.iter().filter(|picture| !picture.verdict.passes()) {
            let path = folder.join(&picture.name);
            match pictures.get(&picture.name).map(Source::bytes) {
                Some(bytes) => write(&path, &bytes.expect("in memory"))?,
                None => gone.push(path),
            }
        }
        let (path, text) = (folder.join(RECORD_FILE), drawn.record.text());
        if read_file(&path).ok().flatten().as_deref() != Some(text.as_bytes()) {
            write(&path, text.as_bytes())?;
        }
        let mut told: Vec<String> = self.moved.iter().map(|moved| format!("accepted: state moved: {moved}")).collect();
        for (path, file) in staged {
            told.push(format!("accepted {}", path.display()));
            file.commit()?;
        }
        for path in gone {
            std::fs::remove_file(&path).map_err(OutputError::writing(&path))?;
            told.push(format!("removed {}", path.display()));
        }
        Ok(told)
    }
}

/// A path, quoted for the command line.
fn typed(path: &Path) -> String {
    let path = path.to_string_lossy();
    // Prefixed so that a name which begins with - is not taken for an option.
    let path = if path.starts_with('-') { format!("./{path}").into() } else { path };
    shell::word(&path)
}
