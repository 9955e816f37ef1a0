//! Files for other programs: bodies in motion, as those programs read them.
//!
//! Each run has files under its own name. Files of single frames are written when the frame is known, and files of the whole
//! course at the end.

mod course;
mod glb;
mod influence;
mod mark;
mod narrow;
mod obj;
mod pvd;
mod surface;
mod usda;
mod vtu;

use super::{AtomicFile, OutputError, StatesWriter, read_file, write_whole};
use crate::carried::positions;
use crate::reading::captions::typed;
use crate::reading::words::{count, quoted};
use crate::runner::{Frame, RunFrame};
use crate::scene::{Run, Scene};
use crate::sim::{Body, Carried, Snapshot, Support};
use course::Course;
use mark::mark;
pub(super) use mark::scene_of;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use surface::Surface;
use vtu::{Cells, Column};

/// A format of files for other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Format {
    /// VTK's unstructured grids, one for each body and frame, with a list of them and their times for each run.
    Vtu,
    /// Universal Scene Description, one file for each run.
    Usd,
    /// glTF, one file for each run.
    Gltf,
    /// Wavefront's surfaces, one file for each run and frame.
    Obj,
}

impl Format {
    /// All formats with their names.
    pub(crate) const ALL: [(Self, &'static str); 4] =
        [(Self::Vtu, "vtu"), (Self::Usd, "usd"), (Self::Gltf, "gltf"), (Self::Obj, "obj")];

    /// Whether it has the whole course of a run in one file, for which the states of all frames are kept.
    pub(crate) fn is_of_course(self) -> bool {
        matches!(self, Self::Usd | Self::Gltf)
    }
}

/// The files of some runs for other programs.
pub(crate) struct Export<'a> {
    scene: &'a Scene,
    folder: PathBuf,
    formats: Vec<Format>,
    /// The grids of the runs, if they are written.
    grids: Vec<FilesOf<UnstructuredGrid>>,
    /// The surfaces of the runs, if they are written.
    surfaces: Vec<FilesOf<Surface>>,
    /// The requested frames, those of other shards included.
    frames: Vec<u64>,
    /// Checksums of the files of frames written so far, in the order of `frame_files`.
    pub(crate) written: Vec<u64>,
}

/// Files of a run, with grids or surfaces of its bodies.
struct FilesOf<T> {
    /// The place of the run among the requested ones.
    place: usize,
    /// The index of the run in the scene.
    run: usize,
    /// The beginning of the names of its files, and the name of their folder.
    stem: String,
    bodies: Vec<OfBody<T>>,
}

/// A body in files.
struct OfBody<T> {
    /// Its name in the scene; empty if it has none.
    name: String,
    nodes: Range<usize>,
    elements: Range<usize>,
    shown: T,
}

/// A grid of a body: its elements, or the surface that they carry.
struct UnstructuredGrid {
    cells: Cells,
    body: Arc<Body>,
    carried: Option<Arc<Carried>>,
}

impl<'a> Export<'a> {
    /// The files of some formats for runs of a scene, below `folder`, which exists. `frames` are those of all shards.
    ///
    /// # Errors
    /// If the folders of the runs cannot be made.
    pub(crate) fn begin(
        folder: &Path,
        scene: &'a Scene,
        runs: &[usize],
        formats: &[Format],
        frames: &[u64],
    ) -> Result<Self, OutputError> {
        let wants_grids = formats.contains(&Format::Vtu);
        let grids = if wants_grids { UnstructuredGrid::all(scene, runs) } else { Vec::new() };
        let wants_surfaces = formats.iter().any(|&format| format != Format::Vtu);
        let surface = |body: &Arc<Body>| wants_surfaces.then(|| Surface::of(body));
        let surfaces = FilesOf::all(scene, runs, "", surface);
        let has_frames = formats.contains(&Format::Obj);
        let stems = surfaces.iter().filter(|_| has_frames).map(|run| &run.stem);
        for stem in grids.iter().map(|run| &run.stem).chain(stems) {
            let path = folder.join(stem);
            fs::create_dir_all(&path).map_err(OutputError::writing(&path))?;
        }
        let (folder, formats, frames) = (folder.to_owned(), formats.to_vec(), frames.to_vec());
        Ok(Self { scene, folder, formats, grids, surfaces, frames, written: Vec::new() })
    }

