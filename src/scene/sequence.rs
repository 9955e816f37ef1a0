//! Sequences of files of single moments: VTK's grids with a list of their times (`.pvd`), or files with numbers in their names.
//! They are brought into an archive like those of NumPy, so that recordings have one form.

use super::limits::Limits;
use super::npy::begin;
use super::recording::Flaw;
use crate::reading::beside::{self, Wrong};
use crate::reading::words::count;
use crate::sim::IndexLists;
use glam::DVec3;
use localshape_mesh::{self as mesh, CellKind, Cells, Format};
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;
use zip::ZipWriter;

/// The formats of single moments.
const FORMATS: [Format; 2] = [Format::Obj, Format::Vtu];
/// The comments by which this program tells the time of a surface, and the time step of the run of surfaces and of lists (s).
const TIME: &str = "# time ";
const STEPS: [&str; 2] = ["# step ", "<!-- step "];
/// Where these comments are searched for (bytes).
const HEAD: usize = 1024;

/// A sequence as an archive.
#[derive(Debug)]
pub(super) struct Sequence {
    pub(super) archive: NamedTempFile,
    /// Whether its elements are those of the file. Surfaces have faces only.
    pub(super) has_elements: bool,
}

/// Whether the name of recorded states is that of a sequence.
pub(super) fn is_one(file: &str) -> bool {
    file.contains('*') || file.to_lowercase().ends_with(".pvd")
}

impl Sequence {
    /// Reads all files of a sequence in a folder. Those with numbers follow each other at a rate (1/s), and the first is at the start.
    pub(super) fn read(folder: &Path, file: &str, rate: f64, limits: &Limits) -> Result<Self, Flaw> {
        let (moments, step) =
            if file.contains('*') { (numbered(folder, file, rate)?, None) } else { listed(folder, file, limits)? };
        let failed = |error: io::Error| flaw("", format!("cannot be brought into one file: {error}"));
        let mut archive = NamedTempFile::new().map_err(failed)?;
        let mut velocities = tempfile::tempfile().map_err(failed)?;
        let has_elements = write(&mut archive, &mut velocities, file, (&moments, step), limits)?;
        Ok(Self { archive, has_elements })
    }
}

fn flaw(place: impl Into<String>, message: impl Into<String>) -> Flaw {
    Flaw { place: place.into(), message: message.into(), help: None }
}

/// Files of one moment, one for each body.
struct Listed {
    /// The time (s), unless the file tells it.
    time: f64,
    files: Vec<PathBuf>,
}

/// The moments in a list of VTK's files, and the time step (s) if the list tells it.
fn listed(folder: &Path, file: &str, limits: &Limits) -> Result<(Vec<Listed>, Option<f64>), Flaw> {
    let path = folder.join(file);
    let told = |(message, help): Wrong| Flaw { place: String::new(), message, help };
    let bytes =
        beside::bytes(&path, &["pvd"], limits.file, "a list", "expected a list of grids (.pvd)").map_err(told)?;
    let all = mesh::read_list(&bytes).map_err(|error| told((error.message, error.help)))?;
    let beside = path.parent().unwrap_or(Path::new(""));
    let mut moments: Vec<Listed> = Vec::new();
    for mesh::Listed { time, file } in all {
        let file = beside.join(file);
        match moments.last_mut().filter(|last| last.time == time) {
            // Frames nearer than a time step are of one moment.
            Some(last) if last.files.contains(&file) => {}
            Some(last) => last.files.push(file),
            None => moments.push(Listed { time, files: vec![file] }),
        }
    }
    Ok((moments, step_in(&bytes)))
}

