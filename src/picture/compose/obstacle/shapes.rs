//! The shapes of obstacles in space, as corners and faces.

use crate::picture::shadow::Plane;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A surface of revolution, as rings of flat quadrilaterals.
pub(super) struct Lathe {
    /// Corners and normals, ring by ring.
    pub(super) rings: Vec<Vec<(DVec3, DVec3)>>,
}

impl Lathe {
    /// All corners, ring by ring.
    pub(super) fn points(&self) -> Vec<DVec3> {
        self.rings.iter().flatten().map(|(at, _)| *at).collect()
    }

    /// The surface with more rings where two are farther apart than a length (m).
    pub(super) fn refined(&self, longest: f64) -> Self {
        const MOST: f64 = 64.0;
        let mut rings: Vec<Vec<(DVec3, DVec3)>> = Vec::with_capacity(self.rings.len());
        for ring in &self.rings {
            if let Some(last) = rings.last().cloned() {
                let apart = last.iter().zip(ring).map(|(one, other)| one.0.distance(other.0)).fold(0.0, f64::max);
                let parts = (apart / longest).ceil().clamp(1.0, MOST) as usize;
                rings.extend((1..parts).map(|at| {
                    let share = at as f64 / parts as f64;
                    let between = |(one, other): (&(DVec3, DVec3), &(DVec3, DVec3))| {
                        (one.0.lerp(other.0, share), one.1.lerp(other.1, share).normalize_or(one.1))
                    };
                    last.iter().zip(ring).map(between).collect()
                }));
            }
            rings.push(ring.clone());
        }
        Self { rings }
    }

    /// Triangles, counter-clockwise from outside, without degenerate ones at the poles.
    pub(super) fn triangles(&self) -> Vec<[u32; 3]> {
        let count = self.rings.first().map_or(0, Vec::len) as u32;
        let last = self.rings.len() as u32;
        let mut triangles = Vec::with_capacity(2 * (count * last) as usize);
        for ring in 1..last {
            for segment in 0..count {
                let next = (segment + 1) % count;
                let [a, b] = [segment, next].map(|at| (ring - 1) * count + at);
                let [d, c] = [segment, next].map(|at| ring * count + at);
                if ring > 1 {
                    triangles.push([a, b, c]);
                }
                if ring + 1 < last {
                    triangles.push([a, c, d]);
                }
            }
        }
        triangles
    }
}

/// A round surface: rings at angles above the equator, each moved along the axis by a length (m).
pub(super) fn lathe(
    middle: DVec3,
    axis: DVec3,
    radius: f64,
    profile: impl Iterator<Item = (f64, f64)>,
    segments: usize,
) -> Lathe {
    let [second, first] = Plane::new(axis, 0.0).axes;
    let around: Vec<_> = (0..segments)
        .map(|at| {
            let (sine, cosine) = libm::sincos(TAU * at as f64 / segments as f64);
            cosine * first + sine * second
        })
        .collect();
    let ring = |(angle, shift): (f64, f64)| {
        let (height, width) = libm::sincos(angle);
        // At the poles all corners are the same.
        let width = if width < 1e-12 { 0.0 } else { width };
        let corner = |out: &DVec3| {
            let normal = height * axis + width * *out;
            (middle + shift * axis + radius * normal, normal)
        };
        around.iter().map(corner).collect()
    };
    Lathe { rings: profile.map(ring).collect() }
}

/// A rod with round ends.
pub(super) fn rod([from, to]: [DVec3; 2], radius: f64, segments: usize) -> Lathe {
    let (axis, half) = ((to - from).try_normalize().unwrap_or(DVec3::Y), 0.5 * from.distance(to));
    let quarter = segments / 4;
    let angle = |ring: usize| FRAC_PI_2 * ring as f64 / quarter as f64;
    let low = (0..=quarter).map(|ring| (angle(ring) - FRAC_PI_2, -half));
    let high = (0..=quarter).map(|ring| (angle(ring), half));
    lathe(from.midpoint(to), axis, radius, low.chain(high), segments)
}

/// The nodes of the faces of a box whose corners have a bit for each axis: low and high side of the first axis, and so
/// on. Faces are counter-clockwise from outside for right-handed axes.
pub(super) const FACES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The edges of a box: their ends, and the faces that meet there.
pub(super) fn edges() -> impl Iterator<Item = ([usize; 2], [usize; 2])> {
    (0..3usize).flat_map(|axis| {
        let [one, other] = [(axis + 1) % 3, (axis + 2) % 3];
        (0..4usize).map(move |at| {
            let (low, high) = (at & 1, at >> 1);
            let from = low << one | high << other;
            ([from, from | 1 << axis], [2 * one + low, 2 * other + high])
        })
    })
}

/// The corners of a box with a bit for each axis.
pub(super) fn corners(centre: DVec3, axes: [DVec3; 3], half: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|at| {
        (0..3).fold(centre, |point, axis| {
            let sign = if at >> axis & 1 == 1 { 1.0 } else { -1.0 };
            point + sign * half[axis] * axes[axis]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn volume(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|three| three.map(|at| points[at as usize])).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn rods_are_closed_and_look_outward() {
        let rod = rod([DVec3::new(0.3, 0.1, 0.0), DVec3::new(1.0, 0.4, -0.2)], 0.2, 64);
        let exact = PI * 0.04 * (0.49_f64 + 0.09 + 0.04).sqrt() + 4.0 / 3.0 * PI * 0.008;
        let volume = volume(&rod.points(), &rod.triangles());
        assert!((volume / exact - 1.0).abs() < 0.01, "{volume} {exact}");
        let out = |(at, normal): &(DVec3, DVec3)| (*at - DVec3::new(0.65, 0.25, -0.1)).dot(*normal) > 0.0;
        assert!(rod.rings.iter().flatten().all(out));
    }

    #[test]
    fn the_edges_of_a_box_lie_between_its_faces() {
        assert_eq!(edges().count(), 12);
        for (ends, faces) in edges() {
            for face in faces {
                assert!(ends.iter().all(|end| FACES[face].contains(end)), "{ends:?} {face}");
            }
        }
        let all = corners(DVec3::splat(0.3), DVec3::AXES, DVec3::new(0.5, 1.0, 2.0));
        let triangles: Vec<_> = FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let triangles: Vec<_> = triangles.iter().map(|three| three.map(|at| at as u32)).collect();
        assert!((volume(&all, &triangles) - 8.0).abs() < 1e-12);
    }
}