    /// Writes the files of a frame.
    ///
    /// # Errors
    /// If one cannot be written; others may have been.
    pub(crate) fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        let write = |file: &str, bytes: &[u8]| -> Result<u64, OutputError> {
            write_whole(&self.folder.join(file), bytes)?;
            Ok(checksum(bytes))
        };
        let files: Vec<_> = self.grids.iter().flat_map(|run| run.bodies.iter().map(move |body| (run, body))).collect();
        let grids = files.par_iter().map(|(run, body)| {
            write(&run.grid_file(body, frame.index), &self.grid(body, frame.index, &frame.runs[run.place]))
        });
        let mut written = grids.collect::<Result<Vec<_>, _>>()?;
        if self.formats.contains(&Format::Obj) {
            let surfaces = self.surfaces.par_iter().map(|run| {
                let Snapshot { time, position, .. } = &frame.runs[run.place].snapshot;
                let bodies = run.bodies.iter().map(|body| (body.title(), &body.shown, &position[body.nodes.clone()]));
                let times = [*time, self.scene.runs[run.run].step];
                let text = obj::document(&mark(self.scene, Some(frame.index)), times, bodies);
                write(&run.frame_file(frame.index), text.as_bytes())
            });
            written.extend(surfaces.collect::<Result<Vec<_>, _>>()?);
        }
        self.written.extend(written);
        Ok(())
    }

    /// The files of a frame, below the output folder.
    fn frame_files(&self, frame: u64) -> impl Iterator<Item = String> {
        let grids =
            self.grids.iter().flat_map(move |run| run.bodies.iter().map(move |body| run.grid_file(body, frame)));
        let has_frames = self.formats.contains(&Format::Obj);
        grids.chain(self.surfaces.iter().filter(move |_| has_frames).map(move |run| run.frame_file(frame)))
    }

    /// The grid of a body in a frame of its run.
    fn grid(&self, of: &OfBody<UnstructuredGrid>, frame: u64, run: &RunFrame) -> Vec<u8> {
        let Snapshot { time, position, velocity, turned_over, broken, field, .. } = &run.snapshot;
        let mark = mark(self.scene, Some(frame));
        let [position, velocity] = [position, velocity].map(|all| &all[of.nodes.clone()]);
        let UnstructuredGrid { cells, body, carried } = &of.shown;
        if let Some(carried) = carried {
            let velocity = positions(carried, velocity);
            let of_points = [Column::Vectors("velocity", &velocity)];
            return vtu::document(&mark, *time, cells, &positions(carried, position), &of_points, &[]);
        }
        let mut of_points = vec![Column::Vectors("velocity", velocity)];
        let mut of_cells = vec![Column::Flags("turned_over", &turned_over[of.elements.clone()])];
        of_cells.extend(broken.get(of.elements.clone()).map(|broken| Column::Flags("broken", broken)));
        of_cells.extend(body.fill().map(|fill| Column::Numbers("fill", fill)));
        let name = self.scene.view.colour.map(|scale| (scale.field.support(), typed(&scale.field)));
        // A run from which distances are measured has no values.
        match &name {
            Some((Support::Nodes, name)) if field.len() == self.scene.runs[run.run].body().len() => {
                of_points.push(Column::Numbers(name, &field[of.nodes.clone()]));
            }
            Some((Support::Elements, name)) if field.len() == turned_over.len() => {
                of_cells.push(Column::Numbers(name, &field[of.elements.clone()]));
            }
            _ => {}
        }
        vtu::document(&mark, *time, cells, position, &of_points, &of_cells)
    }

    /// Goes on after frames that an earlier command has written, whose files had some checksums. Returns the first fault of these files
    /// in words; `None` if all are as they were.
    ///
    /// # Errors
    /// If one cannot be read.
    pub(crate) fn keep(&mut self, frames: &[u64], written: Vec<u64>) -> Result<Option<String>, OutputError> {
        let files = frames.iter().flat_map(|&frame| self.frame_files(frame));
        for (file, written) in files.zip(&written) {
            if read_file(&self.folder.join(&file))?.is_none_or(|bytes| checksum(&bytes) != *written) {
                return Ok(Some(format!("{file}, which is missing, damaged or replaced since; restore it")));
            }
        }
        self.written = written;
        Ok(None)
    }