/// The moments in files with numbers in place of the star in a name.
fn numbered(folder: &Path, pattern: &str, rate: f64) -> Result<Vec<Listed>, Flaw> {
    let path = folder.join(pattern);
    let (within, name) = (path.parent().unwrap_or(folder), path.file_name().unwrap_or_default().to_string_lossy());
    let Some((before, after)) = name.split_once('*').filter(|_| pattern.matches('*').count() == 1) else {
        let help = "expected one star, in the name of the file, as in frames/*.obj".to_owned();
        return Err(Flaw { help: Some(help), ..flaw("", "does not name numbered files") });
    };
    let entries = beside::entries(within)
        .map_err(|error| flaw("", format!("cannot be read: {error} (looked for {})", within.display())))?;
    let number = |entry: PathBuf| {
        let name = entry.file_name()?.to_str()?.to_owned();
        let inner = name.strip_prefix(before)?.strip_suffix(after)?;
        // A name may have further words before its number.
        let stem = inner.trim_end_matches(|c: char| c.is_ascii_digit());
        Some((inner[stem.len()..].parse::<u64>().ok()?, stem.to_owned(), entry))
    };
    let mut found: Vec<(u64, String, PathBuf)> = entries.into_iter().filter_map(number).collect();
    found.sort();
    let Some((first, stem, _)) = found.first().cloned() else {
        let help = "expected files with numbers in place of the star, such as frame_00000.obj".to_owned();
        return Err(Flaw { help: Some(help), ..flaw("", format!("names no file (looked in {})", within.display())) });
    };
    if let Some((_, other, _)) = found.iter().find(|(_, other, _)| *other != stem) {
        let message = format!("names several sequences, {before}{stem}… and {before}{other}…; expected one");
        return Err(Flaw { help: Some("write more of the name before the star".to_owned()), ..flaw("", message) });
    }
    if let Some(pair) = found.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let [one, other] = [&pair[0].2, &pair[1].2].map(|path| name_of(path));
        return Err(flaw("", format!("names two files of one number, {one} and {other}; expected one")));
    }
    let moment = |(number, _, file)| Listed { time: (number - first) as f64 / rate, files: vec![file] };
    Ok(found.into_iter().map(moment).collect())
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A moment as read.
#[derive(Default)]
struct Moment {
    time: Option<f64>,
    step: Option<f64>,
    points: Vec<DVec3>,
    velocities: Vec<DVec3>,
    /// The cells of each file.
    cells: Vec<Cells>,
    is_surface: bool,
}

impl Moment {
    fn read(listed: &Listed, limits: &Limits) -> Result<Self, Flaw> {
        let mut moment = Self::default();
        for path in &listed.files {
            let name = name_of(path);
            let told = |(message, help): Wrong| Flaw { place: name.clone(), message, help };
            let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
            let Some(format) = FORMATS.into_iter().find(|format| format.endings().contains(&&*ending)) else {
                return Err(flaw(&name, "is neither a grid (.vtu, .vtp) nor a surface (.obj)"));
            };
            let bytes = beside::bytes(path, &[&*ending], limits.file, "a moment", "expected a file").map_err(told)?;
            let most = |limit: u64| usize::try_from(limit).unwrap_or(usize::MAX).min(u32::MAX as usize);
            let limits = mesh::Limits { points: most(limits.nodes), corners: most(limits.corners) };
            let cells = mesh::read_cells(&bytes, format, &limits).map_err(|error| told((error.message, error.help)))?;
            if format == Format::Obj {
                moment.is_surface = true;
                moment.time = number_in(&bytes, TIME);
                moment.step = step_in(&bytes);
            }
            let corners: usize = moment.cells.iter().chain([&cells]).map(|cells| cells.corners.indices().len()).sum();
            if moment.points.len() + cells.points.len() > limits.points || corners > limits.corners {
                let most = count(limits.points as u128);
                return Err(flaw(
                    &name,
                    format!("brings its moment to more points or cells than are allowed, {most} points"),
                ));
            }
            moment.points.extend(&cells.points);
            moment.velocities.extend(cells.velocities.iter().flatten());
            moment.cells.push(cells);
        }
        Ok(moment)
    }

    /// The velocities, if each point has one.
    fn velocities(&self) -> Option<&[DVec3]> {
        Some(&self.velocities[..]).filter(|all| all.len() == self.points.len() && !all.is_empty())
    }

    /// The nodes of its elements. Faces in space become triangles.
    fn elements(&self) -> IndexLists {
        let is_plane = self.points.iter().all(|point| point.z == 0.0);
        let (mut elements, mut first) = (IndexLists::default(), 0);
        for cells in &self.cells {
            for (kind, corners) in cells.kinds.iter().zip(cells.corners.iter()) {
                let corners: Vec<u32> = corners.iter().map(|corner| first + corner).collect();
                match kind {
                    CellKind::Point => {}
                    CellKind::Line => corners.windows(2).for_each(|pair| elements.push(pair)),
                    CellKind::Polygon if !is_plane => {
                        let fan = (2..corners.len()).map(|at| [corners[0], corners[at - 1], corners[at]]);
                        fan.for_each(|triangle| elements.push(&triangle));
                    }
                    _ => elements.push(&corners),
                }
            }
            first += cells.points.len() as u32;
        }
        elements
    }
}

/// The number in a comment in the head of a file.
fn number_in(bytes: &[u8], comment: &str) -> Option<f64> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
    let words = head.lines().find_map(|line| line.strip_prefix(comment))?;
    words.split_whitespace().next()?.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The time step (s) that a file tells.
fn step_in(bytes: &[u8]) -> Option<f64> {
    STEPS.iter().find_map(|comment| number_in(bytes, comment)).filter(|step| *step > 0.0)
}

