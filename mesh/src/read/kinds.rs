//! The types of cells of VTK, in its files of both formats (`vtkCellType.h`).

use super::CellKind;
use super::ReadError;
use super::builder::Builder;
use super::source::DAMAGED;
use glam::DVec3;
use localshape_sim::geometry::bounds;

/// The remedy for grids of other types.
pub(super) const AS_GRID: &str = "write it as an unstructured grid: ParaView's filter `Append Datasets` makes one";

/// Adds a cell of a type. Of cells of higher order the corners are taken, which VTK lists first.
pub(super) fn add(kind: i64, corners: &[u32], builder: &mut Builder) -> Result<(), ReadError> {
    use CellKind::{Hexahedron, Line, Point, Polygon, Polyhedron, Pyramid, Tetrahedron, Wedge};
    // The kind, and the number of corners; 0 if it is open. Cells of first order have no other points.
    let (cell, count) = match kind {
        0 => return Ok(()),
        1 | 2 => (Point, 0),
        3 | 4 => (Line, 0),
        21 | 35 | 68 | 75 => (Line, 2),
        6 => return builder.strip(corners),
        7 => (Polygon, 0),
        5 | 22 | 34 | 69 | 76 => (Polygon, 3),
        8 | 9 | 23 | 28 | 30 | 70 | 77 => (Polygon, 4),
        36 => (Polygon, corners.len() / 2),
        10 | 24 | 71 | 78 => (Tetrahedron, 4),
        11 | 12 | 25 | 29 | 33 | 72 | 79 => (Hexahedron, 8),
        13 | 26 | 31 | 32 | 73 | 80 => (Wedge, 6),
        14 | 27 | 37 | 74 | 81 => (Pyramid, 5),
        15 => (Polyhedron, 10),
        16 => (Polyhedron, 12),
        41 => (Polyhedron, 0),
        _ => {
            let message = format!("has a cell of type {kind}; expected a type of cells that VTK documents, up to 81");
            return Err(ReadError::new(message, "write it again with linear cells"));
        }
    };
    let is_first_order = matches!(kind, 5 | 8..=16);
    if corners.len() < count || is_first_order && corners.len() != count || count == 0 && corners.is_empty() {
        let message = format!("has a cell of type {kind} with {} points; expected {}", corners.len(), count.max(1));
        return Err(ReadError::new(message, DAMAGED));
    }
    builder.is_curved |= count > 0 && corners.len() > count;
    match (kind, if count == 0 { corners } else { &corners[..count] }) {
        // Pixels and voxels are listed along their axes.
        (8, &[a, b, c, d]) => builder.cell(cell, &[a, b, d, c]),
        (12.., corners) if cell == Hexahedron => builder.around(cell, corners),
        (7 | 36, corners) => builder.face(corners),
        (_, corners) => builder.cell(cell, corners),
    }
}

/// The faces in a list of their number, and for each the number of its points and the points.
pub(super) fn faces(list: &[i64]) -> Option<Vec<&[i64]>> {
    let (count, mut rest) = list.split_first()?;
    let mut faces = Vec::new();
    for _ in 0..*count {
        let (length, after) = rest.split_first()?;
        let length = usize::try_from(*length).ok()?;
        faces.push(after.get(..length)?);
        rest = &after[length..];
    }
    Some(faces)
}

/// Adds a polyhedron with these faces, as a tetrahedron, pyramid, wedge or hexahedron if it is one. More points than its corners may be
/// listed: those that hang in its edges and faces.
pub(super) fn polyhedron(faces: &[Vec<u32>], listed: &[u32], builder: &mut Builder) -> Result<(), ReadError> {
    let mut points: Vec<u32> = faces.concat();
    points.extend(listed);
    points.sort_unstable();
    points.dedup();
    match known(faces, &points) {
        Some((kind, corners)) => builder.around(kind, &corners),
        None => {
            builder.concave += usize::from(is_concave(faces, &points, &builder.cells.points));
            builder.cell(CellKind::Polyhedron, &points)
        }
    }
}

/// The kind of a cell with these faces and these points, in ascending order, and its corners as files list them. `None` if it is no
/// tetrahedron, pyramid, wedge or hexahedron.
pub(super) fn known(faces: &[Vec<u32>], points: &[u32]) -> Option<(CellKind, Vec<u32>)> {
    let triangles = faces.iter().filter(|face| face.len() == 3).count();
    let quadrilaterals = faces.iter().filter(|face| face.len() == 4).count();
    let (kind, base) = match (points.len(), triangles, quadrilaterals, faces.len()) {
        (4, 4, 0, 4) => (CellKind::Tetrahedron, 3),
        (5, 4, 1, 5) => (CellKind::Pyramid, 4),
        (6, 2, 3, 5) => (CellKind::Wedge, 3),
        (8, 0, 6, 6) => (CellKind::Hexahedron, 4),
        _ => return None,
    };
    // Faces are listed counter-clockwise from outside, and the base of a cell from inside.
    let base = faces.iter().find(|face| face.len() == base);
    let base: Vec<u32> = base.into_iter().flatten().rev().copied().collect();
    // The corner above one of the base is its neighbour that is not in the base.
    let above = |corner: u32| {
        let around =
            faces.iter().flat_map(|face| (0..face.len()).map(move |at| [face[at], face[(at + 1) % face.len()]]));
        let edges = around.flat_map(|[a, b]| [[a, b], [b, a]]);
        edges.filter(|&[from, to]| from == corner && !base.contains(&to)).map(|[_, to]| to).next()
    };
    let mut corners = base.clone();
    match kind {
        CellKind::Tetrahedron | CellKind::Pyramid => corners.extend(above(base[0])),
        _ => corners.extend(base.iter().filter_map(|&corner| above(corner))),
    }
    let mut sorted = corners.clone();
    sorted.sort_unstable();
    // Faces may not fit together.
    (sorted == points).then_some((kind, corners))
}

/// Whether a polyhedron with these faces is smaller than the convex hull of its points: whether some are clearly on either side of a
/// face. Faces need not be turned outwards. Those of very large cells are not looked at.
fn is_concave(faces: &[Vec<u32>], corners: &[u32], points: &[DVec3]) -> bool {
    /// The most points that are compared with faces: each with each.
    const MOST: usize = 1_000_000;
    /// What is nearer to a face, as a part of the size of the cell, is in it, as faces of four corners are rarely flat. The other is that of
    /// its distance from the origin: single precision.
    const NEAR: [f64; 2] = [1e-3, 1e-6];
    let places: Option<Vec<DVec3>> = corners.iter().map(|&corner| points.get(corner as usize).copied()).collect();
    let Some(places) = places.filter(|places| places.len().saturating_mul(faces.len()) <= MOST) else { return false };
    let (low, high) = bounds(&places);
    let size = (high - low).max_element();
    let near = NEAR[0] * size + NEAR[1] * low.abs().max(high.abs()).max_element();
    let at = |corner: u32| points[corner as usize];
    faces.iter().filter(|face| face.len() > 2).any(|face| {
        let first = at(face[0]);
        let normal: DVec3 = face.windows(2).map(|pair| (at(pair[0]) - first).cross(at(pair[1]) - first)).sum();
        let normal = normal.normalize_or_zero();
        let middle = face.iter().map(|&corner| at(corner) - first).sum::<DVec3>() / face.len() as f64;
        let heights = || places.iter().map(|&place| (place - first - middle).dot(normal));
        heights().any(|height| height > near) && heights().any(|height| height < -near)
    })
}
