//! `states.npz`: bodies, and their positions and velocities in every frame, for analysis in other programs.

use super::{AtomicFile, OutputError};
use crate::runner::Frame;
use crate::runner::growing::{Growing, Grown};
use crate::runner::history::{History, TableRow};
use crate::scene::npy::begin;
use crate::scene::{COURSE, Course, Origin, Run, Scene, SceneBody, StoredRun};
use crate::sim::{Assembly, State, Status};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, VecDeque};
use std::fs::File;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zip::ZipWriter;

/// The name of the file in its folder.
pub(crate) const STATES_FILE: &str = "states.npz";

/// The hidden file of frames until they are arranged.
const SPOOL: &str = ".localshape-states.partial";

/// Writes the states of frames, one after the other, with bounded memory.
///
/// The archive has `time` (F), the time of each frame (s), and for each run `NAME.position` (m) and `NAME.velocity`
/// (m/s), both F × N × 3, all little-endian double precision. Each run has the step nearest to a frame: `time` is that
/// of the first run, and a run with another time step has its own `NAME.time` (F). `NAME.step` is its time step (s). Scenes allow only names of runs that
/// are valid in an archive.
///
/// The bodies of the first run are stored once: `rest` (N × 3, m) and `mass` (N, kg). The nodes of each element
/// (`elements`) and of each face on the surface of a body (`faces`) are 64-bit integers, with -1 at the end of shorter
/// rows. A scene of several bodies also has their names (`bodies`) and the place of each node's body among them (`body`,
/// N). Runs of other bodies have all these arrays but `bodies` of their own: `NAME.rest` and so on.
///
/// For drawing, the archive also has the memory of models, constraints and contact, `NAME.memory` (F × M), and the array of
/// bytes `localshape` with an [`Origin`], a [`Course`] and the time series of the scene.
///
/// Each array grows with every frame, and the number of frames is known only at the end. So frames are first written to
/// a hidden file, one record each, and rearranged at the end, which temporarily needs twice the disk space.
#[derive(Debug)]
pub(crate) struct StatesWriter {
    path: PathBuf,
    spool: Growing,
    /// The names of the scene's bodies, if it has several.
    names: Vec<String>,
    meshes: Vec<Mesh>,
    arrays: Vec<StatesArray>,
    /// Length of one frame in the temporary file (bytes).
    record: u64,
    /// Whether each run has its own times.
    own_time: Vec<bool>,
    /// The time step of each run (s).
    steps: Vec<f64>,
    origin: Origin,
    written: CourseSoFar,
}

/// The course of the frames written so far, beside the arrays of their states.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct CourseSoFar {
    course: Course,
    /// The time series of the scene, if its pictures need them and it was simulated to its end.
    history: Option<History>,
    /// The rows between frames of each run, by its number in the scene.
    rows: BTreeMap<usize, VecDeque<TableRow>>,
}

/// The bodies of a run.
#[derive(Debug)]
struct Mesh {
    /// The beginning of the names of its arrays.
    prefix: String,
    bodies: Arc<Assembly>,
    /// The places of the bodies in the scene.
    of: Vec<usize>,
}

/// One array of the archive, and its part of each record.
#[derive(Debug)]
struct StatesArray {
    name: String,
    /// The dimensions after the number of frames, in Python's notation.
    shape: String,
    /// Offset in a record (bytes).
    offset: u64,
    /// Length in a record (bytes).
    length: usize,
}

