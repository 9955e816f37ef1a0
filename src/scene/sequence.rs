//! Sequences of files of single moments: lists of files with their times (`.pvd`, `.series`), or files with numbers in their names.
//! They are copied into an archive like those of NumPy, so that recordings have one form.

use super::limits::Limits;
use super::npy::begin;
use super::npz::Npz;
use super::recording::{Flaw, check_length};
use crate::reading::beside::{self, Wrong, ending, name_of};
use crate::reading::words::{count, list, short};
use glam::DVec3;
use localshape_mesh::{self as mesh, Cells, Format};
use serde::Deserialize;
use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use zip::ZipWriter;

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
    /// Warnings: predicates of sentences about the sequence, with remedies.
    pub(super) notes: Vec<Wrong>,
}

/// Whether the name of recorded states is that of a sequence.
pub(super) fn is_one(file: &str) -> bool {
    let file = file.to_lowercase();
    file.contains('*') || file.ends_with(".pvd") || file.ends_with(".series")
}

impl Sequence {
    /// Reads all files of a sequence in a folder. Those with numbers follow each other at a rate (1/s), and the first is at the start.
    pub(super) fn read(folder: &Path, file: &str, rate: f64, limits: &Limits) -> Result<Self, Flaw> {
        let mut notes = Vec::new();
        let (moments, step) = match file.contains('*') {
            true => (numbered(folder, file, rate)?, None),
            false => listed(folder, file, limits, &mut notes)?,
        };
        let first = ReadMoment::read(&moments[0], limits)?;
        check_length(moments.len() as u64, first.cells.points.len() as u64, limits)?;
        let waits = waiting(&moments, &first, limits)?;
        let (archive, moves) = copied(&moments, &first, step, &waits, limits)?;
        let note = match moments.len() {
            1 if first.cells.displacements.is_some() => Some((
                "has one moment, to whose points its array `displacement` or `U` is not added".to_owned(),
                "add it in the program that wrote it, or list the moment at rest before it",
            )),
            1 => None,
            _ if waits.contains(&true) => Some((
                format!(
                    "has points that do not move, to which their array `displacement` or `U` is added{}",
                    first.without_displacements()
                ),
                "give the array another name if it is no displacement",
            )),
            moments if !moves => Some((
                format!("does not move: its {moments} moments have the same points"),
                "unless it stands still, write moved points, or, in VTK's files, their displacements as an array `displacement`",
            )),
            _ => None,
        };
        notes.extend(note.map(|(message, help)| (message, Some(help.to_owned()))));
        let has_elements = !first.is_surface && !first.cells.kinds.is_empty();
        Ok(Self { archive, cells: first.cells, has_elements, notes })
    }
}

/// Files of one moment, one for each body.
struct Listed {
    /// The time (s), unless the file tells it.
    time: f64,
    files: Vec<PathBuf>,
}

/// ParaView's list of files in JSON (`.vtu.series`).
#[derive(Deserialize)]
struct SeriesFile {
    files: Vec<SeriesEntry>,
}

/// A file of such a list.
#[derive(Deserialize)]
struct SeriesEntry {
    name: String,
    /// Its time (s).
    time: f64,
}

/// The files in a list in JSON.
fn series(bytes: &[u8]) -> Result<Vec<mesh::Listed>, Wrong> {
    const EXPECTED: &str = "expected { \"files\": [{ \"name\": \"a.vtu\", \"time\": 0 }] }";
    let wrong = |found: String| (format!("{found}; {EXPECTED}"), None);
    let SeriesFile { files } =
        serde_json::from_slice(bytes).map_err(|error| wrong(format!("is no list of files over time: {error}")))?;
    if files.is_empty() {
        return Err(wrong("lists no file".to_owned()));
    }
    Ok(files.into_iter().map(|SeriesEntry { name, time }| mesh::Listed { time, file: name, part: None }).collect())
}

