//! Mesh files: read, put upright in metres, filled, and their flaws in words.

mod summary;

pub(crate) use summary::MeshSummary;

use super::limits::Limits;
use crate::reading::beside::{self, Wrong, ending};
use crate::reading::words::{count, hexadecimal, list, nearest, several, short};
use crate::sim::geometry::bounds;
use crate::sim::{ElementKind, IndexLists};
use glam::DVec3;
use localshape_mesh::{self as mesh, Cage, Flaws, Format, Mesh, ReadError, Sets, Thin};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The endings of mesh files.
fn endings() -> Vec<&'static str> {
    Format::ALL.into_iter().flat_map(Format::endings).copied().collect()
}

/// A surface is said to be thinner than its elements if this part of the cells is where it is.
const THIN: f64 = 0.3;

/// The number of cells along the longest side of a filled surface, unless a scene tells another.
pub(crate) const CELLS: u32 = 20;

/// A mesh as it is in its file.
#[derive(Debug)]
pub(crate) struct MeshFile {
    pub(crate) mesh: Mesh,
    /// The number of points that were joined with others on request.
    pub(crate) joined: usize,
    /// The digest of its bytes and of those of files beside it.
    pub(crate) digest: String,
}

impl MeshFile {
    /// Reads a file, and joins points nearer than a distance in its unit. A message is the predicate of a sentence about the file.
    pub(crate) fn read(path: &Path, weld: Option<f64>, limits: &Limits) -> Result<Self, Wrong> {
        let endings = endings();
        let expected = format!("expected a mesh: {}", list(&endings, "or", |ending| format!(".{ending}")));
        let bytes = beside::bytes(path, &endings, limits.file, "a mesh", &expected)?;
        let ending = ending(path);
        let Some(format) = Format::of(&ending) else {
            let (found, help) = match &*ending {
                "" => ("has no ending".to_owned(), inside(&bytes)),
                "npz" => ("is a NumPy archive".to_owned(), Some("write `file` in place of `mesh`".to_owned())),
                "pvd" | "series" => {
                    ("is a list of moments".to_owned(), Some("write it as `states` of a run".to_owned()))
                }
                // The content of `.pvtu` is like that of its pieces.
                _ => {
                    let help = inside(&bytes).filter(|_| ending != "pvtu").or_else(|| other(&ending));
                    (format!("is a .{ending} file"), help)
                }
            };
            return Err((format!("{found}; {expected}"), help));
        };
        let (mut hash, mut left) = (Sha256::new_with_prefix(&bytes), limits.file - bytes.len() as u64);
        let limits = limits.of_mesh();
        // All files together may be as long as one.
        let mut beside = |name: &str| {
            let path = path.with_file_name(name);
            let data = beside::bytes(&path, &["bin"], left, "data of a mesh", "expected a file")
                .map_err(|(message, help)| ReadError { message, help })?;
            left -= data.len() as u64;
            hash.update(&data);
            Ok(data)
        };
        let told = |error: ReadError| (error.message, error.help);
        let mut cells = mesh::read_cells_with(&bytes, format, &limits, &mut beside).map_err(told)?;
        let joined = weld.map_or(0, |distance| cells.weld(distance));
        let mesh = cells.mesh(format).map_err(told)?;
        let digest = hexadecimal(&hash.finalize());
        Ok(Self { mesh, joined, digest })
    }
}

/// Whether a file has the ending of a mesh, of one that is not read, too, or of a list of them, or another ending and the content of a mesh.
pub(crate) fn is_mesh(path: &Path) -> bool {
    let ending = ending(path);
    if Format::of(&ending).is_some() || mesh::converter(&ending).is_some() || matches!(&*ending, "pvd" | "series") {
        return true;
    }
    let mut head = Vec::new();
    // Reading a pipe would take what is in it.
    let file = path.is_file().then(|| File::open(path).ok()).flatten();
    let is_read = file.is_some_and(|file| file.take(1024).read_to_end(&mut head).is_ok());
    // JSON that says nothing else is no mesh.
    is_read && Format::within(&head).is_some_and(|format| format != Format::Gltf || head.starts_with(b"glTF"))
}

/// The remedy for a file with the content of a mesh and another ending.
fn inside(bytes: &[u8]) -> Option<String> {
    let ending = Format::within(bytes)?.endings()[0];
    Some(format!("by its content it is a .{ending} file: name it so"))
}

/// The remedy for a file with an ending that is not read.
fn other(ending: &str) -> Option<String> {
    if let Some(help) = mesh::converter(ending) {
        return Some(help.to_owned());
    }
    // Of short endings, others are formats of their own.
    let near = nearest(ending, &endings()).filter(|near| ending.len() > near.len());
    near.map(|near| format!("did you mean .{near}?"))
}

/// Why an archive of arrays cannot be read from a mesh file, and what to write instead; `None` for other files.
pub(crate) fn instead_of_archive(path: &Path, name: &str) -> Option<Wrong> {
    let ending = ending(path);
    if Format::of(&ending).is_some() {
        return Some((format!("is a mesh (.{ending})"), Some(format!("write mesh = {name:?} in place of `file`"))));
    }
    let message =
        format!("is a mesh (.{ending}), which is not read; expected a NumPy archive (.npz), or a mesh as `mesh`");
    mesh::converter(&ending).map(|help| (message, Some(help.to_owned())))
}