impl StatesWriter {
    /// Creates the file in `folder`, for frames of `runs`, indices into the scene's runs. Their states have the kind of
    /// `states`. The file continues after the frames `before` of another process.
    ///
    /// # Errors
    /// If the folder cannot be written to, or the frames `before` are missing.
    pub(crate) fn create<'s>(
        folder: &Path,
        scene: &Scene,
        runs: &[usize],
        states: impl Iterator<Item = &'s State>,
        before: Option<(CourseSoFar, Grown)>,
    ) -> Result<Self, OutputError> {
        let path = folder.join(STATES_FILE);
        let mut arrays = vec![StatesArray { name: "time".to_owned(), shape: String::new(), offset: 0, length: 8 }];
        let mut record = 8;
        let steps: Vec<f64> = runs.iter().map(|&run| scene.runs[run].step).collect();
        let own_time: Vec<bool> = steps.iter().map(|&step| step != steps[0]).collect();
        let mut stored = Vec::new();
        for ((&run, &own_time), state) in runs.iter().zip(&own_time).zip(states) {
            if own_time {
                let name = format!("{}.time", scene.runs[run].name);
                arrays.push(StatesArray { name, shape: String::new(), offset: record, length: 8 });
                record += 8;
            }
            let nodes = state.position.len();
            let memory = state.memory.shown().count();
            let nodes_of = format!(" {nodes}, 3");
            for (quantity, shape, length) in [
                ("position", nodes_of.clone(), 24 * nodes),
                ("velocity", nodes_of, 24 * nodes),
                ("memory", format!(" {memory}"), 8 * memory),
            ] {
                let name = format!("{}.{quantity}", scene.runs[run].name);
                arrays.push(StatesArray { name, shape, offset: record, length });
                record += length as u64;
            }
            stored.push(StoredRun::new(&scene.runs[run].name));
        }
        let mesh = |&run: &usize| {
            let is_first = Arc::ptr_eq(&scene.runs[run].bodies, &scene.runs[runs[0]].bodies);
            let Run { name, bodies, of, .. } = &scene.runs[run];
            let prefix = if is_first { String::new() } else { format!("{name}.") };
            Mesh { prefix, bodies: Arc::clone(bodies), of: of.clone() }
        };
        let is_own = |(at, mesh): &(usize, Mesh)| *at == 0 || !mesh.prefix.is_empty();
        let meshes = runs.iter().map(mesh).enumerate().filter(is_own).map(|(_, mesh)| mesh).collect();
        // A body without a name is the only one besides those of recordings.
        let name = |body: &SceneBody| if body.name.is_empty() { "body".to_owned() } else { body.name.clone() };
        let names = scene.bodies.iter().map(name).filter(|_| scene.bodies.len() > 1).collect();
        let origin = Origin::new(&scene.digest, &scene.title);
        let hidden = folder.join(SPOOL);
        let is_whole = |(before, grown): &(CourseSoFar, Grown)| {
            before.course.fits(&stored) && grown.length == before.course.frames.len() as u64 * record
        };
        let (written, spool) = match before {
            Some(before) if !is_whole(&before) => {
                return Err(OutputError::reading(&path)(ErrorKind::InvalidData.into()));
            }
            Some((before, grown)) => {
                (before, Growing::open(&hidden, Some(grown)).map_err(OutputError::reading(&hidden))?)
            }
            None => {
                let written =
                    CourseSoFar { course: Course { runs: stored, ..Course::default() }, ..CourseSoFar::default() };
                (written, Growing::open(&hidden, None).map_err(OutputError::writing(&path))?)
            }
        };
        Ok(Self { path, spool, names, meshes, arrays, record, own_time, steps, origin, written })
    }

    /// Appends one frame, with the rows of each run before it and the state of each in it.
    ///
    /// # Errors
    /// If it cannot be written; frames written before are kept.
    pub(crate) fn write<'s>(
        &mut self,
        frame: &Frame,
        between: &[Vec<TableRow>],
        states: impl Iterator<Item = &'s State>,
    ) -> Result<(), OutputError> {
        let mut record = Vec::with_capacity(self.record as usize);
        record.extend(frame.time.to_le_bytes());
        let course = &mut self.written.course;
        let runs = frame.runs.iter().zip(&self.own_time).zip(&mut course.runs);
        for (((run, &own_time), stored), state) in runs.zip(states) {
            if own_time {
                record.extend(run.snapshot.time.to_le_bytes());
            }
            let vectors = |vectors: &[DVec3]| vectors.iter().flat_map(vector_bytes).collect();
            let memory: Vec<_> = state.memory.shown().flat_map(|number| number.to_le_bytes()).collect();
            let rows: [Vec<u8>; 3] = [vectors(&state.position), vectors(&state.velocity), memory];
            for (digests, row) in stored.digests.iter_mut().zip(&rows) {
                digests.push(Sha256::digest(row).into());
                record.extend(row);
            }
            if let Status::Diverged(divergence) = state.status {
                stored.divergence = Some(divergence);
            }
        }
        assert_eq!(record.len() as u64, self.record, "every frame shows the runs that the file was begun for");
        self.spool.append(&record).map_err(OutputError::writing(&self.path))?;
        course.frames.push(frame.index);
        for (run, rows) in frame.runs.iter().zip(between) {
            self.written.rows.entry(run.run).or_default().extend(rows.iter().cloned());
        }
        Ok(())
    }

    /// Reads back a quantity, `position` or `velocity`, of some nodes of a run, by its place among the runs, in the frame with this
    /// place.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(super) fn read(
        &mut self,
        place: usize,
        quantity: &str,
        frame: usize,
        nodes: &Range<usize>,
    ) -> io::Result<Vec<DVec3>> {
        let name = format!("{}.{quantity}", self.written.course.runs[place].name);
        let array = self.arrays.iter().find(|array| array.name == name).ok_or(ErrorKind::NotFound)?;
        let mut bytes = vec![0; 24 * nodes.len()];
        let place = frame as u64 * self.record + array.offset + 24 * nodes.start as u64;
        self.spool.read_at(place, &mut bytes)?;
        let number = |bytes: &[u8; 8]| f64::from_le_bytes(*bytes);
        let vector =
            |bytes: &[u8; 24]| DVec3::from_slice(&bytes.as_chunks::<8>().0.iter().map(number).collect::<Vec<_>>());
        Ok(bytes.as_chunks::<24>().0.iter().map(vector).collect())
    }

    /// Stores the drawn state of a run, by its place among the runs, if the run diverges; see
    /// [`Frames::last_fit`](crate::runner::Frames::last_fit).
    pub(crate) fn set_last_fit(&mut self, place: usize, found: Option<Option<&State>>) {
        self.written.course.runs[place].last_fit = found.flatten().map(State::to_bytes);
    }

    /// Adds the time series of the scene.
    pub(crate) fn set_history(&mut self, history: History) {
        self.written.history = Some(history);
    }

    /// Makes the frames written so far survive a power failure.
    pub(crate) fn sync(&mut self) -> io::Result<(CourseSoFar, Grown)> {
        Ok((self.written.clone(), self.spool.sync()?))
    }

    /// Rearranges the frames written so far and renames the file to its final name.
    ///
    /// # Errors
    /// If the file cannot be written; it is then removed.
    pub(crate) fn finish(mut self) -> Result<(), OutputError> {
        let mut file = AtomicFile::create(&self.path)?;
        self.arrange(file.file()).map_err(OutputError::writing(&self.path))?;
        file.commit()
    }

    fn arrange(&mut self, file: &mut File) -> io::Result<()> {
        let mut archive = ZipWriter::new(BufWriter::new(file));
        match self.fill(&mut archive) {
            Ok(()) => archive.finish()?.flush(),
            Err(error) => {
                // If the writer is dropped unfinished, it tries to finish on the same disk and prints to standard
                // error.
                std::mem::forget(archive);
                Err(error)
            }
        }
    }

    fn fill(&mut self, archive: &mut ZipWriter<BufWriter<&mut File>>) -> io::Result<()> {
        let mut part = Vec::new();
        let CourseSoFar { course, .. } = &self.written;
        let frames = course.frames.len() as u64;
        for array in &self.arrays {
            let shape = format!("({frames},{})", array.shape);
            begin(archive, &array.name, "<f8", &shape, frames * array.length as u64)?;
            part.resize(array.length, 0);
            for frame in 0..frames {
                self.spool.read_at(frame * self.record + array.offset, &mut part)?;
                archive.write_all(&part)?;
            }
        }
        for (run, step) in course.runs.iter().zip(&self.steps) {
            put(archive, &format!("{}.step", run.name), "<f8", "()", &step.to_le_bytes())?;
        }
        for mesh in &self.meshes {
            fill_mesh(archive, mesh, self.names.len() > 1)?;
        }
        fill_names(archive, &self.names)?;
        let mut bytes = postcard::to_allocvec(&self.origin).expect("plain data");
        bytes.extend(postcard::to_allocvec(&self.written).expect("plain data"));
        put(archive, COURSE, "|u1", &format!("({},)", bytes.len()), &bytes)
    }
}

