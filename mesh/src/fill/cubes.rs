//! Cubes of a lattice.

use super::allowed::{Allowed, JOINED};
use super::clip::{self, Piece};
use super::draft::Nodes;
use super::graded::{self, Graded};
use super::lattice::{CORNERS, Cell, Lattice, corner};
use super::parts::{LEAST, Parted, Parts, Patches, Scene, bounded};
use super::{Cage, Fill, FillError, Filled};
use crate::inside::{Grid, Inside};
use crate::{Flaws, Surface};
use glam::DVec3;
use localshape_sim::Weights;
use rayon::prelude::*;

/// Points along each side of a cell at which it is tried whether they are inside, where a surface is open.
const SAMPLES: usize = 4;

/// Fills a surface with those cubes of a lattice that contain a part of the inside. Parts of a surface have a lattice with one corner.
pub(super) fn fill(
    mut surface: Surface,
    flaws: Flaws,
    side: f64,
    shared: Option<DVec3>,
    is_graded: bool,
    most: usize,
) -> Result<Filled, FillError> {
    // Many cells are joined if cubes are graded, and cells take less memory than elements.
    let joined = if is_graded { JOINED } else { 1 };
    let (lattice, scaled) = Lattice::about(&mut surface, side, shared, most)?;
    let mut pieces = clip::pieces(&scaled, &lattice);
    let homes = homes(&scaled, &lattice);
    hold(&mut pieces, &homes, &lattice);
    let inside = Inside::new(&scaled);
    let scene = Scene::new(&scaled, &lattice, &inside, &pieces);
    let cells = cells(&scene, &flaws)?;
    let refuse = |needed: usize| {
        let mut allowed = Allowed::new(std::slice::from_ref(&surface), Fill::Cubes { side }, most);
        if is_graded {
            // Cubes at the surface are not joined, and most are there unless the body is many sides thick.
            allowed.parts[0].measures.volume = 0.0;
        }
        Err(allowed.too_many(side, needed as f64, ""))
    };
    if cells.len() / joined / joined > most {
        return refuse(cells.len() / joined);
    }
    let parts = scene.parts(&cells);
    let thin = parts.thin();
    let mut nodes = Nodes::new(parts.corners.len());
    let Graded { elements, filled, element_of, volumes } = graded::joined(&scene, &parts, is_graded, &mut nodes);
    if elements.len() > most {
        return refuse(elements.len());
    }
    let weights = weights(&scene, &parts, &homes, |copy| &elements[element_of[copy] as usize]);
    let volumes = volumes.map(|all| all.into_iter().map(|volume| volume * side * side * side).collect());
    let overlap = overlap(&scene, &cells) * side * side * side;
    let filled = filled.iter().any(|&filled| filled < 1.0).then_some(filled);
    let cage = Cage { nodes: nodes.places, elements, filled, volumes, overlap, thin, ..Cage::default() };
    Ok(Filled { cage, surface, weights, flaws })
}

/// How much more volume the shells of a closed surface have together than its inside, in cells. What is less than round-off may be is 0.
pub(super) fn overlap(scene: &Scene, cells: &[Parted]) -> f64 {
    if !scene.inside.caps().is_empty() {
        return 0.0;
    }
    let along = scene.lattice.counts[0] as u64;
    let volume = |piece: &Piece| piece.volume + piece.shadow * (piece.cell % along) as f64;
    let volume: f64 = scene.pieces.iter().map(volume).sum();
    let overlap = volume - cells.iter().map(|parted| parted.full.filled).sum::<f64>();
    if overlap > 1e-6 * volume { overlap } else { 0.0 }
}