/// Puts points of a file into the axes of scenes, with y up, and scales them. The axis of the file that points up is 0, 1 or 2.
pub(crate) fn place(points: &mut [DVec3], up: usize, scale: f64) {
    let turned = |point: DVec3| match up {
        0 => DVec3::new(-point.y, point.x, point.z),
        1 => point,
        _ => DVec3::new(point.x, point.z, -point.y),
    };
    // Adding zero turns −0 into 0.
    points.iter_mut().for_each(|point| *point = turned(*point) * scale + DVec3::ZERO);
}

/// The longest side of the box around points (m).
pub(crate) fn longest(points: &[DVec3]) -> f64 {
    let (low, high) = bounds(points);
    (high - low).max_element()
}

/// The number of parts of a body that share no node.
pub(crate) fn parts(nodes: usize, elements: &IndexLists) -> usize {
    let mut sets = Sets::new(nodes);
    elements.iter().for_each(|element| element[1..].iter().for_each(|&node| sets.join(element[0], node)));
    sets.numbered().1
}

/// The first corners of two sides of a polygon that cross each other, by their places in it.
pub(crate) fn crossing(kind: ElementKind, corners: &[DVec3]) -> Option<[usize; 2]> {
    /// The most nodes of a polygon whose sides are compared pairwise.
    const MOST_COMPARED: usize = 2000;
    let count = corners.len();
    if kind != ElementKind::Polygon || !(4..=MOST_COMPARED).contains(&count) {
        return None;
    }
    let side = |at: usize| [corners[at], corners[(at + 1) % count]];
    let turn = |[a, b]: [DVec3; 2], c: DVec3| (b - a).cross(c - a).z;
    let apart = |one: [DVec3; 2], other: [DVec3; 2]| turn(one, other[0]) * turn(one, other[1]) < 0.0;
    (0..count)
        .flat_map(|one| (one + 2..count).map(move |other| [one, other]))
        .filter(|&[one, other]| (other + 1) % count != one)
        .find(|&[one, other]| apart(side(one), side(other)) && apart(side(other), side(one)))
}

/// The mended flaws of a surface in words; empty for nothing. Points at one place are no flaw: some formats have no
/// others.
pub(crate) fn mended(flaws: &Flaws) -> Vec<String> {
    counted([
        (flaws.near, "point", " welded that only round-off sets apart"),
        (flaws.degenerate, "triangle", " without area left out"),
        (flaws.doubled, "doubled triangle", " left out"),
        (flaws.turned, "triangle", " turned over"),
    ])
}

/// Numbers of flaws above zero, each before a word for one and more words.
fn counted<const N: usize>(flaws: [(usize, &str, &str); N]) -> Vec<String> {
    let some = flaws.into_iter().filter(|(number, ..)| *number > 0);
    some.map(|(number, one, what)| several(number, one) + what).collect()
}

/// The flaws of a surface that are left: the predicate of a sentence about it, and a remedy. `closed` says whether it has an inside
/// all the same.
/// A scene may join points nearer than `weld`, which helps.
pub(crate) fn left(flaws: &Flaws, closed: bool, weld: Option<f64>) -> Option<(String, String)> {
    let left = counted([
        (flaws.boundary, "open edge", ""),
        (flaws.non_manifold, "edge", " of three triangles or more"),
        (flaws.inconsistent, "edge", " whose triangles look to different sides"),
    ]);
    let (what, help) = match (closed, weld) {
        (true, _) => {
            ("where parts may be joined or not", "separate or join them in the program that made it".to_owned())
        }
        (false, weld) => {
            let join = weld.map(|weld| format!("join points that are close: write weld = {} (m), or ", short(weld)));
            let help = "close it in the program that made it, unless the elements are right";
            ("and is filled where its triangles enclose most", join.unwrap_or_default() + help)
        }
    };
    (!left.is_empty()).then(|| (format!("has {}, {what}", list(&left, "and", str::to_owned)), help))
}

/// The faults of a surface of this volume that show in the elements that fill it: predicates of sentences about it, with a remedy each. Their side and the
/// longest one of the surface have one unit; `is_typed` says whether the side was given, and not a number of cells.
pub(crate) fn doubts(cage: &Cage, volume: f64, side: f64, longest: f64, is_typed: bool) -> Vec<(String, String)> {
    let mut doubts = Vec::new();
    if cage.overlap > 0.0 {
        let part = short(100.0 * cage.overlap / volume);
        let message = format!(
            "has shells that cross or lie in each other: {part} % of their volume is in several, and counts once"
        );
        doubts.push((message, "unite them in the program that made it, unless the elements are right".to_owned()));
    }
    let Thin { cubes, of, filled } = cage.thin;
    if cubes > 0 && cubes as f64 >= THIN * of as f64 {
        let thickness = side * filled / cubes as f64;
        let [cubes, of] = [cubes, of].map(|number| count(number as u128));
        let message =
            format!("is thinner than its elements in {cubes} of {of} cells, and does not bend there as it would");
        // Two elements across it.
        let finer = match is_typed {
            true => format!("side = {} or less", short(0.5 * thickness)),
            false => format!("cells = {} or more", (2.0 * longest / thickness).ceil()),
        };
        doubts.push((message, format!("use {finer}, or make it thicker")));
    }
    doubts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_or_not() {
        assert!(endings().iter().all(|ending| mesh::converter(ending).is_none()));
    }

    #[test]
    fn axes_of_files_are_turned_not_mirrored() {
        for (up, of) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
            let mut axes = [DVec3::X, DVec3::Y, DVec3::Z, of];
            place(&mut axes, up, 2.0);
            let [x, y, z, points_up] = axes;
            assert_eq!((x.cross(y).dot(z), points_up), (8.0, DVec3::Y * 2.0), "{up}");
        }
    }
}
