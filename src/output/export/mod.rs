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

use super::{AtomicFile, OutputError, StatesWriter, write_whole};
use crate::carried::positions;
use crate::reading::captions::typed;
use crate::reading::words::{count, quoted};
use crate::runner::{Frame, RunFrame};
use crate::scene::{Run, Scene};
use crate::sim::{Body, Carried, Snapshot, Support};
use course::Course;
pub(super) use mark::scene_of;
use mark::{mark, starts_with};
use rayon::prelude::*;
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
    series: Vec<Series>,
    /// The surfaces of the runs, if they are written.
    surfaces: Vec<OfRun>,
    /// The requested frames, those of other shards included.
    frames: Vec<u64>,
}

/// The surfaces of a run.
struct OfRun {
    /// The place of the run among the requested ones.
    place: usize,
    /// The index of the run in the scene.
    run: usize,
    /// What the names of its files begin with, and the name of its folder.
    stem: String,
    bodies: Vec<OfBody>,
}

/// The surface of a body.
struct OfBody {
    /// Its name in the scene, or `body` if it has none.
    name: String,
    nodes: Range<usize>,
    surface: Surface,
}

/// Files of one run that are shown together.
struct Series {
    /// The place of the run among the requested ones.
    place: usize,
    /// The index of the run in the scene.
    run: usize,
    /// What the names of its files begin with, and the name of their folder.
    stem: String,
    parts: Vec<Part>,
}

/// A body in a series.
struct Part {
    /// What the names of its files begin with.
    stem: String,
    /// Its name in the scene; empty if it has none.
    name: String,
    shape: Shape,
    nodes: Range<usize>,
    elements: Range<usize>,
    cells: Cells,
}

