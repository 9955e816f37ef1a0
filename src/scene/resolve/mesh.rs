//! Bodies of mesh files.

use super::Place;
use super::lists::{ListSource, Lists};
use crate::reading::collector::{Collector, key_path, written};
use crate::reading::words::{count, list, several, short};
use crate::scene::file::{BodyFile, FillFile, FillKind, LARGEST, Positive, Up};
use crate::scene::limits::Limits;
use crate::scene::mesh::{self, CELLS, MeshFile};
use crate::sim::{Dimension, IndexLists};
use localshape_mesh::{Cage, Fill, Filled, Group, Mesh, Surface, Volume, fill};
use std::path::Path;

/// The content of a mesh file, upright in metres.
#[derive(Debug)]
pub(super) enum Made {
    /// Cells, which are the elements, and their groups of nodes.
    Cells(Box<Lists>, Vec<Group>),
    /// A surface with the elements that fill it, and the length of their edges (m).
    Filled(Box<Filled>, f64),
}

/// The mesh of a body, or `None` after reporting its mistakes.
pub(super) fn read(
    folder: &Path,
    file: &BodyFile,
    place: &Place,
    limits: &Limits,
    report: &mut Collector<'_>,
) -> Option<MeshFile> {
    let name = file.mesh.as_ref()?;
    let weld = file.weld.map(|Positive(distance)| distance / scale(file));
    let read = MeshFile::read(&folder.join(name), weld, limits);
    read.map_err(|(message, help)| report.at(&key_path![place; "mesh"], format!("`{name}` {message}"), help)).ok()
}

/// The length of the unit of a mesh file (m).
fn scale(file: &BodyFile) -> f64 {
    file.scale.map_or(1.0, |Positive(scale)| scale)
}

/// The elements of a mesh with at most so many of them, or `None` after reporting a mistake. `flawed` tells whether keys were left
/// out because of mistakes.
pub(super) fn make(
    read: MeshFile,
    file: &BodyFile,
    place: &Place,
    flawed: bool,
    most: u64,
    report: &mut Collector<'_>,
) -> Option<Made> {
    let name = file.mesh.as_deref().unwrap_or_default();
    let path = key_path![place; "mesh"];
    let mut mesh = read.mesh;
    mesh.notes().iter().for_each(|note| report.warn(&path, format!("`{name}` {note}"), None));
    let (points, dimension) = match &mut mesh {
        Mesh::Volume(volume) => (&mut volume.points, volume.dimension),
        Mesh::Surface(surface) => (&mut surface.points, Dimension::Space),
    };
    let up = file.up.unwrap_or_default();
    if dimension == Dimension::Plane && up == Up::Z {
        let message = format!("`{}` is \"z\", but `{name}` is in the plane", written(&key_path![place; "up"]));
        report.at(&key_path![place; "up"], message, "expected \"x\" or \"y\"");
        return None;
    }
    mesh::place(points, up as usize, scale(file));
    let (most_distant, longest) =
        (points.iter().fold(0.0, |far: f64, at| far.max(at.abs().max_element())), mesh::longest(points));
    if most_distant.is_nan() || most_distant > LARGEST {
        let message = format!("`{name}` reaches as far as {most_distant:e} m; expected at most {LARGEST:e} m");
        report.at(&path, message, "use a smaller `scale`");
        return None;
    }
    if longest == 0.0 {
        report.at(&path, format!("`{name}` has no extent: all its points are at one place"), None);
        return None;
    }
    if let Some(Positive(weld)) = file.weld.filter(|_| read.joined > 0) {
        let joined = several(read.joined, "point");
        report.warn(
            &path,
            format!("`{name}` is mended: {joined} welded, nearer than weld = {} m to others", short(weld)),
            None,
        );
    }
    match mesh {
        Mesh::Volume(volume) => cells(volume, file, place, flawed, report),
        Mesh::Surface(surface) => filled(&surface, longest, file, place, flawed, most, report),
    }
}

/// The cells of a volume.
fn cells(volume: Volume, file: &BodyFile, place: &Place, flawed: bool, report: &mut Collector<'_>) -> Option<Made> {
    let name = file.mesh.as_deref().unwrap_or_default();
    let path = key_path![place; "mesh"].to_vec();
    if file.fill.is_some() {
        let message = format!("`{}` is about surfaces, but `{name}` has cells", written(&key_path![place; "fill"]));
        report.at_key(&key_path![place; "fill"], message, "remove it: the cells are the elements");
        return None;
    }
    if file.density.is_none() && file.mass_total.is_none() && file.mass.is_none() {
        if flawed {
            return None;
        }
        let message =
            format!("`{}` has none of `density`, `mass_total` and `mass`, which a mesh needs", written(place));
        report.at(&path, message, "write `density` (kg/m³), such as density = 1000");
        return None;
    }
    let help = || match volume.joining_weld() {
        Some(distance) => format!("join nodes at one place: write weld = {} (m)", short(distance)),
        None => "mesh them as one body".to_owned(),
    };
    warn_of_turned(volume.turned, volume.cells.len(), name, &path, report);
    warn_of_parts(volume.points.len(), &volume.cells, help, place, name, report);
    let Volume { dimension, solids, points: nodes, cells: elements, groups, .. } = volume;
    let source = ListSource { body: place.clone(), file: Some((name.to_owned(), path)) };
    let (springs, faces, positions, velocities, masses) = Default::default();
    let lists = Lists { source, dimension, nodes, elements, solids, springs, faces, positions, velocities, masses };
    Some(Made::Cells(Box::new(lists), groups))
}