/// Writes the archive, with velocities in a file of their own until all positions are known. Returns whether the elements are those of
/// the files.
fn write(
    archive: &mut NamedTempFile,
    velocities: &mut File,
    file: &str,
    (moments, step): (&[Listed], Option<f64>),
    limits: &Limits,
) -> Result<bool, Flaw> {
    let failed = |error: io::Error| flaw("", format!("cannot be brought into one file: {error}"));
    let first = Moment::read(&moments[0], limits)?;
    let (frames, nodes) = (moments.len(), first.points.len());
    let shape = format!("({frames}, {nodes}, 3)");
    let length = 24 * (frames * nodes) as u64;
    let mut zip = ZipWriter::new(BufWriter::new(archive.as_file_mut()));
    let mut spool = BufWriter::new(&mut *velocities);
    begin(&mut zip, "position", "<f8", &shape, length).map_err(failed)?;
    let (mut times, mut has_velocities) = (Vec::new(), true);
    for (at, listed) in moments.iter().enumerate() {
        let name = || listed.files.iter().map(|path| name_of(path)).collect::<Vec<_>>().join(", ");
        let moment = Moment::read(listed, limits)?;
        if moment.points.len() != nodes {
            let [found, expected] = [moment.points.len(), nodes].map(|points| count(points as u128));
            let before = moments[0].files.iter().map(|path| name_of(path)).collect::<Vec<_>>().join(", ");
            let message = format!("has {found} points, and {before} has {expected}; expected the same in each moment");
            return Err(flaw(name(), message));
        }
        let is_alike = |(one, other): (&Cells, &Cells)| one.kinds == other.kinds && one.corners == other.corners;
        if !moment.cells.iter().zip(&first.cells).all(is_alike) {
            let before = moments[0].files.iter().map(|path| name_of(path)).collect::<Vec<_>>().join(", ");
            let message = format!("has other cells than {before}; expected the same in each moment");
            return Err(flaw(name(), message));
        }
        let time = moment.time.unwrap_or(listed.time);
        if let Some(before) = times.last().filter(|before| time <= **before) {
            return Err(flaw(name(), format!("is at {time} s, after {before} s; expected rising times")));
        }
        times.push(time);
        moment.points.iter().try_for_each(|point| vector(&mut zip, point)).map_err(failed)?;
        // Either all moments have velocities or none.
        match moment.velocities().filter(|_| has_velocities) {
            Some(all) => all.iter().try_for_each(|one| vector(&mut spool, one)).map_err(failed)?,
            None if at > 0 && has_velocities => {
                return Err(flaw(name(), "has no `velocity` for each point, and files before it have".to_owned()));
            }
            None => has_velocities = false,
        }
    }
    spool.flush().map_err(failed)?;
    drop(spool);
    let rest = || -> io::Result<()> {
        if has_velocities {
            begin(&mut zip, "velocity", "<f8", &shape, length)?;
            velocities.rewind()?;
            io::copy(velocities, &mut zip)?;
        }
        begin(&mut zip, "time", "<f8", &format!("({frames},)"), 8 * frames as u64)?;
        times.iter().try_for_each(|time| zip.write_all(&time.to_le_bytes()))?;
        if let Some(step) = step.or(first.step) {
            begin(&mut zip, "step", "<f8", "()", 8)?;
            zip.write_all(&step.to_le_bytes())?;
        }
        let elements = first.elements();
        if !elements.is_empty() {
            begin(&mut zip, "rest", "<f8", &format!("({nodes}, 3)"), 24 * nodes as u64)?;
            first.points.iter().try_for_each(|point| vector(&mut zip, point))?;
            let (rows, columns) = (elements.len(), elements.iter().map(<[u32]>::len).max().unwrap_or(0));
            if (rows * columns) as u64 > limits.corners {
                return Err(io::Error::other(format!("one of its {rows} cells has {columns} points")));
            }
            begin(&mut zip, "elements", "<i8", &format!("({rows}, {columns})"), 8 * (rows * columns) as u64)?;
            for list in elements.iter() {
                let padded = list.iter().map(|&node| node.into()).chain(std::iter::repeat(-1_i64)).take(columns);
                zip.write_all(&padded.flat_map(i64::to_le_bytes).collect::<Vec<_>>())?;
            }
        }
        // The name of the file, as recordings of one file have it.
        let shown = name_of(Path::new(file));
        let letters: Vec<char> = shown.chars().take(80).collect();
        begin(&mut zip, "engine", &format!("<U{}", letters.len()), "()", 4 * letters.len() as u64)?;
        zip.write_all(&letters.into_iter().flat_map(|letter| u32::from(letter).to_le_bytes()).collect::<Vec<_>>())?;
        zip.finish()?.flush()
    };
    rest().map_err(failed)?;
    Ok(!first.is_surface)
}

fn vector(to: &mut impl Write, vector: &DVec3) -> io::Result<()> {
    vector.to_array().into_iter().try_for_each(|number| to.write_all(&number.to_le_bytes()))
}