/// The moments in a list of files in the order of their times, and the time step (s) if the list tells it.
fn listed(
    folder: &Path,
    file: &str,
    limits: &Limits,
    notes: &mut Vec<Wrong>,
) -> Result<(Vec<Listed>, Option<f64>), Flaw> {
    let path = folder.join(file);
    let told = |(message, help): Wrong| Flaw { place: String::new(), message, help };
    let expected = "expected a list of files over time (.pvd, .series)";
    let bytes = beside::bytes(&path, &["pvd", "series"], limits.file, "a list", expected).map_err(told)?;
    let all = match file.to_lowercase().ends_with(".pvd") {
        true => mesh::read_list(&bytes).map_err(|error| (error.message, error.help)),
        false => series(&bytes),
    }
    .map_err(told)?;
    Ok((in_order(&all, &path, notes), step_in(&bytes)))
}

/// The moments of the files in a list, in the order of their times.
fn in_order(all: &[mesh::Listed], path: &Path, notes: &mut Vec<Wrong>) -> Vec<Listed> {
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&one, &other| all[one].time.total_cmp(&all[other].time));
    let mut moments: Vec<Listed> = Vec::new();
    // Where the list begins again after a restart, the time of the first one, and the number of moments left out.
    let (mut begin, mut restart, mut left_out) = (0, None, 0);
    let times: Vec<&[usize]> = order.chunk_by(|&one, &other| all[one].time == all[other].time).collect();
    // A run that was started again has some times once.
    let is_even = times.iter().all(|of_time| of_time.len() == times[0].len());
    let mut shares_part = false;
    for of_time in times {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        // The files and parts of the last moment.
        let mut known = HashSet::new();
        for &at in of_time {
            let keys = || [Ok(&all[at].file)].into_iter().chain(all[at].part.as_ref().map(Err));
            // Files of one time are bodies of one moment, until a file or a part comes again.
            let comes_again = keys().any(|key| known.contains(&key));
            let last = groups.last().and_then(|group| group.last());
            let is_body = is_even && last.is_some_and(|last| last + 1 != at) && !known.contains(&Ok(&all[at].file));
            shares_part |= comes_again && is_body;
            if groups.is_empty() || comes_again && !is_body {
                groups.push(Vec::new());
                known.clear();
            }
            known.extend(keys());
            groups.last_mut().into_iter().for_each(|group| group.push(at));
        }
        // A moment that comes again after others is that of a run that was started again there.
        for pair in groups.windows(2).filter(|pair| pair[0].last().is_some_and(|last| last + 1 != pair[1][0])) {
            begin = begin.max(pair[1][0]);
            restart = restart.or(Some(all[begin].time));
        }
        let number = groups.len();
        groups.retain(|group| group[0] >= begin);
        left_out += number - groups.len();
        let beside = |&at: &usize| listed_path(path, &all[at].file);
        let moment = |group: Vec<usize>| Listed { time: all[group[0]].time, files: group.iter().map(beside).collect() };
        moments.extend(groups.into_iter().map(moment));
    }
    notes.extend(shares_part.then(|| {
        let message =
            "has one `part` for several files of each time, which are taken as bodies of one moment".to_owned();
        (message, Some("give each body a `part` of its own, or list each moment once".to_owned()))
    }));
    notes.extend(restart.map(|time| {
        let (plural, time) = (if left_out == 1 { " is" } else { "s are" }, short(time));
        let message =
            format!("has the time {time} s again after later ones: {left_out} moment{plural} left out, which a later start replaces");
        (message, Some("list each moment once".to_owned()))
    }));
    moments
}