/// A surface with the elements that fill it.
fn filled(
    surface: &Surface,
    longest: f64,
    file: &BodyFile,
    place: &Place,
    flawed: bool,
    most: u64,
    report: &mut Collector<'_>,
) -> Option<Made> {
    let name = file.mesh.as_deref().unwrap_or_default();
    let path = key_path![place; "mesh"];
    check_mass(file, place, flawed, report)?;
    let typed = file.fill.clone().unwrap_or_default();
    let (chosen, side) = chosen(&typed, longest);
    if side > longest {
        let message = format!(
            "`{}` is longer than `{name}`, which is {} m long",
            written(&key_path![place; "fill", "side"]),
            short(longest)
        );
        report.warn(
            &key_path![place; "fill", "side"],
            message,
            "use a smaller side: elements larger than a body do not bend with it",
        );
    }
    let limited = most < u64::from(u32::MAX);
    let most = usize::try_from(most).unwrap_or(usize::MAX).min(u32::MAX as usize);
    let filled = match fill(surface, chosen, most) {
        Ok(filled) => filled,
        Err(error) => {
            let help = error.fitting.map_or(error.help, |side| Some(fewer(&typed, side, longest, limited)));
            report.at(&path, format!("`{name}` {}", error.message), help);
            return None;
        }
    };
    let mended = mesh::mended(&filled.flaws);
    if !mended.is_empty() {
        let message = format!("`{name}` is mended: {}", list(&mended, "and", str::to_owned));
        report.warn(&path, message, None);
    }
    let measures = filled.surface.measures();
    let doubts = mesh::doubts(&filled.cage, measures.volume, side, longest, typed.side.is_some());
    for (message, help) in mesh::left(&filled.flaws, measures.closed).into_iter().chain(doubts) {
        report.warn(&path, format!("`{name}` {message}"), help);
    }
    let Cage { nodes, elements, .. } = &filled.cage;
    let help = || "join them in the program that made it".to_owned();
    warn_of_parts(nodes.len(), elements, help, place, name, report);
    Some(Made::Filled(Box::new(filled), side))
}

/// The fill that a scene asks for, and the length of its edges (m).
fn chosen(typed: &FillFile, longest: f64) -> (Fill, f64) {
    let side = match typed.side {
        Some(Positive(side)) => side,
        None => longest / f64::from(typed.cells.unwrap_or(CELLS)),
    };
    let chosen = match typed.with {
        FillKind::Cubes => Fill::Cubes { side },
        FillKind::Graded => Fill::Graded { side },
        FillKind::Tetrahedra => Fill::Tetrahedra { side },
        FillKind::Polyhedra => Fill::Polyhedra { side },
    };
    (chosen, side)
}

/// How to fill a body of a length (m) with few enough elements: with those of a side (m), or with more allowed if they are limited.
fn fewer(typed: &FillFile, side: f64, longest: f64, limited: bool) -> String {
    let fewer = match typed.side {
        _ if !side.is_finite() => "use fewer `cells`".to_owned(),
        Some(_) => format!("use side = {side} or more"),
        None => format!("use cells = {} or fewer", (longest / side).floor().max(1.0)),
    };
    if limited { format!("{fewer}, or allow more with --allow-large (in code, `Limits::NONE`)") } else { fewer }
}

/// Reports a filled body without a mass of its volume.
fn check_mass(file: &BodyFile, place: &Place, flawed: bool, report: &mut Collector<'_>) -> Option<()> {
    let name = file.mesh.as_deref().unwrap_or_default();
    if file.density.is_some() || file.mass_total.is_some() {
        return Some(());
    }
    let help = "write `density` (kg/m³), such as density = 1000, or `mass_total` (kg)";
    if file.mass.is_some() {
        let path = key_path![place; "mass"];
        let message = format!(
            "`{}` is that of every node, but nodes of `{name}` have different parts of its inside",
            written(&path)
        );
        report.at_key(&path, message, help);
    } else if !flawed {
        let message =
            format!("`{}` has neither `density` nor `mass_total`, which a filled surface needs", written(place));
        report.at(&key_path![place; "mesh"], message, help);
    }
    None
}

/// Warns of cells that a file lists inside out.
pub(super) fn warn_of_turned(turned: usize, all: usize, name: &str, place: &Place, report: &mut Collector<'_>) {
    let [number, all] = [turned, all].map(|cells| count(cells as u128));
    let message = match turned {
        0 => return,
        1 => format!("1 of {all} cells of `{name}` was turned inside out, and is turned over"),
        _ => format!("{number} of {all} cells of `{name}` were turned inside out, and are turned over"),
    };
    report.warn(place, message, None);
}

/// Warns of parts of a body that nothing holds together.
fn warn_of_parts(
    nodes: usize,
    elements: &IndexLists,
    help: impl FnOnce() -> String,
    place: &Place,
    name: &str,
    report: &mut Collector<'_>,
) {
    let parts = mesh::parts(nodes, elements);
    if parts > 1 {
        let message =
            format!("`{name}` makes {} parts that share no node, so nothing holds them together", count(parts as u128));
        report.warn(&key_path![place; "mesh"], message, format!("{}, unless they may fall apart", help()));
    }
}
