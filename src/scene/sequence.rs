//! Sequences of files of single moments: VTK's grids with a list of their times (`.pvd`), or files with numbers in their names.
//! They are copied into an archive like those of NumPy, so that recordings have one form.

use super::limits::Limits;
use super::npy::begin;
use super::npz::Npz;
use super::recording::Flaw;
use crate::reading::beside::{self, Wrong};
use crate::reading::words::count;
use glam::DVec3;
use localshape_mesh::{self as mesh, Cells, Format};
use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
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
    /// Positions and velocities of all points, times, and the time step.
    pub(super) archive: Npz,
    /// The points and cells of the first moment, as its files list them.
    pub(super) cells: Cells,
    /// Whether these cells are elements. Surfaces have faces only.
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
        let first = Moment::read(&moments[0], limits)?;
        let [frames, nodes] = [moments.len(), first.cells.points.len()].map(|length| length as u64);
        // As many as 64 bits can count bytes of.
        let most = limits.recorded.min(u64::MAX / 48);
        if frames.saturating_mul(nodes) > most {
            let [frames, nodes, most] = [frames, nodes, most].map(|number| count(number.into()));
            let message = format!("has {frames} moments of {nodes} points; the limit is {most} points in all moments");
            let help = "list fewer moments, or allow it with --allow-large (in code, `Limits::NONE`)";
            return Err(Flaw::new("", message).with_help(help));
        }
        let archive = copied(&moments, &first, step, limits)?;
        let has_elements = !first.is_surface && !first.cells.kinds.is_empty();
        Ok(Self { archive, cells: first.cells, has_elements })
    }
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
    // The files and parts of the last moment.
    let mut known = HashSet::new();
    for mesh::Listed { time, file, part } in &all {
        // Files of one time are bodies of one moment, until a file or a part comes again.
        let mut is_new = |key| known.insert(key);
        let is_other = is_new(Ok(file)) & part.as_ref().is_none_or(|part| is_new(Err(part)));
        match moments.last_mut().filter(|last| last.time == *time && is_other) {
            Some(last) => last.files.push(beside.join(file)),
            None => {
                moments.push(Listed { time: *time, files: vec![beside.join(file)] });
                known = HashSet::from_iter([Ok(file)].into_iter().chain(part.as_ref().map(Err)));
            }
        }
    }
    Ok((moments, step_in(&bytes)))
}

/// The moments in files with numbers in place of the star in a name.
fn numbered(folder: &Path, pattern: &str, rate: f64) -> Result<Vec<Listed>, Flaw> {
    let path = folder.join(pattern);
    let (within, name) = (path.parent().unwrap_or(folder), path.file_name().unwrap_or_default().to_string_lossy());
    let Some((before, after)) = name.split_once('*').filter(|_| pattern.matches('*').count() == 1) else {
        let help = "expected one star, in the name of the file, as in frames/*.obj";
        return Err(Flaw::new("", "does not name numbered files").with_help(help));
    };
    // The folder of a scene may have no name.
    let within = if within.as_os_str().is_empty() { Path::new(".") } else { within };
    let entries = beside::entries(within)
        .map_err(|error| Flaw::new("", format!("cannot be read: {error} (looked for {})", within.display())))?;
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
        let help = "expected files with numbers in place of the star, such as frame_00000.obj";
        return Err(Flaw::new("", format!("names no file (looked in {})", within.display())).with_help(help));
    };
    if let Some((_, other, _)) = found.iter().find(|(_, other, _)| *other != stem) {
        let message = format!("names several sequences, {before}{stem}… and {before}{other}…; expected one");
        return Err(Flaw::new("", message).with_help("write more of the name before the star"));
    }
    if let Some(pair) = found.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let [one, other] = [&pair[0].2, &pair[1].2].map(|path| name_of(path));
        return Err(Flaw::new("", format!("names two files of one number, {one} and {other}; expected one")));
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
    /// The name of its file, or of the first of them.
    name: String,
    /// Its time (s).
    time: f64,
    step: Option<f64>,
    /// The points and cells of all its files.
    cells: Cells,
    is_surface: bool,
}

impl Moment {
    fn read(listed: &Listed, limits: &Limits) -> Result<Self, Flaw> {
        let first = name_of(&listed.files[0]);
        let name = if listed.files.len() == 1 { first } else { format!("{first} and others") };
        let mut moment = Self { name, time: listed.time, ..Self::default() };
        for (at, path) in listed.files.iter().enumerate() {
            let name = name_of(path);
            let told = |(message, help): Wrong| Flaw { place: name.clone(), message, help };
            let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
            let Some(format) = FORMATS.into_iter().find(|format| format.endings().contains(&&*ending)) else {
                return Err(Flaw::new(&name, "is neither a grid (.vtu, .vtp) nor a surface (.obj)"));
            };
            let bytes = beside::bytes(path, &[&*ending], limits.file, "a moment", "expected a file").map_err(told)?;
            let most = |limit: u64| usize::try_from(limit).unwrap_or(usize::MAX).min(u32::MAX as usize);
            let limits = mesh::Limits { points: most(limits.nodes), corners: most(limits.corners) };
            let cells = mesh::read_cells(&bytes, format, &limits).map_err(|error| told((error.message, error.help)))?;
            if format == Format::Obj {
                moment.is_surface = true;
                moment.time = number_in(&bytes, TIME).unwrap_or(moment.time);
                moment.step = step_in(&bytes);
            }
            let corners = moment.cells.corners.indices().len() + cells.corners.indices().len();
            if moment.cells.points.len() + cells.points.len() > limits.points || corners > limits.corners {
                let most = count(limits.points as u128);
                let message = format!("brings its moment to more points or cells than are allowed, {most} points");
                return Err(
                    Flaw::new(&name, message).with_help("allow it with --allow-large (in code, `Limits::NONE`)")
                );
            }
            if at == 0 {
                moment.cells = cells;
            } else {
                append(&mut moment.cells, cells);
            }
        }
        match moment.cells.points.is_empty() {
            true => Err(Flaw::new(moment.name, "has no points")),
            false => Ok(moment),
        }
    }

