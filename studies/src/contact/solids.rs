//! Bodies of tetrahedra with sharp points, ridges, grooves and holes.

use super::bodies::{MASS, SIDE};
use glam::DVec3;
use localshape::sim::{Body, IndexLists};
use std::collections::HashMap;
use std::sync::Arc;

/// The height of spikes and wedges (cells), which are a third as wide.
pub(super) const HEIGHT: f64 = 6.0;

/// A body of the filled cells of a grid, whose nodes `place` moves, both in cells: from the middle of the grid along x and z, upwards from its
/// bottom along y. Nodes at one place are one. Each cell is six tetrahedra (H. W. Kuhn 1960) or fewer, without those that have become flat.
/// An element gives each of its nodes the eighth part of [`MASS`], as a cube does, so that the steps of cubes suit.
fn tetrahedra(cells: [u32; 3], is_filled: impl Fn([u32; 3]) -> bool, place: impl Fn(DVec3) -> DVec3) -> Arc<Body> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let [wide, high, deep] = cells;
    let middle = DVec3::new(f64::from(wide), 0.0, f64::from(deep)) * 0.5;
    let (mut known, mut rest, mut mass) = (HashMap::new(), Vec::new(), Vec::new());
    let mut elements = IndexLists::default();
    let grid = (0..deep).flat_map(|z| (0..high).flat_map(move |y| (0..wide).map(move |x| [x, y, z])));
    for cell in grid.filter(|&cell| is_filled(cell)) {
        for order in ORDERS {
            let mut corner = cell;
            let mut node = |corner: [u32; 3]| {
                // Zero may have a sign, which would make another place of it.
                let at = place(DVec3::from_array(corner.map(f64::from)) - middle) * SIDE + DVec3::ZERO;
                *known.entry(at.to_array().map(f64::to_bits)).or_insert_with(|| {
                    rest.push(at);
                    mass.push(0.0);
                    rest.len() as u32 - 1
                })
            };
            let first = node(corner);
            let [second, third, last] = order.map(|axis| {
                corner[axis] += 1;
                node(corner)
            });
            let [a, b, c, d] = [first, second, third, last].map(|node| rest[node as usize]);
            let volume = (b - a).cross(c - a).dot(d - a);
            if volume != 0.0 {
                let nodes = if volume > 0.0 { [first, second, third, last] } else { [first, third, second, last] };
                nodes.iter().for_each(|&node| mass[node as usize] += MASS / 8.0);
                elements.push(&nodes);
            }
        }
    }
    Arc::new(Body::builder(rest).elements(elements).masses(mass).build().expect("a body of tetrahedra"))
}

/// A pyramid that ends in a point above.
pub(super) fn spike() -> Arc<Body> {
    let narrow = |DVec3 { x, y, z }: DVec3| {
        let share = 1.0 - y / HEIGHT;
        DVec3::new(x * share, y, z * share)
    };
    tetrahedra([2, HEIGHT as u32, 2], |_| true, narrow)
}

/// A prism that ends in a ridge along z above.
pub(super) fn wedge() -> Arc<Body> {
    tetrahedra([2, HEIGHT as u32, 4], |_| true, |DVec3 { x, y, z }| DVec3::new(x * (1.0 - y / HEIGHT), y, z))
}

/// A plate, two cells high.
pub(super) fn slab([wide, deep]: [u32; 2]) -> Arc<Body> {
    tetrahedra([wide, 2, deep], |_| true, |at| at)
}

/// A plate with a hole from above, two cells wide and one deep.
pub(super) fn hole() -> Arc<Body> {
    let is_inner = |at: u32| (1..3).contains(&at);
    tetrahedra([4, 2, 4], |[x, y, z]| !(y == 1 && is_inner(x) && is_inner(z)), |at| at)
}

/// A plate with a groove along z, two cells wide and one deep.
pub(super) fn crack() -> Arc<Body> {
    tetrahedra([4, 2, 8], |_| true, |at| if at.x == 0.0 { at.min(DVec3::new(0.0, 1.0, f64::INFINITY)) } else { at })
}

/// A pyramid without its upper part: two cells high, with a face of two cells above.
pub(super) fn cliff() -> Arc<Body> {
    let wider = |DVec3 { x, y, z }: DVec3| DVec3::new(x * (1.5 - 0.25 * y), y, z * (1.5 - 0.25 * y));
    tetrahedra([2, 2, 2], |_| true, wider)
}