/// Writes the arrays of the bodies of a run, with the body of each node if there are `several`.
fn fill_mesh(archive: &mut ZipWriter<BufWriter<&mut File>>, mesh: &Mesh, several: bool) -> io::Result<()> {
    let Mesh { prefix, bodies, of } = mesh;
    let (body, nodes) = (&**bodies.whole(), bodies.whole().len());
    let name = |array: &str| format!("{prefix}{array}");
    let rest: Vec<u8> = body.rest().iter().flat_map(vector_bytes).collect();
    put(archive, &name("rest"), "<f8", &format!("({nodes}, 3)"), &rest)?;
    let mass: Vec<u8> = body.mass().iter().flat_map(|mass| mass.to_le_bytes()).collect();
    put(archive, &name("mass"), "<f8", &format!("({nodes},)"), &mass)?;
    fill_lists(archive, &name("elements"), 2, body.elements().iter())?;
    let faces = body.faces();
    let bounds = |&face: &usize| faces.inner[face].is_none() || faces.outer[face].is_none();
    fill_lists(archive, &name("faces"), 3, (0..faces.nodes.len()).filter(bounds).map(|face| &faces.nodes[face]))?;
    if several {
        let places = of.iter().enumerate().flat_map(|(at, &place)| bodies.nodes(at).map(move |_| place as i64));
        let places: Vec<u8> = places.flat_map(i64::to_le_bytes).collect();
        put(archive, &name("body"), "<i8", &format!("({nodes},)"), &places)?;
    }
    Ok(())
}