/// The path of a file that is named in another. Programs on Windows write `\`.
fn listed_path(list: &Path, file: &str) -> PathBuf {
    let path = list.with_file_name(file);
    if file.contains('\\') && !path.exists() { list.with_file_name(file.replace('\\', "/")) } else { path }
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
    let found = beside::numbered(within, before, after).map_err(|(message, help)| {
        let help = help.map(|help| format!("{help}, or list them with their times in a .pvd file"));
        Flaw::new("", message).with_help(help.as_deref().unwrap_or("write more of the name before the star"))
    })?;
    let Some(&(first, _)) = found.first() else {
        let help = || "expected files with numbers in place of the star, such as frame_00000.obj".to_owned();
        let help = beside::backslash(Path::new(pattern)).unwrap_or_else(help);
        return Err(Flaw::new("", format!("names no file (looked in {})", within.display())).with_help(help));
    };
    let moment = |(number, file): (i64, _)| Listed { time: number.abs_diff(first) as f64 / rate, files: vec![file] };
    Ok(found.into_iter().map(moment).collect())
}

/// A moment as read.
#[derive(Clone, Default)]
struct ReadMoment {
    /// The name of its file, or of the first of them.
    name: String,
    /// Its time (s).
    time: f64,
    step: Option<f64>,
    /// The points and cells of all its files.
    cells: Cells,
    is_surface: bool,
    /// Whether triangles share points only where these are equal.
    is_welded: bool,
    /// Its files.
    parts: Vec<Part>,
}

/// A file of a moment.
#[derive(Clone)]
struct Part {
    name: String,
    /// Its points.
    points: Range<usize>,
    has_displacements: bool,
}

impl ReadMoment {
    fn read(listed: &Listed, limits: &Limits) -> Result<Self, Flaw> {
        let first = name_of(&listed.files[0]);
        let name = if listed.files.len() == 1 { first } else { format!("{first} and others") };
        let mut moment = Self { name, time: listed.time, ..Self::default() };
        for path in &listed.files {
            let name = name_of(path);
            let told = |(message, help): Wrong| Flaw { place: name.clone(), message, help };
            let of_mesh = |error: mesh::ReadError| told((error.message, error.help));
            let ending = ending(path);
            if !matches!(&*ending, "pvtu" | "pvtp") {
                moment.add(path, limits)?;
                continue;
            }
            let bytes = beside::bytes(path, &[&*ending], limits.file, "a moment", "expected a file").map_err(told)?;
            for piece in mesh::read_pieces(&bytes).map_err(of_mesh)? {
                moment.add(&listed_path(path, &piece), limits)?;
            }
        }
        match moment.cells.points.is_empty() {
            true => Err(Flaw::new(moment.name, "has no points")),
            false => Ok(moment),
        }
    }

    /// Adds the points and cells of a file.
    fn add(&mut self, path: &Path, limits: &Limits) -> Result<(), Flaw> {
        let name = name_of(path);
        let told = |(message, help): Wrong| Flaw { place: name.clone(), message, help };
        let ending = ending(path);
        let Some(format) = Format::of(&ending) else {
            return Err(Flaw::new(
                &name,
                "is neither a grid (.vtu, .vtp, .pvtu, .vtk, .msh, .inp, .mesh) nor a surface (.obj, .ply, .stl)",
            ));
        };
        let bytes = beside::bytes(path, &[&*ending], limits.file, "a moment", "expected a file").map_err(told)?;
        let limits = limits.of_mesh();
        let cells = mesh::read_cells(&bytes, format, &limits).map_err(|error| told((error.message, error.help)))?;
        if !matches!(format, Format::Gmsh | Format::Vtk | Format::Vtu | Format::Medit | Format::Abaqus) {
            self.is_surface = true;
            self.is_welded |= format == Format::Stl;
            self.time = number_in(&bytes, TIME).unwrap_or(self.time);
            self.step = step_in(&bytes);
        }
        let corners = self.cells.corners.indices().len() + cells.corners.indices().len();
        if self.cells.points.len() + cells.points.len() > limits.points || corners > limits.corners {
            let most = count(limits.points as u128);
            let message = format!("brings its moment to more points or cells than are allowed, {most} points");
            return Err(Flaw::new(&name, message).with_help("allow it with --allow-large (in code, `Limits::NONE`)"));
        }
        let first = self.cells.points.len();
        let (points, has_displacements) = (first..first + cells.points.len(), cells.displacements.is_some());
        self.parts.push(Part { name, points, has_displacements });
        // Some pieces may be empty.
        if self.cells.points.is_empty() {
            self.cells = cells;
        } else if !cells.points.is_empty() {
            append(&mut self.cells, cells);
        }
        Ok(())
    }

