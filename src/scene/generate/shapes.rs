//! Polygons, discs and chains of bars.

use super::Made;
use crate::scene::file::{BarsFile, PolygonFile};
use crate::scene::limits::BodySize;
use crate::sim::IndexLists;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) fn disc_size(rings: u32, sectors: u32) -> BodySize {
    let (rings, sectors) = (u128::from(rings), u128::from(sectors));
    BodySize::new(1 + rings * sectors, [(3, sectors), (4, (rings - 1) * sectors)])
}

/// The corner of a regular polygon, counted counter-clockwise from the left end of its lowest side, about its middle.
fn corner(at: u32, sides: u32, radius: f64) -> DVec3 {
    // Angles start at the lowest point, so that left and right are mirror images.
    let angle = PI * (2.0 * f64::from(at) - 1.0) / f64::from(sides);
    let (sine, cosine) = libm::sincos(angle);
    DVec3::new(radius * sine, -radius * cosine, 0.0)
}

/// The height of a polygon's middle above its lowest side (m).
fn height(sides: u32, radius: f64) -> f64 {
    radius * libm::cos(PI / f64::from(sides))
}

/// A regular polygon as one element, with a side on y = 0.
pub(super) fn polygon(typed: &PolygonFile) -> Made {
    let (sides, radius) = (typed.sides, typed.radius.0);
    let middle = DVec3::Y * height(sides, radius);
    let nodes = (0..sides).map(|at| middle + corner(at, sides, radius)).collect();
    let all: Vec<u32> = (0..sides).collect();
    Made { nodes, elements: [all.as_slice()].into_iter().collect() }
}

/// Triangles around the middle, node 0, and rings of quadrilaterals around the triangles, standing on y = 0.
pub(super) fn disc(radius: f64, rings: u32, sectors: u32) -> Made {
    let middle = DVec3::Y * height(sectors, radius);
    let mut nodes = vec![middle];
    let mut elements = IndexLists::default();
    for ring in 1..=rings {
        let radius = radius * f64::from(ring) / f64::from(rings);
        nodes.extend((0..sectors).map(|at| middle + corner(at, sectors, radius)));
        let first = 1 + (ring - 1) * sectors;
        for at in 0..sectors {
            let [a, b] = [first + at, first + (at + 1) % sectors];
            match ring {
                1 => elements.push(&[0, a, b]),
                _ => elements.push(&[a - sectors, a, b, b - sectors]),
            }
        }
    }
    Made { nodes, elements }
}

/// Bars end to end from the origin.
pub(super) fn bars(typed: &BarsFile, direction: DVec3) -> Made {
    let nodes = (0..=typed.count).map(|at| direction * (f64::from(at) * typed.length.0)).collect();
    let mut elements = IndexLists::default();
    (0..typed.count).for_each(|at| elements.push(&[at, at + 1]));
    Made { nodes, elements }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file::{Coordinates, Positive};
    use crate::scene::generate::Generator;
    use crate::sim::ElementKind;
    use crate::sim::geometry::volume_by_faces;

    fn assert_size(made: &Made, said: &BodySize) {
        assert_eq!(made.nodes.len() as u128, said.nodes);
        assert_eq!(made.elements.len() as u128, said.count());
        assert_eq!(made.elements.indices().len() as u128, said.corners());
    }

    fn area(made: &Made) -> f64 {
        let areas = made.elements.iter().map(|nodes| volume_by_faces(ElementKind::Polygon, nodes, &made.nodes));
        areas.inspect(|&area| assert!(area > 0.0)).sum()
    }

    #[test]
    fn polygons_and_discs_stand_on_a_side_and_are_counter_clockwise() {
        for sides in [3, 4, 5, 6, 12, 100] {
            let typed = PolygonFile { sides, radius: Positive(0.5) };
            let expected = 0.5 * f64::from(sides) * 0.25 * (2.0 * PI / f64::from(sides)).sin();
            let (polygon, fan, disc) = (polygon(&typed), disc(0.5, 1, sides), disc(0.5, 4, sides));
            assert_size(&polygon, &Generator::Polygon(&typed).size());
            assert_size(&fan, &disc_size(1, sides));
            assert_size(&disc, &disc_size(4, sides));
            for made in [&polygon, &fan, &disc] {
                assert!((area(made) / expected - 1.0).abs() < 1e-12, "{sides}");
                let lowest = made.nodes.iter().map(|node| node.y).fold(f64::INFINITY, f64::min);
                assert!(lowest.abs() < 1e-15, "{sides}: {lowest:e}");
            }
            assert!((polygon.nodes[0] + DVec3::X * polygon.nodes[1].x).length() < 1e-15, "left end of the lowest side");
        }
    }

    #[test]
    fn bars_lie_end_to_end() {
        let typed = BarsFile { count: 8, length: Positive(0.1), direction: Coordinates(vec![0.0, 3.0]) };
        let made = bars(&typed, DVec3::Y);
        assert_size(&made, &Generator::Bars(&typed).size());
        assert_eq!((made.nodes[0], &made.elements[7]), (DVec3::ZERO, &[7, 8][..]));
        assert!((made.nodes[8] - DVec3::Y * 0.8).length() < 1e-15);
    }
}