/// Writes the names of several bodies: characters of 32 bits, with zeros at the end of shorter names.
fn fill_names<'n>(archive: &mut ZipWriter<BufWriter<&mut File>>, names: &'n [String]) -> io::Result<()> {
    let Some(longest) = names.iter().map(|name| name.chars().count()).max() else { return Ok(()) };
    let padded = |name: &'n String| name.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest);
    let bytes: Vec<u8> = names.iter().flat_map(padded).flat_map(u32::to_le_bytes).collect();
    put(archive, "bodies", &format!("<U{longest}"), &format!("({},)", names.len()), &bytes)
}

/// Writes lists of nodes as rows of the same length, at least `least`.
fn fill_lists<'l>(
    archive: &mut ZipWriter<BufWriter<&mut File>>,
    name: &str,
    least: usize,
    lists: impl Iterator<Item = &'l [u32]> + Clone,
) -> io::Result<()> {
    let (rows, columns) = lists.clone().fold((0_usize, least), |(rows, most), list| (rows + 1, most.max(list.len())));
    let padded = |list: &'l [u32]| list.iter().map(|&node| node.into()).chain(std::iter::repeat(-1_i64)).take(columns);
    let bytes: Vec<u8> = lists.flat_map(padded).flat_map(i64::to_le_bytes).collect();
    put(archive, name, "<i8", &format!("({rows}, {columns})"), &bytes)
}

/// Writes a whole array.
fn put(
    archive: &mut ZipWriter<BufWriter<&mut File>>,
    name: &str,
    number: &str,
    shape: &str,
    bytes: &[u8],
) -> io::Result<()> {
    begin(archive, name, number, shape, bytes.len() as u64)?;
    archive.write_all(bytes)
}

/// The three coordinates, little-endian.
pub(super) fn vector_bytes(vector: &DVec3) -> [u8; 24] {
    let mut bytes = [0; 24];
    for (into, coordinate) in bytes.chunks_exact_mut(8).zip(vector.to_array()) {
        into.copy_from_slice(&coordinate.to_le_bytes());
    }
    bytes
}