    /// Refuses a moment that is not one of the same body after another.
    fn check_after(&self, before: &Self) -> Result<(), Flaw> {
        let [found, expected] = [self, before].map(|one| count(one.cells.points.len() as u128));
        let (name, time) = (&before.name, self.time);
        let (message, help) = match () {
            () if found != expected => {
                (format!("has {found} points, and {name} has {expected}; expected the same in each moment"), None)
            }
            () if self.cells.kinds != before.cells.kinds || self.cells.corners != before.cells.corners => {
                (format!("has other cells than {name}; expected the same in each moment"), None)
            }
            () if self.cells.velocities.is_none() && before.cells.velocities.is_some() => {
                ("has no `velocity` for each point, and files before it have".to_owned(), None)
            }
            () if time < before.time => {
                (format!("is at {time} s, after {name} at {} s; expected rising times", before.time), None)
            }
            // Frames nearer than a time step have one state.
            () if time == before.time && self.cells != before.cells => (
                format!("is at {time} s in another state than {name}; expected rising times"),
                Some("if they are bodies of one moment, list them in a .pvd file with a `part` each".to_owned()),
            ),
            () => return Ok(()),
        };
        Err(Flaw { place: self.name.clone(), message, help })
    }
}

/// Appends the points and cells of another file.
fn append(all: &mut Cells, other: Cells) {
    all.corners.append(&other.corners, all.points.len() as u32);
    all.kinds.extend(other.kinds);
    all.points.extend(other.points);
    match (&mut all.velocities, other.velocities) {
        (Some(all), Some(other)) => all.extend(other),
        (velocities, _) => *velocities = None,
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

/// The archive of some moments, of which the first is read. Velocities wait in a file of their own until all positions are there.
fn copied(moments: &[Listed], first: &Moment, step: Option<f64>, limits: &Limits) -> Result<Npz, Flaw> {
    let failed = |error: io::Error| Flaw::new("", format!("cannot be brought into one file: {error}"));
    let (frames, nodes) = (moments.len(), first.cells.points.len());
    let shape = format!("({frames}, {nodes}, 3)");
    let length = 24 * (frames * nodes) as u64;
    let mut zip = ZipWriter::new(BufWriter::new(tempfile::tempfile().map_err(failed)?));
    let mut velocities = BufWriter::new(tempfile::tempfile().map_err(failed)?);
    let (mut times, moves) = (Vec::new(), first.cells.velocities.is_some());
    begin(&mut zip, "position", "<f8", &shape, length).map_err(failed)?;
    let mut copy = |moment: &Moment| -> io::Result<()> {
        times.push(moment.time);
        moment.cells.points.iter().try_for_each(|point| vector(&mut zip, point))?;
        // Either all moments have velocities or none.
        let mut all = moment.cells.velocities.iter().filter(|_| moves).flatten();
        all.try_for_each(|one| vector(&mut velocities, one))
    };
    copy(first).map_err(failed)?;
    let mut last = None;
    for listed in &moments[1..] {
        let moment = Moment::read(listed, limits)?;
        moment.check_after(last.as_ref().unwrap_or(first))?;
        copy(&moment).map_err(failed)?;
        last = Some(moment);
    }
    let rest = || -> io::Result<File> {
        if moves {
            begin(&mut zip, "velocity", "<f8", &shape, length)?;
            let mut velocities = velocities.into_inner()?;
            velocities.rewind()?;
            io::copy(&mut velocities, &mut zip)?;
        }
        begin(&mut zip, "time", "<f8", &format!("({frames},)"), 8 * frames as u64)?;
        times.iter().try_for_each(|time| zip.write_all(&time.to_le_bytes()))?;
        if let Some(step) = step.or(first.step) {
            begin(&mut zip, "step", "<f8", "()", 8)?;
            zip.write_all(&step.to_le_bytes())?;
        }
        Ok(zip.finish()?.into_inner()?)
    };
    Npz::of(rest().map_err(failed)?).map_err(|message| Flaw::new("", message))
}

fn vector(to: &mut impl Write, vector: &DVec3) -> io::Result<()> {
    vector.to_array().into_iter().try_for_each(|number| to.write_all(&number.to_le_bytes()))
}
