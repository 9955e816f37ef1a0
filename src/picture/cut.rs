//! The number of triangles of curved faces. Each bilinear patch is cut as finely as its curvature needs, and along
//! edges as finely as its neighbours, so that there are no gaps between them. All other faces, and edges between sets
//! of elements, keep whole sides; gaps there are round-off.

/// The cut of a face into pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Cut {
    /// Cells in each direction.
    pub(super) cells: u8,
    /// Pieces of each side, from corner to corner; at least as many.
    pub(super) sides: [u8; 4],
}

/// The cuts of all faces of a surface.
pub(super) struct Cuts {
    /// For each face its cells in each direction, and for each node the most cells of the faces around it. Empty if
    /// nothing is cut.
    faces: Vec<u8>,
    nodes: Vec<u8>,
}

impl Cuts {
    /// No cuts yet, for a number of nodes; without nodes nothing is cut.
    pub(super) fn new(nodes: usize) -> Self {
        Self { faces: Vec::new(), nodes: vec![1; nodes] }
    }

    /// Adds a face with a number of cells in each direction.
    pub(super) fn add(&mut self, nodes: &[u32], cells: u8) {
        self.faces.push(cells);
        for &node in nodes {
            let most = &mut self.nodes[node as usize];
            *most = cells.max(*most);
        }
    }

    /// Pieces of an edge. They depend only on its nodes, so all its faces have the same number, at least the needed
    /// one.
    pub(super) fn edge(&self, ends: [u32; 2]) -> u8 {
        let [from, to] = ends.map(|node| self.nodes.get(node as usize).copied().unwrap_or(1));
        from.min(to)
    }

    /// The cut of a face of four nodes.
    pub(super) fn face(&self, face: usize, [a, b, c, d]: [u32; 4]) -> Cut {
        let sides = [[a, b], [b, c], [c, d], [d, a]].map(|ends| self.edge(ends));
        Cut { cells: self.faces.get(face).copied().unwrap_or(1), sides }
    }
}

/// The pieces of a bilinear patch.
#[derive(Debug, Default)]
pub(super) struct CutPatch {
    /// The points: their coordinates in both directions, and the weight of each corner.
    pub(super) points: Vec<([f64; 2], [f64; 4])>,
    /// The corners of the small triangles, as places in `points`.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The points along each side, from corner to corner.
    pub(super) sides: [Vec<u32>; 4],
}

impl CutPatch {
    pub(super) fn new(cut: Cut) -> Self {
        if cut.sides == [cut.cells; 4] { Self::even(u32::from(cut.cells)) } else { Self::uneven(cut) }
    }

    /// Cells of two triangles.
    fn even(cells: u32) -> Self {
        let mut grid = Self::default();
        let across = cells + 1;
        (0..across * across).for_each(|at| grid.add([at % across, at / across], [cells; 2]));
        let corners = (0..cells).flat_map(|row| (0..cells).map(move |column| row * across + column));
        grid.triangles = corners.flat_map(cell(across)).collect();
        grid.sides = [0, 1, 2, 3].map(|side| {
            let at = |along| match side {
                0 => along,
                1 => along * across + cells,
                2 => cells * across + cells - along,
                _ => (cells - along) * across,
            };
            (0..=cells).map(at).collect()
        });
        grid
    }

