//! `states.npz`: a body, and its positions and velocities in every frame, for analysis in other programs.

use super::atomic::folder_of;
use super::{AtomicFile, OutputError};
use crate::scene::Scene;
use crate::sim::body::Body;
use crate::sim::snapshot::Frame;
use glam::DVec3;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The name of the file in its folder.
pub(crate) const STATES_FILE: &str = "states.npz";

/// Writes the states of frames, one after the other, with bounded memory.
///
/// The archive has `time` (F), the time of each frame (s), and for each run `NAME.position` (m) and `NAME.velocity`
/// (m/s), both F × N × 3, all little-endian double precision. Each run has the step nearest to a frame: `time` is that
/// of the first run, and a run with another time step has its own `NAME.time` (F). Scenes allow only names of runs that
/// are valid in an archive.
///
/// The body is stored once: `rest` (N × 3, m), `mass` (N, kg), and as 64-bit integers the nodes of each element,
/// `elements`, and of each face on the surface of the body, `faces`, with -1 at the end of shorter rows.
///
/// Arrays are consecutive in the archive but all grow with each frame, and the number of frames is known only at the
/// end. So frames are first written to an unnamed temporary file, one record each, and rearranged at the end, which
/// temporarily needs twice the disk space.
#[derive(Debug)]
pub(crate) struct StatesWriter {
    path: PathBuf,
    spool: File,
    body: Arc<Body>,
    arrays: Vec<Array>,
    /// Length of one frame in the temporary file (bytes).
    record: u64,
    /// For each run whether it has its own times.
    own_time: Vec<bool>,
    frames: u64,
}

/// One array of the archive, and the position of its part in each record.
#[derive(Debug)]
struct Array {
    name: String,
    /// The dimensions after the number of frames, in Python's notation.
    shape: String,
    /// Offset in a record (bytes).
    offset: u64,
    /// Length in a record (bytes).
    length: usize,
}

impl StatesWriter {
    /// Creates the file in `folder`, for frames that show `runs`, indices into the scene's runs.
    ///
    /// # Errors
    /// If the folder cannot be written to.
    pub(crate) fn create(folder: &Path, scene: &Scene, runs: &[usize]) -> Result<Self, OutputError> {
        let path = folder.join(STATES_FILE);
        let spool = tempfile::tempfile_in(folder_of(&path)).map_err(OutputError::writing(&path))?;
        let nodes = scene.body.len();
        let mut arrays = vec![Array { name: "time".to_owned(), shape: String::new(), offset: 0, length: 8 }];
        let mut record = 8;
        let step = |run: usize| scene.runs[run].step;
        let own_time: Vec<bool> = runs.iter().map(|&run| step(run) != step(runs[0])).collect();
        for (&run, &own_time) in runs.iter().zip(&own_time) {
            if own_time {
                let name = format!("{}.time", scene.runs[run].name);
                arrays.push(Array { name, shape: String::new(), offset: record, length: 8 });
                record += 8;
            }
            for quantity in ["position", "velocity"] {
                let length = 24 * nodes;
                let name = format!("{}.{quantity}", scene.runs[run].name);
                arrays.push(Array { name, shape: format!(" {nodes}, 3"), offset: record, length });
                record += length as u64;
            }
        }
        Ok(Self { path, spool, body: Arc::clone(&scene.body), arrays, record, own_time, frames: 0 })
    }

    /// Appends one frame.
    ///
    /// # Errors
    /// If it cannot be written; frames written before are kept.
    pub(crate) fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        let mut record = Vec::with_capacity(self.record as usize);
        record.extend(frame.time.to_le_bytes());
        for (run, &own_time) in frame.runs.iter().zip(&self.own_time) {
            if own_time {
                record.extend(run.snapshot.time.to_le_bytes());
            }
            for vector in run.snapshot.position.iter().chain(&run.snapshot.velocity) {
                record.extend(vector_bytes(vector));
            }
        }
        assert_eq!(record.len() as u64, self.record, "every frame shows the runs that the file was begun for");
        self.spool.write_all(&record).map_err(OutputError::writing(&self.path))?;
        self.frames += 1;
        Ok(())
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
        for array in &self.arrays {
            let shape = format!("({},{})", self.frames, array.shape);
            begin(archive, &array.name, "<f8", &shape, self.frames * array.length as u64)?;
            part.resize(array.length, 0);
            for frame in 0..self.frames {
                self.spool.seek(SeekFrom::Start(frame * self.record + array.offset))?;
                self.spool.read_exact(&mut part)?;
                archive.write_all(&part)?;
            }
        }
        fill_body(archive, &self.body)
    }
}

