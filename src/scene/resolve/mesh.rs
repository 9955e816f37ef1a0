//! Bodies of mesh files.

use super::lists::{ListSource, Lists};
use super::table::{BodyTable, Content};
use crate::reading::collector::Here;
use crate::reading::words::{count, list, several, short};
use crate::scene::file::{FillFile, LARGEST, Positive, Up};
use crate::scene::limits::Limits;
use crate::scene::mesh::{self, CELLS, MeshFile};
use crate::sim::{Dimension, IndexLists};
use localshape_mesh::{Cage, Mesh, Surface, Volume, fill};
use std::path::Path;

/// The mesh of a body in a folder, or `None` after reporting its mistakes.
pub(super) fn read(folder: &Path, table: &BodyTable<'_>, limits: &Limits) -> Option<MeshFile> {
    let name = table.mesh();
    let weld = table.file.weld.map(|Positive(distance)| distance / scale(table));
    let read = MeshFile::read(&folder.join(name), weld, limits);
    read.map_err(|(message, help)| table.here.to("mesh").wrong(format!("`{name}` {message}"), help)).ok()
}

/// The length of the unit of a mesh file (m).
fn scale(table: &BodyTable<'_>) -> f64 {
    table.file.scale.map_or(1.0, |Positive(scale)| scale)
}

/// The elements of a mesh with at most so many of them, upright in metres, or `None` after reporting a mistake.
pub(super) fn make<'a>(read: MeshFile, table: &BodyTable<'a>, most: u64) -> Option<Content<'a>> {
    let (file, name, here) = (table.file, table.mesh(), table.here.to("mesh"));
    let mut mesh = read.mesh;
    mesh.notes().iter().for_each(|note| here.warn(format!("`{name}` {note}"), None));
    let (points, dimension) = match &mut mesh {
        Mesh::Volume(volume) => (&mut volume.points, volume.dimension),
        Mesh::Surface(surface) => (&mut surface.points, Dimension::Space),
    };
    let up = file.up.unwrap_or_default();
    if dimension == Dimension::Plane && up == Up::Z {
        let up = table.here.to("up");
        up.wrong(format!("`{up}` is \"z\", but `{name}` is in the plane"), "expected \"x\" or \"y\"");
        return None;
    }
    mesh::place(points, up as usize, scale(table));
    let (most_distant, longest) =
        (points.iter().fold(0.0, |far: f64, at| far.max(at.abs().max_element())), mesh::longest(points));
    if most_distant.is_nan() || most_distant > LARGEST {
        let message = format!("`{name}` reaches as far as {most_distant:e} m; expected at most {LARGEST:e} m");
        here.wrong(message, "use a smaller `scale`");
        return None;
    }
    if longest == 0.0 {
        here.wrong(format!("`{name}` has no extent: all its points are at one place"), None);
        return None;
    }
    if let Some(Positive(weld)) = file.weld.filter(|_| read.joined > 0) {
        let joined = several(read.joined, "point");
        let weld = short(weld);
        here.warn(format!("`{name}` is mended: {joined} welded, nearer than weld = {weld} m to others"), None);
    }
    match mesh {
        Mesh::Volume(volume) => cells(volume, table),
        Mesh::Surface(surface) => filled(&surface, longest, table, most),
    }
}

/// The cells of a volume.
fn cells<'a>(volume: Volume, table: &BodyTable<'a>) -> Option<Content<'a>> {
    let (file, name, here) = (table.file, table.mesh(), table.here.to("mesh"));
    if file.fill.is_some() {
        let fill = table.here.to("fill");
        let message = format!("`{fill}` is about surfaces, but `{name}` has cells");
        fill.wrong_key(message, "remove it: the cells are the elements");
        return None;
    }
    if file.density.is_none() && file.mass_total.is_none() && file.mass.is_none() {
        if !table.flawed {
            let message = "has none of `density`, `mass_total` and `mass`, which a mesh needs";
            let help = "write `density` (kg/m³), such as density = 1000";
            here.wrong(format!("`{}` {message}", table.here), help);
        }
        return None;
    }
    let help = || match volume.joining_weld() {
        Some(distance) => format!("join nodes at one place: write weld = {} (m)", short(distance)),
        None => "mesh them as one body".to_owned(),
    };
    warn_of_turned(volume.turned, volume.cells.len(), name, &here);
    warn_of_parts(volume.points.len(), &volume.cells, help, table);
    let Volume { dimension, solids, points, cells, groups, .. } = volume;
    let source = ListSource { body: table.here.clone(), file: Some((name.to_owned(), here)) };
    let lists = Lists { solids, ..Lists::new(source, dimension, points, cells) };
    Some(Content::Listed(Box::new(lists), groups))
}

