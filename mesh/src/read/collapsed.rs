//! Cells that list a corner several times: programs of mechanics write wedges and tetrahedra as hexahedra with corners in common.

use localshape_sim::ElementKind;

/// The faces of a kind with corners around each, as places in the order of [`localshape_sim::Solids::Ordered`].
fn faces(kind: ElementKind) -> &'static [&'static [usize]] {
    match kind {
        ElementKind::Hexahedron => {
            &[&[0, 1, 3, 2], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 3, 7, 6], &[0, 2, 6, 4], &[1, 3, 7, 5]]
        }
        ElementKind::Wedge => &[&[0, 1, 2], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
        ElementKind::Pyramid => &[&[0, 1, 2, 3], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        _ => &[],
    }
}

/// The wedge, pyramid or tetrahedron that a cell with repeated corners is, with its corners; `None` if it is none.
pub(super) fn simpler(kind: ElementKind, cell: &[u32]) -> Option<(ElementKind, Vec<u32>)> {
    let around = |places: &&[usize]| {
        let mut corners: Vec<u32> = places.iter().map(|&place| cell[place]).collect();
        corners.dedup();
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        corners
    };
    let left: Vec<Vec<u32>> = faces(kind).iter().map(around).filter(|corners| corners.len() > 2).collect();
    let mut distinct = cell.to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    let (triangles, quadrilaterals): (Vec<_>, Vec<_>) = left.into_iter().partition(|corners| corners.len() == 3);
    match (distinct.len(), &triangles[..], &quadrilaterals[..]) {
        (4, [_, _, _, _], []) => Some((ElementKind::Tetrahedron, distinct)),
        (5, [_, _, _, _], [base]) => {
            let tip = distinct.into_iter().find(|corner| !base.contains(corner))?;
            Some((ElementKind::Pyramid, base.iter().copied().chain([tip]).collect()))
        }
        (6, [lower, _], [_, _, _]) => {
            // Each corner of a triangle has an edge to one of the other.
            let across = |&corner: &u32| {
                let edges = quadrilaterals.iter().flat_map(|of| (0..4).map(|at| [of[at], of[(at + 1) % 4]]));
                let mut ends = edges.filter(|edge| edge.contains(&corner)).flatten();
                ends.find(|end| !lower.contains(end))
            };
            let upper = lower.iter().map(across).collect::<Option<Vec<_>>>()?;
            Some((ElementKind::Wedge, lower.iter().copied().chain(upper).collect()))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_with_corners_in_common_are_simpler_ones() {
        let of = |kind, cell: &[u32]| simpler(kind, cell);
        let hexahedron = |cell: [u32; 8]| of(ElementKind::Hexahedron, &cell);
        // A side that is an edge: corners 2 and 3, 6 and 7 in common.
        assert_eq!(hexahedron([0, 1, 2, 2, 4, 5, 6, 6]), Some((ElementKind::Wedge, vec![0, 1, 2, 4, 5, 6])));
        assert_eq!(hexahedron([0, 1, 2, 3, 9, 9, 9, 9]), Some((ElementKind::Pyramid, vec![0, 1, 3, 2, 9])));
        assert_eq!(hexahedron([0, 1, 2, 2, 9, 9, 9, 9]), Some((ElementKind::Tetrahedron, vec![0, 1, 2, 9])));
        assert_eq!(of(ElementKind::Wedge, &[0, 1, 2, 3, 3, 3]), Some((ElementKind::Tetrahedron, vec![0, 1, 2, 3])));
        let pyramid = of(ElementKind::Wedge, &[0, 1, 2, 0, 4, 5]);
        assert_eq!(pyramid, Some((ElementKind::Pyramid, vec![1, 2, 5, 4, 0])));
        // Opposite corners in common, two points and a cell without volume.
        assert_eq!(hexahedron([0, 1, 2, 0, 4, 5, 6, 7]), None);
        assert_eq!(hexahedron([0, 1, 0, 1, 0, 1, 0, 1]), None);
        assert_eq!(of(ElementKind::Tetrahedron, &[0, 1, 2, 2]), None);
    }
}