/// Writes the arrays of a body.
fn fill_body(archive: &mut ZipWriter<BufWriter<&mut File>>, body: &Body) -> io::Result<()> {
    let nodes = body.len();
    begin(archive, "rest", "<f8", &format!("({nodes}, 3)"), 24 * nodes as u64)?;
    body.rest.iter().try_for_each(|rest| archive.write_all(&vector_bytes(rest)))?;
    begin(archive, "mass", "<f8", &format!("({nodes},)"), 8 * nodes as u64)?;
    body.mass.iter().try_for_each(|mass| archive.write_all(&mass.to_le_bytes()))?;
    fill_lists(archive, "elements", 2, body.elements.iter())?;
    let faces = &body.faces;
    let bounds = |&face: &usize| faces.inner[face].is_none() || faces.outer[face].is_none();
    fill_lists(archive, "faces", 3, (0..faces.nodes.len()).filter(bounds).map(|face| &faces.nodes[face]))
}

/// Writes lists of nodes as rows of the same length, at least `least`.
fn fill_lists<'l>(
    archive: &mut ZipWriter<BufWriter<&mut File>>,
    name: &str,
    least: usize,
    lists: impl Iterator<Item = &'l [u32]> + Clone,
) -> io::Result<()> {
    let (rows, columns) = lists.clone().fold((0, least), |(rows, most), list| (rows + 1, most.max(list.len())));
    begin(archive, name, "<i8", &format!("({rows}, {columns})"), 8 * rows * columns as u64)?;
    for list in lists {
        let padded = list.iter().map(|&node| node.into()).chain(std::iter::repeat(-1_i64)).take(columns);
        archive.write_all(&padded.flat_map(i64::to_le_bytes).collect::<Vec<_>>())?;
    }
    Ok(())
}

/// Begins an array of `length` bytes in the archive; its numbers are written next.
fn begin(
    archive: &mut ZipWriter<BufWriter<&mut File>>,
    name: &str,
    number: &str,
    shape: &str,
    bytes: u64,
) -> io::Result<()> {
    let header = header(number, shape);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .large_file(header.len() as u64 + bytes >= u64::from(u32::MAX));
    archive.start_file(format!("{name}.npy"), options)?;
    archive.write_all(&header)
}

/// The header of an array in NumPy's file format, version 1.0, for a number type and a shape in Python's notation.
fn header(number: &str, shape: &str) -> Vec<u8> {
    let mut text = format!("{{'descr': '{number}', 'fortran_order': False, 'shape': {shape}, }}");
    // There are ten bytes before the text; the data begin at a multiple of 64.
    let unpadded = 10 + text.len() + 1;
    text.extend(std::iter::repeat_n(' ', unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    let length = u16::try_from(text.len()).expect("a short text");
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend(length.to_le_bytes());
    header.extend(text.bytes());
    header
}

/// The three coordinates, little-endian.
pub(super) fn vector_bytes(vector: &DVec3) -> [u8; 24] {
    let mut bytes = [0; 24];
    for (into, coordinate) in bytes.chunks_exact_mut(8).zip(vector.to_array()) {
        into.copy_from_slice(&coordinate.to_le_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_is_aligned() {
        for shape in ["(181,)", "(181, 64, 3)", "(181, 1000000, 3)"] {
            let header = header("<f8", shape);
            assert_eq!(header.len() % 64, 0);
            assert_eq!(usize::from(header[8]) + 256 * usize::from(header[9]), header.len() - 10);
            assert_eq!(header.last(), Some(&b'\n'));
        }
    }
}