/// What is written of a body.
enum Shape {
    Elements(Arc<Body>),
    /// The surface that its elements carry.
    Surface(Arc<Carried>),
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
        let series: Vec<_> = if wants_grids { all_series(scene, runs).collect() } else { Vec::new() };
        let wants_surfaces = formats.iter().any(|&format| format != Format::Vtu);
        let surfaces: Vec<_> = if wants_surfaces { all_surfaces(scene, runs).collect() } else { Vec::new() };
        let has_frames = formats.contains(&Format::Obj);
        let stems = surfaces.iter().filter(|_| has_frames).map(|run| &run.stem);
        for stem in series.iter().map(|one| &one.stem).chain(stems) {
            let path = folder.join(stem);
            fs::create_dir_all(&path).map_err(OutputError::writing(&path))?;
        }
        let (folder, formats, frames) = (folder.to_owned(), formats.to_vec(), frames.to_vec());
        Ok(Self { scene, folder, formats, series, surfaces, frames })
    }

    /// Writes the files of a frame.
    ///
    /// # Errors
    /// If one cannot be written; others may have been.
    pub(crate) fn write(&self, frame: &Frame) -> Result<(), OutputError> {
        let files: Vec<_> = self.series.iter().flat_map(|one| one.parts.iter().map(move |part| (one, part))).collect();
        files.par_iter().try_for_each(|(series, part)| {
            let path = self.folder.join(series.grid_file(part, frame.index));
            write_whole(&path, &self.grid(series, part, frame.index, &frame.runs[series.place]))
        })?;
        if !self.formats.contains(&Format::Obj) {
            return Ok(());
        }
        self.surfaces.par_iter().try_for_each(|run| {
            let Snapshot { time, position, .. } = &frame.runs[run.place].snapshot;
            let bodies = run.bodies.iter().map(|body| (&*body.name, &body.surface, &position[body.nodes.clone()]));
            let text =
                obj::document(&mark(self.scene, Some(frame.index)), [*time, self.scene.runs[run.run].step], bodies);
            write_whole(&self.folder.join(run.frame_file(frame.index)), text.as_bytes())
        })
    }

    /// The files of a frame, below the output folder.
    fn frame_files(&self, frame: u64) -> impl Iterator<Item = String> {
        let grids =
            self.series.iter().flat_map(move |one| one.parts.iter().map(move |part| one.grid_file(part, frame)));
        let has_frames = self.formats.contains(&Format::Obj);
        grids.chain(self.surfaces.iter().filter(move |_| has_frames).map(move |run| run.frame_file(frame)))
    }

    /// The grid of a part in a frame.
    fn grid(&self, series: &Series, part: &Part, frame: u64, run: &RunFrame) -> Vec<u8> {
        let Snapshot { time, position, velocity, turned_over, broken, field, .. } = &run.snapshot;
        let mark = mark(self.scene, Some(frame));
        let [position, velocity] = [position, velocity].map(|all| &all[part.nodes.clone()]);
        let body = match &part.shape {
            Shape::Surface(carried) => {
                let velocity = positions(carried, velocity);
                let of_points = [Column::Vectors("velocity", &velocity)];
                return vtu::document(&mark, *time, &part.cells, &positions(carried, position), &of_points, &[]);
            }
            Shape::Elements(body) => body,
        };
        let mut of_points = vec![Column::Vectors("velocity", velocity)];
        let mut of_cells = vec![Column::Flags("turned_over", &turned_over[part.elements.clone()])];
        of_cells.extend(broken.get(part.elements.clone()).map(|broken| Column::Flags("broken", broken)));
        of_cells.extend(body.fill().map(|fill| Column::Numbers("fill", fill)));
        let name = self.scene.view.colour.map(|scale| (scale.field.support(), typed(&scale.field)));
        // A run from which distances are measured has no values.
        match &name {
            Some((Support::Nodes, name)) if field.len() == self.scene.runs[series.run].body().len() => {
                of_points.push(Column::Numbers(name, &field[part.nodes.clone()]));
            }
            Some((Support::Elements, name)) if field.len() == turned_over.len() => {
                of_cells.push(Column::Numbers(name, &field[part.elements.clone()]));
            }
            _ => {}
        }
        vtu::document(&mark, *time, &part.cells, position, &of_points, &of_cells)
    }

    /// What is wrong with the files of frames that an earlier command has written, in words; `None` if all are as they were.
    ///
    /// # Errors
    /// If one cannot be read.
    pub(crate) fn wrong(&self, frames: &[u64]) -> Result<Option<String>, OutputError> {
        for &frame in frames {
            let mark = mark(self.scene, Some(frame));
            for file in self.frame_files(frame) {
                if !starts_with(&self.folder.join(&file), &mark)? {
                    return Ok(Some(format!("{file}, which is missing or has been replaced since; restore it")));
                }
            }
        }
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
        self.series.iter().try_for_each(|series| {
            let path = self.folder.join(format!("{}.pvd", series.stem));
            let files = self.moments(series.run, frames).into_iter().flat_map(|(at, time)| {
                let file = move |part: &Part| (time, part.name.clone(), series.grid_file(part, frames[at]));
                series.parts.iter().map(file)
            });
            write_whole(
                &path,
                pvd::document(&mark(self.scene, None), self.scene.runs[series.run].step, files).as_bytes(),
            )
        })
    }

    /// Writes the files that have the whole course of a run. There are none without a frame.
    fn write_courses(&self, frames: &[u64], states: &mut StatesWriter) -> Result<(), OutputError> {
        for run in self.surfaces.iter().filter(|_| !frames.is_empty()) {
            let (places, times) = self.moments(run.run, frames).into_iter().unzip();
            let mut course = Course { states: &mut *states, place: run.place, frames: places, times };
            let (mark, name) = (mark(self.scene, None), &self.scene.runs[run.run].name);
            let head = usda::Head { mark: &mark, name, rate: self.scene.frames_per_second };
            if self.formats.contains(&Format::Usd) {
                self.write_course(run, "usda", |to| usda::write(to, &head, run, &mut course))?;
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
        run: &OfRun,
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

impl OfRun {
    /// The file of the surfaces in a frame, below the output folder.
    fn frame_file(&self, frame: u64) -> String {
        format!("{}/frame_{frame:05}.obj", self.stem)
    }
}

/// The surfaces of some runs.
fn all_surfaces<'a>(scene: &'a Scene, runs: &'a [usize]) -> impl Iterator<Item = OfRun> + 'a {
    runs.iter().enumerate().map(|(place, &run)| {
        let (of, bodies) = (&scene.runs[run].of, &scene.runs[run].bodies);
        let body = |(at, body): (usize, &Arc<Body>)| {
            let name = or_body(&scene.bodies[of[at]].name).to_owned();
            OfBody { name, nodes: bodies.nodes(at), surface: Surface::of(body) }
        };
        let bodies = bodies.bodies().iter().enumerate().map(body).collect();
        OfRun { place, run, stem: file_name(&scene.runs[run].name), bodies }
    })
}

/// The name of a body in files.
fn or_body(name: &str) -> &str {
    if name.is_empty() { "body" } else { name }
}

impl Series {
    /// The file of a part in a frame, below the output folder.
    fn grid_file(&self, part: &Part, frame: u64) -> String {
        format!("{}/{}_{frame:05}.vtu", self.stem, part.stem)
    }
}

/// The series of grids of some runs: one of elements for each, and one of surfaces if some bodies carry them.
fn all_series<'a>(scene: &'a Scene, runs: &'a [usize]) -> impl Iterator<Item = Series> + 'a {
    runs.iter().enumerate().flat_map(move |(place, &run)| {
        let series = move |ending: &str, shape_of: fn(&Arc<Body>) -> Option<Shape>| {
            let (of, bodies) = (&scene.runs[run].of, &scene.runs[run].bodies);
            let part = |(at, body): (usize, &Arc<Body>)| {
                let (name, shape) = (scene.bodies[of[at]].name.clone(), shape_of(body)?);
                let cells = match &shape {
                    Shape::Elements(body) => Cells::of_body(body),
                    Shape::Surface(carried) => Cells::of_triangles(&carried.triangles),
                };
                Some(Part {
                    stem: file_name(or_body(&name)),
                    name,
                    shape,
                    nodes: bodies.nodes(at),
                    elements: bodies.elements(at),
                    cells,
                })
            };
            let parts: Vec<_> = bodies.bodies().iter().enumerate().filter_map(part).collect();
            let stem = file_name(&scene.runs[run].name) + ending;
            (!parts.is_empty()).then_some(Series { place, run, stem, parts })
        };
        let surface = |body: &Arc<Body>| body.carried().map(|carried| Shape::Surface(Arc::clone(carried)));
        [series("", |body| Some(Shape::Elements(Arc::clone(body)))), series(SURFACE, surface)].into_iter().flatten()
    })
}

/// The ending of names of series of carried surfaces.
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

    #[test]
    fn names_that_differ_by_case_only_are_refused() {
        assert!(same_name(["Soft", "soft"].into_iter(), "runs").unwrap_err().contains("“Soft” and “soft”"));
        assert!(same_name(["a:b", "a?b"].into_iter(), "runs").is_err());
        same_name(["a", "b"].into_iter(), "runs").unwrap();
    }
}