/// A surface with the elements that fill it.
fn filled<'a>(surface: &Surface, longest: f64, table: &BodyTable<'a>, most: u64) -> Option<Content<'a>> {
    let (name, here) = (table.mesh(), table.here.to("mesh"));
    check_mass(table)?;
    let typed = table.file.fill.clone().unwrap_or_default();
    let side = match typed.side {
        Some(Positive(side)) => side,
        None => longest / f64::from(typed.cells.unwrap_or(CELLS)),
    };
    if side > longest {
        let typed = table.here.to("fill").to("side");
        let message = format!("`{typed}` is longer than `{name}`, which is {} m long", short(longest));
        typed.warn(message, "use a smaller side: elements larger than a body do not bend with it");
    }
    let limited = most < u64::from(u32::MAX);
    let most = usize::try_from(most).unwrap_or(usize::MAX).min(u32::MAX as usize);
    let filled = match fill(surface, typed.with.with_side(side), most) {
        Ok(filled) => filled,
        Err(error) => {
            let help = error.fitting.map_or(error.help, |side| Some(fewer(&typed, side, longest, limited)));
            here.wrong(format!("`{name}` {}", error.message), help);
            return None;
        }
    };
    let mended = mesh::mended(&filled.flaws);
    if !mended.is_empty() {
        let message = format!("`{name}` is mended: {}", list(&mended, "and", str::to_owned));
        here.warn(message, None);
    }
    let measures = filled.surface.measures();
    let doubts = mesh::doubts(&filled.cage, measures.volume, side, longest, typed.side.is_some());
    let weld = if measures.closed { None } else { filled.surface.closing_weld() };
    for (message, help) in mesh::left(&filled.flaws, measures.closed, weld).into_iter().chain(doubts) {
        here.warn(format!("`{name}` {message}"), help);
    }
    let Cage { nodes, elements, .. } = &filled.cage;
    let help = || "join them in the program that made it".to_owned();
    warn_of_parts(nodes.len(), elements, help, table);
    Some(Content::Filled(Box::new(filled), side))
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
fn check_mass(table: &BodyTable<'_>) -> Option<()> {
    let (file, name) = (table.file, table.mesh());
    if file.density.is_some() || file.mass_total.is_some() {
        return Some(());
    }
    let help = "write `density` (kg/m³), such as density = 1000, or `mass_total` (kg)";
    if file.mass.is_some() {
        let mass = table.here.to("mass");
        let message =
            format!("`{mass}` is that of every node, but nodes of `{name}` have different parts of its inside");
        mass.wrong_key(message, help);
    } else if !table.flawed {
        let message = "has neither `density` nor `mass_total`, which a filled surface needs";
        table.here.to("mesh").wrong(format!("`{}` {message}", table.here), help);
    }
    None
}

/// Warns of cells that a file lists inside out.
pub(super) fn warn_of_turned(turned: usize, all: usize, name: &str, here: &Here<'_>) {
    let [number, all] = [turned, all].map(|cells| count(cells as u128));
    let message = match turned {
        0 => return,
        1 => format!("1 of {all} cells of `{name}` was turned inside out, and is turned over"),
        _ => format!("{number} of {all} cells of `{name}` were turned inside out, and are turned over"),
    };
    here.warn(message, None);
}

/// Warns of parts of a body that nothing holds together.
fn warn_of_parts(nodes: usize, elements: &IndexLists, help: impl FnOnce() -> String, table: &BodyTable<'_>) {
    let parts = mesh::parts(nodes, elements);
    if parts > 1 {
        let (name, parts) = (table.mesh(), count(parts as u128));
        let message = format!("`{name}` makes {parts} parts that share no node, so nothing holds them together");
        table.here.to("mesh").warn(message, format!("{}, unless they may fall apart", help()));
    }
}
