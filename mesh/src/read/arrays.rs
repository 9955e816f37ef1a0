//! The arrays of points and cells of VTK's files that are read: velocities, displacements, and what tells ghosts.

use super::ReadError;
use super::builder::Ghost;
use super::source::{DAMAGED, quoted};

/// Velocities of points.
pub(super) const VELOCITY: &[u8] = b"velocity";
/// Displacements of points.
const DISPLACEMENT: &[u8] = b"displacement";
/// Displacements in files of CalculiX and others; velocities in those of OpenFOAM, which have pressures beside them.
const U: &[u8] = b"u";
pub(super) const PRESSURE: &[u8] = b"p";

/// What tells copies of cells and points of other pieces: VTK's name, and that of VTK before version 7.
pub(super) const GHOSTS: [&[u8]; 2] = [b"vtkGhostType", b"vtkGhostLevels"];

/// The name of an array that is read, however it is typed.
pub(super) fn wanted(typed: &[u8], of_cells: bool, columns: usize) -> Option<&'static [u8]> {
    let is_vector = matches!(columns, 2 | 3);
    let is = |name: &&&[u8]| typed.eq_ignore_ascii_case(name);
    let ghosts = GHOSTS.into_iter().find(|name| *name == typed);
    let of_points = || match typed {
        VELOCITY => Some(VELOCITY),
        PRESSURE => Some(PRESSURE),
        _ => [VELOCITY, DISPLACEMENT, U].iter().find(is).copied().filter(|_| is_vector),
    };
    ghosts.or_else(|| if of_cells { None } else { of_points() })
}

/// The name of the array with displacements among those that are there.
pub(super) fn displacement(has: impl Fn(&[u8]) -> bool) -> &'static [u8] {
    if has(DISPLACEMENT) || has(PRESSURE) { DISPLACEMENT } else { U }
}

/// Whether an array that is read has vectors.
pub(super) fn is_vector(name: &[u8]) -> bool {
    [VELOCITY, DISPLACEMENT, U].contains(&name)
}

/// What a number in an array of this name tells of a cell or a point (`vtkDataSetAttributes.h`).
pub(super) fn ghost(name: &[u8], number: i64, of_cells: bool) -> Ghost {
    /// What is in another piece, too.
    const DUPLICATE: i64 = 1;
    /// Hidden points, which take their cells with them; hidden cells, and those in whose place there are finer ones. Other flags are
    /// about neighbours.
    const HIDDEN: [i64; 2] = [2, 8 | 32];
    match () {
        () if name == GHOSTS[1] && number > 0 => Ghost::Copy,
        () if name == GHOSTS[1] => Ghost::None,
        () if number & DUPLICATE != 0 => Ghost::Copy,
        () if number & HIDDEN[usize::from(of_cells)] != 0 => Ghost::Hidden,
        () => Ghost::None,
    }
}

/// Refuses an array, described at a place, that has not one entry for each of the points or cells.
pub(super) fn check(
    typed: &[u8],
    found: usize,
    expected: usize,
    of_cells: bool,
    place: impl Fn() -> String,
) -> Result<(), ReadError> {
    if found == expected {
        return Ok(());
    }
    let (name, what) = (quoted(typed), if of_cells { "cell" } else { "point" });
    let message =
        format!("has {found} entries in its array {name} {}; expected {expected}, one for each {what}", place());
    Err(ReadError::new(message, DAMAGED))
}