    /// Sides with more pieces than cells: a ring of triangles joins them to the inner cells or, if there are too few
    /// cells, to the middle.
    fn uneven(cut: Cut) -> Self {
        let mut grid = Self::default();
        let starts = [0, 1, 2, 3].map(|side| {
            let (start, pieces) = (grid.points.len() as u32, u32::from(cut.sides[side]));
            for along in 0..pieces {
                let back = pieces - along;
                let place = [[along, 0], [pieces, along], [back, pieces], [0, back]][side];
                grid.add(place, [pieces; 2]);
            }
            grid.sides[side] = (start..start + pieces).collect();
            start
        });
        (0..4).for_each(|side| grid.sides[side].push(starts[(side + 1) % 4]));
        let (cells, first) = (u32::from(cut.cells), grid.points.len() as u32);
        if cells < 3 {
            grid.add([1; 2], [2; 2]);
            let ends = grid.sides.iter().flat_map(|side| side.windows(2));
            grid.triangles = ends.map(|ends| [ends[0], ends[1], first]).collect();
            return grid;
        }
        let across = cells - 1;
        (0..across * across).for_each(|at| grid.add([at % across + 1, at / across + 1], [cells; 2]));
        let within = cells - 2;
        let corners = (0..within).flat_map(|row| (0..within).map(move |column| row * across + column));
        grid.triangles = corners.map(|at| first + at).flat_map(cell(across)).collect();
        for side in 0..4 {
            let inner = |along: u32| {
                let back = within - along;
                first + [along, along * across + within, within * across + back, back * across][side]
            };
            let (outer, pieces) = (&grid.sides[side], u32::from(cut.sides[side]));
            let (mut out, mut along) = (0, 0);
            while out < pieces || along < within {
                let ends = [outer[out as usize], inner(along)];
                // The next piece is the one whose middle comes first.
                if along == within || (out < pieces && (2 * out + 1) * cells <= (2 * along + 3) * pieces) {
                    out += 1;
                    grid.triangles.push([ends[0], outer[out as usize], ends[1]]);
                } else {
                    along += 1;
                    grid.triangles.push([ends[0], inner(along), ends[1]]);
                }
            }
        }
        grid
    }

    fn add(&mut self, place: [u32; 2], of: [u32; 2]) {
        let [u, v] = [0, 1].map(|axis| f64::from(place[axis]) / f64::from(of[axis]));
        self.points.push(([u, v], [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v]));
    }
}

/// The triangles of a cell, by its first corner and the number of points in a row.
fn cell(across: u32) -> impl Fn(u32) -> [[u32; 3]; 2] {
    move |at| [[at, at + 1, at + across + 1], [at, at + across + 1, at + across]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn triangles_cover_a_patch_once_and_have_all_points_of_its_sides() {
        let few = (1..=5_u8).flat_map(|cells| {
            let more = move |at: u32, side: u32| cells + (at / 5_u32.pow(side) % 5) as u8;
            (0..5_u32.pow(4)).map(move |at| (cells, [0, 1, 2, 3].map(|side| more(at, side))))
        });
        for (cells, sides) in few.chain([(3, [24; 4]), (23, [24, 23, 24, 23]), (24, [24; 4])]) {
            let grid = CutPatch::new(Cut { cells, sides });
            let place = |at: u32| grid.points[at as usize].0;
            let area = |&[a, b, c]: &[u32; 3]| {
                let [a, b, c] = [a, b, c].map(place);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            };
            let areas: Vec<_> = grid.triangles.iter().map(area).collect();
            assert!(areas.iter().all(|&area| area > 1e-6) && (areas.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            // Each side of a triangle is shared with another one, in reverse, or is a piece of the border.
            let around = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
            let ends: HashSet<_> = grid.triangles.iter().flat_map(around).collect();
            let border: HashSet<_> = ends.iter().filter(|&&[a, b]| !ends.contains(&[b, a])).copied().collect();
            let expected = grid.sides.iter().flat_map(|side| side.windows(2).map(|ends| [ends[0], ends[1]]));
            assert_eq!(border, expected.collect(), "{cells} {sides:?}");
            for (side, pieces) in grid.sides.iter().zip(sides) {
                assert_eq!(side.len(), usize::from(pieces) + 1);
            }
            let corners = grid.sides.each_ref().map(|side| place(side[0]));
            assert_eq!(corners, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        }
    }

    #[test]
    fn all_faces_of_an_edge_cut_it_alike_and_none_needs_more() {
        let faces: [([u32; 4], u8); 2] = [([0, 1, 2, 3], 2), ([1, 4, 5, 2], 5)];
        let mut cuts = Cuts::new(6);
        faces.iter().for_each(|(corners, cells)| cuts.add(corners, *cells));
        assert_eq!(cuts.face(0, faces[0].0), Cut { cells: 2, sides: [2, 5, 2, 2] });
        assert_eq!(cuts.face(1, faces[1].0), Cut { cells: 5, sides: [5; 4] });
        assert_eq!(Cuts::new(0).face(0, faces[0].0), Cut { cells: 1, sides: [1; 4] });
    }
}