    /// Writes the files of the course, with the first `recorded` frames; with `None`, those of all shards. `states` has the states of
    /// these frames, if a format needs them.
    ///
    /// # Errors
    /// If one cannot be written.
    pub(crate) fn finish(self, recorded: Option<usize>, states: Option<&mut StatesWriter>) -> Result<(), OutputError> {
        let frames = &self.frames[..recorded.unwrap_or(self.frames.len()).min(self.frames.len())];
        if let Some(states) = states {
            self.write_courses(frames, states)?;
        }
        self.grids.iter().try_for_each(|run| {
            let path = self.folder.join(format!("{}.pvd", run.stem));
            let files = self.moments(run.run, frames).into_iter().flat_map(|(at, time)| {
                run.bodies.iter().map(move |body| (time, body.name.clone(), run.grid_file(body, frames[at])))
            });
            let list = pvd::document(&mark(self.scene, None), self.scene.runs[run.run].step, files);
            write_whole(&path, list.as_bytes())
        })
    }

    /// Writes the files that have the whole course of a run. There are none without a frame.
    fn write_courses(&self, frames: &[u64], states: &mut StatesWriter) -> Result<(), OutputError> {
        for run in self.surfaces.iter().filter(|_| !frames.is_empty()) {
            let (places, times) = self.moments(run.run, frames).into_iter().unzip();
            let mut course = Course { states: &mut *states, place: run.place, frames: places, times };
            let (mark, name) = (mark(self.scene, None), &self.scene.runs[run.run].name);
            let rate = self.scene.frames_per_second;
            if self.formats.contains(&Format::Usd) {
                self.write_course(run, "usda", |to| usda::write(to, (&mark, name), rate, run, &mut course))?;
            }
            if self.formats.contains(&Format::Gltf) {
                self.write_course(run, "glb", |to| glb::write(to, (&mark, name), run, &mut course))?;
            }
        }
        Ok(())
    }

    /// Writes a file of a run piece by piece.
    fn write_course(
        &self,
        run: &FilesOf<Surface>,
        ending: &str,
        write: impl FnOnce(&mut BufWriter<&mut fs::File>) -> io::Result<()>,
    ) -> Result<(), OutputError> {
        let path = self.folder.join(format!("{}.{ending}", run.stem));
        let mut file = AtomicFile::create(&path)?;
        let mut to = BufWriter::new(file.file());
        let written = write(&mut to).and_then(|()| to.flush());
        // After an error, the rest is not tried again.
        drop(to.into_parts());
        written.map_err(OutputError::writing(&path))?;
        file.commit()
    }

    /// The frames of a run that show different steps: their places among some frames, and their times (s), rising. Of frames that show
    /// one step, because steps are longer than the time between frames, it is the first.
    fn moments(&self, run: usize, frames: &[u64]) -> Vec<(usize, f64)> {
        let time = |&frame: &u64| self.scene.frame_step(run, frame) as f64 * self.scene.runs[run].step;
        let mut moments: Vec<_> = frames.iter().map(time).enumerate().collect();
        moments.dedup_by_key(|(_, time)| *time);
        moments
    }
}

impl<T> FilesOf<T> {
    /// The files of some runs, with what `show` takes of each body; none of a run without any. Their names end with `ending`.
    fn all(scene: &Scene, runs: &[usize], ending: &str, show: impl Fn(&Arc<Body>) -> Option<T>) -> Vec<Self> {
        let of_run = |(place, &run): (usize, &usize)| {
            let Run { name, of, bodies, .. } = &scene.runs[run];
            let body = |(at, body): (usize, &Arc<Body>)| {
                let name = scene.bodies[of[at]].name.clone();
                Some(OfBody { name, nodes: bodies.nodes(at), elements: bodies.elements(at), shown: show(body)? })
            };
            let bodies: Vec<_> = bodies.bodies().iter().enumerate().filter_map(body).collect();
            (!bodies.is_empty()).then(|| Self { place, run, stem: file_name(name) + ending, bodies })
        };
        runs.iter().enumerate().filter_map(of_run).collect()
    }
}

