//! The box in which the key light casts shadows of bodies and obstacles on each other.

use super::Mesh;
use super::narrow::narrow_rows;
use super::shadow::Plane;
use glam::{DVec3, DVec4, Mat4};

/// The size of the box, relative to the bodies in it.
const MARGIN: f64 = 1.05;
/// The number of its sizes for each doubling, and the steps of its middle in half its width: so shadows do not creep below moving bodies.
const SIZES: f64 = 4.0;
const STEPS: f64 = 32.0;
/// The most room towards the light for obstacles, in halves of its width: more would take all digits from depths of bodies.
const FARTHEST: f64 = 64.0;

/// From a panel's coordinates to a box around bodies, seen from the key light: from −1 to 1 across and up, and from 0, far from the light, to 1.
/// It reaches towards the light as far as obstacles do. `None` without bodies.
pub(super) fn key_map<'a>(key: DVec3, bodies: [&Mesh; 2], obstacles: impl Iterator<Item = &'a Mesh>) -> Option<Mat4> {
    let [across, up] = Plane::new(key, 0.0).axes;
    let axes = [across, up, key];
    let place = |mesh: &Mesh, corner: u32| {
        let at = DVec3::from_array(mesh.vertices[corner as usize].position.map(f64::from));
        DVec3::from_array(axes.map(|axis| at.dot(axis)))
    };
    let corners = bodies.into_iter().flat_map(|mesh| {
        let triangles = mesh.triangles.iter().chain(&mesh.unseen).flatten();
        triangles.map(move |&corner| place(mesh, corner))
    });
    let (low, high) = corners.map(|at| (at, at)).reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))?;
    let half = 0.5 * MARGIN * (high - low).max_element().max(f64::MIN_POSITIVE);
    let half = libm::exp2((SIZES * libm::log2(half)).ceil() / SIZES) * (1.0 + 1.0 / STEPS);
    let step = half / STEPS;
    let middle = (low.midpoint(high) / step).round() * step;
    let nearest = obstacles.flat_map(|mesh| (0..mesh.vertices.len() as u32).map(move |corner| place(mesh, corner).z));
    let above = nearest.fold(half, |above, at| above.max(at - middle.z)).min(FARTHEST * half);
    let row = |at: usize, length: f64, add: f64| (axes[at] / length).extend(add - middle[at] / length);
    let depth = half + above;
    Some(narrow_rows([row(0, half, 0.0), row(1, half, 0.0), row(2, depth, half / depth), DVec4::W]))
}

#[cfg(test)]
mod tests {
    use super::super::Vertex;
    use super::*;

    fn mesh(corners: &[[f32; 3]]) -> Mesh {
        let vertices = corners.iter().map(|&position| Vertex { position, ..Vertex::default() }).collect();
        Mesh { vertices, triangles: vec![[0, 1, 2]], ..Mesh::default() }
    }

    #[test]
    fn bodies_lie_in_the_box_and_obstacles_before_its_near_side() {
        let key = DVec3::new(-0.5, 0.8, 0.3).normalize();
        let (none, roof) = (Mesh::default(), mesh(&[[-30.0, 9.0, 0.0], [30.0, 9.0, 0.0], [0.0, 9.0, 30.0]]));
        for shift in 0..40 {
            let moved = 0.013 * shift as f32;
            // A corner without a triangle does not count.
            let corners = [[moved, 0.0, 0.0], [1.0 + moved, 0.2, 0.0], [moved, 0.0, 1.0], [1e5, 0.0, 0.0]];
            let body = mesh(&corners);
            let around: [&[&Mesh]; 2] = [&[], &[&roof]];
            let [alone, below] =
                around.map(|obstacles| key_map(key, [&body, &none], obstacles.iter().copied()).unwrap());
            for corner in &corners[..3] {
                let [one, other] = [alone, below].map(|map| map.project_point3(glam::Vec3::from(*corner)));
                assert!(one.abs().max_element() < 1.0 && one.z > 0.0 && other.z > 0.0, "{one} {other}");
                assert_eq!([one.x, one.y], [other.x, other.y]);
            }
            let depths = roof.vertices.iter().map(|corner| below.project_point3(corner.position.into()).z);
            assert!((depths.fold(0.0, f32::max) - 1.0).abs() < 1e-5);
        }
        assert_eq!(key_map(key, [&none, &none], [&roof].into_iter()), None);
        // Bodies without a size, and those that have blown up, have finite boxes.
        for corner in [[0.0; 3], [1e6; 3]] {
            let map = key_map(key, [&mesh(&[corner; 3]), &mesh(&[[0.0; 3]; 3])], [].into_iter()).unwrap();
            assert!(map.is_finite(), "{map}");
        }
    }
}
