//! Blocks of equal cells.

use crate::sim::body::IndexLists;
use glam::DVec3;

/// Rest positions of a block's nodes: x fastest, then y, then z; standing on y = 0, its middle over the origin.
pub(super) fn nodes(cells: &[u32], side: f64) -> Vec<DVec3> {
    let [nx, ny, nz] = counts(cells);
    let mut nodes = Vec::with_capacity((nx as usize + 1) * (ny as usize + 1) * (nz as usize + 1));
    let centred = |at: u32, cells: u32| (f64::from(at) - 0.5 * f64::from(cells)) * side;
    for z in 0..=nz {
        for y in 0..=ny {
            nodes.extend((0..=nx).map(|x| DVec3::new(centred(x, nx), f64::from(y) * side, centred(z, nz))));
        }
    }
    nodes
}

/// The cells of a block in the same order: hexahedra with their corners in bit order, or squares counter-clockwise.
pub(super) fn elements(cells: &[u32]) -> IndexLists {
    let [nx, ny, nz] = counts(cells);
    let (row, layer) = (nx + 1, (nx + 1) * (ny + 1));
    let mut elements = IndexLists::default();
    for z in 0..nz.max(1) {
        for y in 0..ny {
            for x in 0..nx {
                let first = x + row * y + layer * z;
                match cells {
                    [_, _] => elements.push(&[first, first + 1, first + row + 1, first + row]),
                    _ => elements.push(&std::array::from_fn::<_, 8, _>(|corner| {
                        let corner = corner as u32;
                        first + (corner & 1) + row * (corner >> 1 & 1) + layer * (corner >> 2)
                    })),
                }
            }
        }
    }
    elements
}

/// Cells along x, y and z; none along z in the plane.
fn counts(cells: &[u32]) -> [u32; 3] {
    std::array::from_fn(|axis| cells.get(axis).copied().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_numbered_x_fastest_and_stands_on_the_ground() {
        let nodes = nodes(&[2, 1, 1], 0.5);
        assert_eq!(nodes.len(), 12);
        assert_eq!(nodes[0], DVec3::new(-0.5, 0.0, -0.25));
        assert_eq!(nodes[1], DVec3::new(0.0, 0.0, -0.25));
        assert_eq!(nodes[3], DVec3::new(-0.5, 0.5, -0.25));
        assert_eq!(nodes[11], DVec3::new(0.5, 0.5, 0.25));
        let elements = elements(&[2, 1, 1]);
        assert_eq!(&elements[1], [1, 2, 4, 5, 7, 8, 10, 11]);
    }

    #[test]
    fn squares_are_counter_clockwise() {
        assert_eq!(nodes(&[2, 1], 1.0).len(), 6);
        assert_eq!(&elements(&[2, 1])[1], [1, 2, 5, 4]);
    }
}
