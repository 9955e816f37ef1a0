//! Measures of bodies, elements and obstacles, for programs that draw or check them.

pub use super::alike::Alike;
pub use super::contact::ground;
pub use super::element::{around, for_each_face, kind, ordered};
pub use super::hull::bounds;
pub use super::volume::{node_volumes, volume_by_faces, volumes_at_rest};

use super::body::Body;
use super::element::Dimension;
use super::material::per_shear;
use glam::DVec3;
use std::f64::consts::PI;

/// The stiffness of each element of a body in space, relative to that of a cube with this side (m) and of the same material.
///
/// A material gives an element of volume V and nodes `R0` about their mean a stiffness in proportion to `V / Σ |R0|²`
/// ([`Material::stiffness`](super::Material::stiffness)).
pub fn relative_stiffness(body: &Body, side: f64) -> Vec<f64> {
    per_shear(body).into_iter().map(|per_shear| per_shear / side).collect()
}

/// Whether a point (m) lies inside the surface of a body whose nodes are at `position` (m), in the plane inside one of its
/// elements.
pub fn is_inside(point: DVec3, body: &Body, position: &[DVec3]) -> bool {
    if body.dimension == Dimension::Plane {
        let winds = |nodes: &[u32]| winds_around(nodes.iter().map(|&node| position[node as usize] - point));
        return body.elements.iter().any(winds);
    }
    let outside = body.faces.nodes.iter().zip(&body.faces.outer).filter(|(_, outer)| outer.is_none());
    // The solid angle of a closed surface is 4π seen from inside and 0 from outside.
    let sky: f64 = outside
        .flat_map(|(face, _)| (2..face.len()).map(move |at| [face[0], face[at - 1], face[at]]))
        .map(|nodes| solid_angle(nodes.map(|node| position[node as usize] - point)))
        .sum();
    sky.abs() > 2.0 * PI
}

/// The solid angle of a triangle seen from the origin, positive if its corners run counter-clockwise from outside (A. van
/// Oosterom, J. Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30(2), 1983).
pub(crate) fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [x, y, z] = [a.length(), b.length(), c.length()];
    let above = a.dot(b.cross(c));
    let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    2.0 * libm::atan2(above, below)
}

/// Whether a polygon in the plane winds around the origin.
pub(crate) fn winds_around(corners: impl Iterator<Item = DVec3> + Clone) -> bool {
    let next = corners.clone().cycle().skip(1);
    let crosses = |(a, b): &(DVec3, DVec3)| (a.y > 0.0) != (b.y > 0.0) && a.x + (b.x - a.x) * a.y / (a.y - b.y) > 0.0;
    corners.zip(next).filter(crosses).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corner_of_a_cube_fills_an_eighth_of_the_sky() {
        assert!((solid_angle([DVec3::X, DVec3::Y, DVec3::Z]) - PI / 2.0).abs() < 1e-12);
        assert!((solid_angle([DVec3::Y, DVec3::X, DVec3::Z]) + PI / 2.0).abs() < 1e-12);
    }
}