/// The cells whose middle is inside a surface or that its triangles touch, in rising order, and how much of each is
/// inside.
///
/// The volume inside a cell follows from the divergence theorem for the field x: the sum over the parts of triangles in
/// the cell, and the inside of its face towards +x, which is what the shadows of all parts farther along the row add up
/// to. Where the surface is open, points of the cell are tried instead.
pub(super) fn cells(scene: &Scene, flaws: &Flaws) -> Result<Vec<Parted>, FillError> {
    let caps = Surface {
        points: scene.inside.caps().as_flattened().to_vec(),
        triangles: (0..scene.inside.caps().len() as u32).map(|cap| [3 * cap, 3 * cap + 1, 3 * cap + 2]).collect(),
        ..Surface::default()
    };
    let capped = clip::pieces(&caps, scene.lattice);
    check_effort(scene, flaws, &capped)?;
    let rows = (0..scene.lattice.counts[1] * scene.lattice.counts[2]).into_par_iter();
    let begun: Vec<_> = rows.flat_map_iter(|row| row_cells(scene, row, &capped)).collect();
    check_shells(scene, &begun)?;
    let parted = |(whole, patches): (Parted, Option<Patches>)| match patches {
        Some(patches) => scene.parted(whole, &patches),
        None => whole,
    };
    let cells: Vec<_> = begun.into_par_iter().map(parted).collect();
    if cells.iter().all(|parted| parted.full.filled <= LEAST) {
        return Err(no_inside(flaws));
    }
    Ok(cells)
}

/// The most triangles that are looked at: for some minutes.
const MOST: f64 = 3e10;

/// Refuses shells of which too many lie over each other in single cells.
fn check_shells(scene: &Scene, begun: &[(Parted, Option<Patches>)]) -> Result<(), FillError> {
    let all = || begun.iter().filter_map(|(_, patches)| patches.as_ref());
    if all().map(|patches| patches.effort(scene.inside)).sum::<f64>() <= MOST {
        return Ok(());
    }
    let patches: usize = all().map(|patches| patches.count).sum();
    let message =
        format!("has {patches} separate parts of its surface in single cells, too many to tell what each bounds");
    Err(FillError::new(message, "unite its shells in the program that made it, or use a larger side"))
}

/// Refuses an open surface of which too many points had to be tried.
fn check_effort(scene: &Scene, flaws: &Flaws, capped: &[Piece]) -> Result<(), FillError> {
    let count = |pieces: &[Piece]| pieces.chunk_by(|one, other| one.cell == other.cell).count();
    let tried = if capped.is_empty() { 0 } else { count(scene.pieces) + count(capped) };
    if (tried * SAMPLES * SAMPLES * SAMPLES) as f64 * scene.inside.effort() <= MOST {
        return Ok(());
    }
    let edges = flaws.boundary + flaws.inconsistent;
    let message = format!("is open at {edges} edges, too many to tell how much of some {tried} cells is inside");
    Err(FillError::new(message, "close it in the program that made it, or use a larger side"))
}

fn row_cells<'s>(scene: &Scene<'s>, row: usize, capped: &'s [Piece]) -> Vec<(Parted, Option<Patches<'s>>)> {
    let Scene { inside, lattice, pieces, .. } = *scene;
    let grid = Grid { first: DVec3::splat(0.5), side: 1.0, counts: lattice.counts };
    let along = grid.counts[0];
    let (mut pieces, mut capped) = [pieces, capped].map(|pieces| of(pieces, row * along, along)).into();
    let (mut cells, mut shadow) = (Vec::new(), 0.0);
    for (at, (around, is_inside)) in inside.row(&grid, row).into_iter().enumerate().rev() {
        let key = row * along + at;
        let [own, own_caps] = [&mut pieces, &mut capped].map(|rest| {
            let start = rest.partition_point(|piece| piece.cell < key as u64);
            let own;
            (*rest, own) = rest.split_at(start);
            own
        });
        if !own.is_empty() {
            let is_clear = own_caps.is_empty() && is_inside == (around > 0);
            let filled = if is_clear {
                shadow + own.iter().map(|piece| piece.volume).sum::<f64>()
            } else {
                sampled(inside, &grid, key)
            };
            cells.push(scene.begun(own, bounded(filled), is_clear));
        } else if is_inside {
            cells.push((Parted::whole(key as u64), None));
        }
        shadow += own.iter().chain(own_caps).map(|piece| piece.shadow).sum::<f64>();
    }
    cells.reverse();
    cells
}

/// The pieces in some neighbouring cells.
fn of(pieces: &[Piece], first: usize, count: usize) -> &[Piece] {
    let start = pieces.partition_point(|piece| piece.cell < first as u64);
    let end = pieces.partition_point(|piece| piece.cell < (first + count) as u64);
    &pieces[start..end]
}

