//! Cells that name a corner more than once: wedges, pyramids and tetrahedra that programs write as hexahedra, and what is left of cells
//! whose points are welded.

use super::kinds;
use super::polygon::outline;
use glam::DVec3;
use localshape_sim::ElementKind;
use localshape_sim::geometry::for_each_face;

/// An area or volume below this part of the cell's bounding cube counts as zero, as in the checks of scenes.
pub(super) const FLAT: f64 = 1e-12;

/// What is left of the faces of a cell: triangles and quadrilaterals, each with different corners.
fn faces(kind: ElementKind, cell: &[u32]) -> Vec<Vec<u32>> {
    let mut faces = Vec::new();
    for_each_face(kind, cell, |side| {
        let face = outline(side);
        // A face that goes back where it came from has no area.
        let is_there_and_back = face.len() == 4 && (face[0] == face[2] || face[1] == face[3]);
        if face.len() > 2 && !is_there_and_back {
            faces.push(face);
        }
    });
    faces
}

/// The cells that a cell of a kind is, if these corners are all that it has: one of a simpler kind or, if none has its faces,
/// tetrahedra. Empty if it has no volume.
pub(super) fn simpler(
    kind: ElementKind,
    cell: &[u32],
    different: &[u32],
    points: &[DVec3],
) -> Vec<(ElementKind, Vec<u32>)> {
    if kind == ElementKind::Other {
        let kind = if different.len() == 4 { ElementKind::Tetrahedron } else { kind };
        return vec![(kind, different.to_vec())];
    }
    let faces = faces(kind, cell);
    // Tetrahedra are also written with a quadrilateral that is bent. Two quadrilaterals on each other are none.
    if different.len() == 4 && faces.iter().any(|face| face.len() == 3) {
        return vec![(ElementKind::Tetrahedron, different.to_vec())];
    }
    match kinds::known(&faces, different) {
        Some((kind, corners)) => kind.element().map(|kind| (kind, corners)).into_iter().collect(),
        None => tetrahedra(&faces, different, points),
    }
}

/// The tetrahedra between a corner and the faces that do not have it, by the first corner from which all are on the inner side, and that
/// have all corners of the cell if possible.
fn tetrahedra(faces: &[Vec<u32>], different: &[u32], points: &[DVec3]) -> Vec<(ElementKind, Vec<u32>)> {
    let at = |point: u32| points[point as usize];
    let six = |[a, b, c, d]: &[u32; 4]| (at(*b) - at(*a)).cross(at(*c) - at(*a)).dot(at(*d) - at(*a));
    // Quadrilaterals are divided at their lowest corner, as those of the next cell are, or else at the one after it.
    let from = |(&apex, turn): (&u32, usize)| {
        let mut all = Vec::new();
        for face in faces.iter().filter(|face| !face.contains(&apex)) {
            let first = (0..face.len()).min_by_key(|&place| face[place]).unwrap_or(0);
            let corner = |place: usize| face[(first + turn + place) % face.len()];
            all.extend((2..face.len()).map(|place| [corner(0), corner(place - 1), corner(place), apex]));
        }
        let size = all.iter().map(|cell| six(cell).abs()).sum::<f64>();
        all.retain(|cell| six(cell).abs() > FLAT * size);
        let is_inner = |sign: f64| all.iter().all(|cell| six(cell) * sign > 0.0);
        (is_inner(1.0) || is_inner(-1.0)).then_some(all)
    };
    let ways = [0, 1].into_iter().flat_map(|turn| different.iter().map(move |apex| (apex, turn)));
    let found: Vec<_> = ways.filter_map(from).collect();
    let has_all = |cells: &&Vec<[u32; 4]>| different.iter().all(|corner| cells.as_flattened().contains(corner));
    let cells = found.iter().find(has_all).or(found.first());
    cells.into_iter().flatten().map(|cell| (ElementKind::Tetrahedron, cell.to_vec())).collect()
}