impl FilesOf<Surface> {
    /// The file of the surfaces in a frame, below the output folder.
    fn frame_file(&self, frame: u64) -> String {
        format!("{}/frame_{frame:05}.obj", self.stem)
    }
}

impl FilesOf<UnstructuredGrid> {
    /// The file of a body in a frame, below the output folder.
    fn grid_file(&self, body: &OfBody<UnstructuredGrid>, frame: u64) -> String {
        format!("{}/{}_{frame:05}.vtu", self.stem, file_name(body.title()))
    }
}

impl<T> OfBody<T> {
    /// Its name in files.
    fn title(&self) -> &str {
        or_body(&self.name)
    }
}

/// The first bytes of the SHA-256 digest of a file.
fn checksum(bytes: &[u8]) -> u64 {
    Sha256::digest(bytes).first_chunk().map_or(0, |first| u64::from_be_bytes(*first))
}

/// The name of a body in files.
fn or_body(name: &str) -> &str {
    if name.is_empty() { "body" } else { name }
}

impl UnstructuredGrid {
    /// The grids of elements of some runs, each followed by those of surfaces that bodies of the run carry.
    fn all(scene: &Scene, runs: &[usize]) -> Vec<FilesOf<Self>> {
        let grid = |body: &Arc<Body>, cells, carried| Self { cells, body: Arc::clone(body), carried };
        let mut all = FilesOf::all(scene, runs, "", |body| Some(grid(body, Cells::of_body(body), None)));
        all.extend(FilesOf::all(scene, runs, SURFACE, |body| {
            let carried = body.carried()?;
            Some(grid(body, Cells::of_triangles(&carried.triangles), Some(Arc::clone(carried))))
        }));
        all.sort_by_key(|run| run.place);
        all
    }
}

/// The ending of the names of grids of carried surfaces.
const SURFACE: &str = "-surface";

/// Patterns of the files for some runs and frames of a scene, below the output folder.
///
/// # Errors
/// If two runs or bodies would have the same files, or a format does not take them, in words.
pub(crate) fn files(scene: &Scene, runs: &[usize], formats: &[Format], frames: usize) -> Result<Vec<String>, String> {
    let mut files = Vec::new();
    if formats.is_empty() {
        return Ok(files);
    }
    same_name(runs.iter().map(|&run| scene.runs[run].name.as_str()), "runs")?;
    for &run in runs {
        let run = &scene.runs[run];
        let stem = file_name(&run.name);
        let carries = run.bodies.bodies().iter().any(|body| body.carried().is_some());
        for format in formats {
            match format {
                Format::Vtu => {
                    let stems = [Some(stem.clone()), carries.then(|| format!("{stem}{SURFACE}"))];
                    files.extend(
                        stems.into_iter().flatten().flat_map(|stem| [format!("{stem}.pvd"), format!("{stem}/*.vtu")]),
                    );
                }
                Format::Usd => files.push(format!("{stem}.usda")),
                Format::Gltf => {
                    fits_gltf(scene, run, frames)?;
                    files.push(format!("{stem}.glb"));
                }
                Format::Obj => files.push(format!("{stem}/*.obj")),
            }
        }
        same_name(run.body_names(scene), "bodies")?;
    }
    let lower: Vec<_> = files.iter().map(|file| file.to_lowercase()).collect();
    match (1..files.len()).find(|&at| lower[..at].contains(&lower[at])) {
        Some(at) => Err(format!("two runs would both have the file {}; rename one of them", files[at])),
        None => Ok(files),
    }
}

/// Refuses runs that glTF has no numbers for.
fn fits_gltf(scene: &Scene, run: &Run, frames: usize) -> Result<(), String> {
    let help = "write usd or vtu, or make the body of fewer elements";
    let too_large = |(_, body): &(usize, &Arc<Body>)| body.len() > glb::MOST_NODES;
    if let Some((at, body)) = run.bodies.bodies().iter().enumerate().find(too_large) {
        let name = quoted(or_body(&scene.bodies[run.of[at]].name));
        let [nodes, most] = [body.len(), glb::MOST_NODES].map(|nodes| count(nodes as u128));
        return Err(format!("{name} has {nodes} nodes, and a skin of glTF at most {most}; {help}"));
    }
    match glb::least_length(run.bodies.bodies().iter().map(|body| body.len()), frames) > u32::MAX.into() {
        true => Err(format!(
            "the motion of {} is longer than the 4 GiB of a file of glTF; choose some frames with --frames, or {help}",
            quoted(&run.name)
        )),
        false => Ok(()),
    }
}