/// The part of a cell's points that are inside.
fn sampled(inside: &Inside, grid: &Grid, key: usize) -> f64 {
    let side = 1.0 / SAMPLES as f64;
    let [along, wide, _] = grid.counts;
    let cell = [key % along, key / along % wide, key / along / wide];
    let first = DVec3::from_array(cell.map(|at| at as f64)) + 0.5 * side;
    let points = inside.grid(&Grid { first, side, counts: [SAMPLES; 3] });
    let number = points.iter().filter(|inside| **inside).count();
    number as f64 / points.len() as f64
}

pub(super) fn no_inside(flaws: &Flaws) -> FillError {
    let (message, help) = match flaws.boundary + flaws.inconsistent {
        0 => ("has no inside: its volume is zero".to_owned(), "use a surface with a thickness"),
        _ => {
            let number = flaws.boundary;
            let edges = if number == 1 { "edge belongs" } else { "edges belong" };
            let message = format!("has no inside: it is open, {number} of its {edges} to one triangle only");
            (message, "give it a thickness, or close its holes, in the program that made it")
        }
    };
    FillError::new(message, help)
}

/// Adds pieces without area, so that each point has a piece of its triangle in its cell: some triangles have no area.
fn hold(pieces: &mut Vec<Piece>, homes: &[(Cell, u32)], lattice: &Lattice) {
    let key = |piece: &Piece| (piece.cell, piece.triangle);
    let known = pieces.len();
    for &(cell, triangle) in homes {
        let cell = lattice.key(cell);
        if pieces[..known].binary_search_by_key(&(cell, triangle), key).is_err() {
            pieces.push(Piece { cell, triangle, volume: 0.0, shadow: 0.0 });
        }
    }
    if pieces.len() > known {
        pieces.sort_unstable_by_key(key);
        pieces.dedup_by_key(|piece| key(piece));
    }
}

/// The weights of a surface's points in the corners of the copies that contain them.
pub(super) fn weights<'e>(
    scene: &Scene,
    parts: &Parts,
    homes: &[(Cell, u32)],
    nodes: impl Fn(usize) -> &'e [u32],
) -> Weights {
    let mut weights = Weights::default();
    for (&point, &(cell, triangle)) in scene.scaled.points.iter().zip(homes) {
        let key = (scene.lattice.key(cell), triangle);
        let piece = scene.pieces.binary_search_by_key(&key, |piece| (piece.cell, piece.triangle));
        let copy = parts.copy_of[piece.expect("each point has a piece")] as usize;
        let [x, y, z] = (point - corner(cell)).clamp(DVec3::ZERO, DVec3::ONE).to_array();
        let own = CORNERS.map(|corner| {
            let along = |axis: usize, at: f64| if corner[axis] == 1 { at } else { 1.0 - at };
            along(0, x) * along(1, y) * along(2, z)
        });
        weights.push(nodes(copy), &own);
    }
    weights
}

/// The cell of each point, and a triangle that has a part in that cell with the point as a corner.
pub(super) fn homes(scaled: &Surface, lattice: &Lattice) -> Vec<(Cell, u32)> {
    let mut homes: Vec<Option<(Cell, u32)>> = vec![None; scaled.points.len()];
    let largest = lattice.counts.map(|count| count as f64 - 1.0);
    for is_flat in [false, true] {
        for (triangle, &of) in (0u32..).zip(&scaled.triangles) {
            let [a, b, c] = scaled.corners(of);
            let normal = (b - a).cross(c - a);
            if (normal == DVec3::ZERO) != is_flat {
                continue;
            }
            let middle = (a + b + c) / 3.0;
            let flat = [0, 1, 2].map(|axis| a[axis] == b[axis] && b[axis] == c[axis]);
            for (point, at) in of.into_iter().zip([a, b, c]) {
                homes[point as usize].get_or_insert_with(|| {
                    let cell = [0, 1, 2].map(|axis| {
                        // What lies in a plane belongs to the cell behind it; other points to that of their triangle.
                        let is_low = if flat[axis] { normal[axis] > 0.0 } else { middle[axis] < at[axis] };
                        let low = if is_low { at[axis].ceil() - 1.0 } else { at[axis].floor() };
                        low.clamp(0.0, largest[axis]) as u32
                    });
                    (cell, triangle)
                });
            }
        }
    }
    homes.into_iter().map(|home| home.unwrap_or_default()).collect()
}