    /// With the points of another moment, if the triangles of both have points of their own: points that are equal in one moment
    /// are apart in others.
    fn joined_like(mut self, first: &Self) -> Result<Self, Flaw> {
        /// The greatest distance of corners that are one point, as a share of the largest coordinate: single precision is enough.
        const APART: f64 = 1e-6;
        let [own, wanted] = [&self.cells, &first.cells].map(|cells| cells.corners.indices());
        if !self.is_welded || own.len() != wanted.len() {
            return Ok(self);
        }
        let far = self.cells.points.iter().fold(0.0, |far: f64, point| far.max(point.abs().max_element()));
        let mut points = vec![None; first.cells.points.len()];
        for (&from, &to) in own.iter().zip(wanted) {
            let (point, known) = (self.cells.points[from as usize], &mut points[to as usize]);
            if known.get_or_insert(point).distance(point) > APART * far {
                let message = format!("has corners apart that are at one place in {}", first.name);
                let help = "write the moments as .ply or .obj, whose points have numbers";
                return Err(Flaw::new(self.name, message).with_help(help));
            }
        }
        self.cells.points = points.into_iter().flatten().collect();
        self.cells.corners = first.cells.corners.clone();
        Ok(self)
    }

    /// With displacements added to the points of the files that wait for them.
    fn displaced(mut self, waits: &[bool]) -> Result<Self, Flaw> {
        let by = self.cells.displacements.take().unwrap_or_default();
        for (part, _) in self.parts.iter().zip(waits).filter(|(_, waits)| **waits) {
            if !part.has_displacements {
                let message = "has no `displacement` for each point, and files of other moments have";
                return Err(Flaw::new(part.name.clone(), message));
            }
            part.points.clone().for_each(|at| self.cells.points[at] += by[at]);
        }
        Ok(self)
    }

    /// The displacements of the points of a part; none without an array.
    fn displacements(&self, points: Range<usize>) -> Vec<DVec3> {
        let none = vec![DVec3::ZERO; points.len()];
        self.cells.displacements.as_ref().map_or(none, |all| all[points].to_vec())
    }