/// Refuses names whose files would be the same, also where the system does not tell upper from lower case.
fn same_name<'n>(names: impl Iterator<Item = &'n str>, what: &str) -> Result<(), String> {
    let mut known: Vec<(String, &str)> = Vec::new();
    for name in names {
        let file = file_name(name).to_lowercase();
        if let Some((_, other)) = known.iter().find(|(known, _)| *known == file) {
            return Err(format!("the {what} “{other}” and “{name}” would have the same files; rename one of them"));
        }
        known.push((file, name));
    }
    Ok(())
}

/// A name as the name of a file, also on Windows. Names of scenes have no slash and no control character.
fn file_name(name: &str) -> String {
    let mut name = name.replace(['<', '>', ':', '"', '|', '?', '*'], "_");
    // Neither hidden nor a folder above, and no dot at the end, which Windows drops.
    if name.starts_with('.') {
        name.replace_range(..1, "_");
    }
    if name.ends_with('.') {
        name.replace_range(name.len() - 1.., "_");
    }
    name
}

/// The files with a pattern in a folder: of one name, or of all frames.
pub(super) fn matching(folder: &Path, pattern: &str) -> Vec<PathBuf> {
    let Some((inner, ending)) = pattern.split_once("/*") else {
        return Some(folder.join(pattern)).filter(|path| path.symlink_metadata().is_ok()).into_iter().collect();
    };
    let is_frame = |name: &str| {
        let number = name.strip_suffix(ending).and_then(|stem| Some(stem.rsplit_once('_')?.1));
        number.is_some_and(|number| number.len() >= 5 && number.bytes().all(|digit| digit.is_ascii_digit()))
    };
    let entries = fs::read_dir(folder.join(inner)).into_iter().flatten().flatten();
    let mut found: Vec<_> =
        entries.filter(|entry| entry.file_name().to_str().is_some_and(is_frame)).map(|entry| entry.path()).collect();
    found.sort();
    found
}

/// Patterns of the files in a folder that may be of this kind, by their endings, sorted.
pub(super) fn patterns_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let patterns = |entry: fs::DirEntry| {
        let Ok(name) = entry.file_name().into_string() else { return Vec::new() };
        let is_of_course = COURSE_ENDINGS.iter().any(|ending| name.ends_with(ending));
        match entry.file_type() {
            Ok(kind) if kind.is_dir() => FRAME_ENDINGS.iter().map(|ending| format!("{name}/*{ending}")).collect(),
            Ok(kind) if kind.is_file() && is_of_course => vec![name],
            _ => Vec::new(),
        }
    };
    let mut found: Vec<_> = entries.flat_map(patterns).collect();
    found.sort();
    found
}

/// The endings of files of the whole course, and of single frames.
const COURSE_ENDINGS: [&str; 3] = [".glb", ".pvd", ".usda"];
const FRAME_ENDINGS: [&str; 2] = [".obj", ".vtu"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_their_folder() {
        assert_eq!(["a b", "..", ".", "x:y", "end."].map(file_name), ["a b", "__", "_", "x_y", "end_"]);
    }

    #[test]
    fn only_numbered_files_are_frames() {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir(place.path().join("run")).unwrap();
        for name in [
            "run.pvd",
            "run/body_00003.vtu",
            "run/body_100000.vtu",
            "run/body_3.vtu",
            "run/notes.vtu",
            "run/a_00000.txt",
        ] {
            fs::write(place.path().join(name), "").unwrap();
        }
        assert_eq!(patterns_in(place.path()), ["run.pvd", "run/*.obj", "run/*.vtu"]);
        let found = |pattern: &str| matching(place.path(), pattern).len();
        assert_eq!(["run.pvd", "run/*.vtu", "other.pvd", "other/*.vtu"].map(found), [1, 2, 0, 0]);
    }
}