    /// The files that have no displacements beside others that have them, in words behind a sentence.
    fn without_displacements(&self) -> String {
        let names: Vec<_> = self.parts.iter().filter(|part| !part.has_displacements).map(|part| &part.name).collect();
        let all = list(&names, "and", str::to_owned);
        match names.len() {
            0 => String::new(),
            1 => format!("; {all} has none"),
            _ => format!("; {all} have none"),
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

/// Appends the points and cells of another file. Velocities are kept if both have them; points without displacements stay.
fn append(all: &mut Cells, other: Cells) {
    let counts = [&*all, &other].map(|cells| cells.points.len());
    all.corners.append(&other.corners, counts[0] as u32);
    all.copies.append(&other.copies, counts[0] as u32);
    all.notes.extend(other.notes);
    all.kinds.extend(other.kinds);
    all.points.extend(other.points);
    all.velocities = all.velocities.take().zip(other.velocities).map(|(all, other)| [all, other].concat());
    let still = |count: usize| vec![DVec3::ZERO; count];
    if all.displacements.is_some() || other.displacements.is_some() {
        let own = all.displacements.take().unwrap_or_else(|| still(counts[0]));
        all.displacements = Some([own, other.displacements.unwrap_or_else(|| still(counts[1]))].concat());
    }
}

/// Which files of the first moment wait for the displacements of their points: these are at rest to round-off of numbers in single
/// precision, beside which displacements are large.
fn waiting(moments: &[Listed], first: &ReadMoment, limits: &Limits) -> Result<Vec<bool>, Flaw> {
    /// The greatest move of a point, as a share of the largest coordinate and as one of the greatest change of a displacement.
    const STILL: [f64; 2] = [1e-6, 1e-2];
    let none = vec![false; first.parts.len()];
    let [_, between @ .., last] = moments else { return Ok(none) };
    let last = ReadMoment::read(last, limits)?;
    if first.cells.displacements.is_none() && last.cells.displacements.is_none() {
        return Ok(none);
    }
    let far = first.cells.points.iter().fold(0.0, |far: f64, point| far.max(point.abs().max_element()));
    let mut found: Vec<_> = first.parts.iter().map(|part| (part.has_displacements, 0.0, 0.0)).collect();
    for moment in std::iter::once(Ok(last)).chain(between.iter().map(|listed| ReadMoment::read(listed, limits))) {
        let moment = moment?;
        let points = |moment: &ReadMoment| moment.parts.iter().map(|part| part.points.clone()).collect::<Vec<_>>();
        if points(&moment) != points(first) {
            return Ok(none);
        }
        for ((has, moved, displaced), part) in found.iter_mut().zip(&moment.parts) {
            let at = || part.points.clone();
            *has |= part.has_displacements;
            *moved = largest_change(&moment.cells.points[at()], &first.cells.points[at()]).max(*moved);
            *displaced = largest_change(&moment.displacements(at()), &first.displacements(at())).max(*displaced);
        }
    }
    let waits = |(has, moved, displaced)| has && moved <= STILL[0] * far && moved <= STILL[1] * displaced;
    Ok(found.into_iter().map(waits).collect())
}

/// The greatest distance between vectors at one place in two lists.
fn largest_change(now: &[DVec3], before: &[DVec3]) -> f64 {
    now.iter().zip(before).map(|(now, before)| now.distance(*before)).fold(0.0, f64::max)
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

/// The archive of some moments, of which the first is read, whose files may wait for displacements, and whether points move. Velocities wait in a
/// file of their own until all positions are there.
fn copied(
    moments: &[Listed],
    first: &ReadMoment,
    step: Option<f64>,
    waits: &[bool],
    limits: &Limits,
) -> Result<(Npz, bool), Flaw> {
    let failed = |error: io::Error| Flaw::new("", format!("cannot be brought into one file: {error}"));
    let (frames, nodes) = (moments.len(), first.cells.points.len());
    let shape = format!("({frames}, {nodes}, 3)");
    let length = 24 * (frames * nodes) as u64;
    let mut zip = ZipWriter::new(BufWriter::new(tempfile::tempfile().map_err(failed)?));
    let mut velocities = BufWriter::new(tempfile::tempfile().map_err(failed)?);
    let (mut times, moves) = (Vec::new(), first.cells.velocities.is_some());
    begin(&mut zip, "position", "<f8", &shape, length).map_err(failed)?;
    let mut copy = |moment: &ReadMoment| -> io::Result<()> {
        times.push(moment.time);
        moment.cells.points.iter().try_for_each(|point| vector(&mut zip, point))?;
        // Either all moments have velocities or none.
        let mut all = moment.cells.velocities.iter().filter(|_| moves).flatten();
        all.try_for_each(|one| vector(&mut velocities, one))
    };
    let mut last = first.clone().displaced(waits)?;
    copy(&last).map_err(failed)?;
    let mut is_moving = false;
    for listed in &moments[1..] {
        let moment = ReadMoment::read(listed, limits)?.joined_like(first)?.displaced(waits)?;
        moment.check_after(&last)?;
        copy(&moment).map_err(failed)?;
        is_moving |= moment.cells.points != last.cells.points;
        last = moment;
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
    let archive = Npz::of(rest().map_err(failed)?).map_err(|message| Flaw::new("", message))?;
    Ok((archive, is_moving))
}

fn vector(to: &mut impl Write, vector: &DVec3) -> io::Result<()> {
    vector.to_array().into_iter().try_for_each(|number| to.write_all(&number.to_le_bytes()))
}
