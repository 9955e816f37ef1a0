//! The shapes of obstacles, with the depth of a point inside and the direction out.

use super::surface::Surface;
use crate::carried::Weights;
use crate::element::{Dimension, ElementKind, face_table};
use glam::{DQuat, DVec3};

/// The region that an obstacle fills at the start.
///
/// In the plane a sphere is a disc, a capsule a strip with round ends, and a box a rectangle, all infinite across the
/// plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// The half-space `normal · x < height`, drawn as ground.
    Floor {
        /// Unit vector out of the floor.
        normal: DVec3,
        /// Distance of the surface from the origin along `normal` (m).
        height: f64,
    },
    /// The half-space behind a point, drawn as a plate around it.
    Plate {
        /// A point of the surface (m).
        point: DVec3,
        /// Unit vector out of the surface.
        normal: DVec3,
    },
    /// A ball.
    Sphere {
        /// Its centre (m).
        centre: DVec3,
        /// Its radius (m).
        radius: f64,
    },
    /// All points within a distance of a line segment: a rod with round ends.
    Capsule {
        /// One end of the line (m).
        from: DVec3,
        /// The other end (m).
        to: DVec3,
        /// The greatest distance from the line (m).
        radius: f64,
    },
    /// A cuboid.
    Box {
        /// Its centre (m).
        centre: DVec3,
        /// Half of its sides (m); infinite across the plane.
        half: DVec3,
        /// Its orientation.
        rotation: DQuat,
    },
}

/// Relative round-off of a depth and of the position of a node that was placed on the surface, with a safety factor of
/// two.
pub(crate) const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// The position of a point relative to an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Distance to the surface (m), positive inside, negative outside.
    pub depth: f64,
    /// Unit vector out of the obstacle, perpendicular to the surface.
    pub normal: DVec3,
}

impl Shape {
    /// Whether it has no end: a floor or a plate.
    pub fn is_half_space(&self) -> bool {
        matches!(self, Self::Floor { .. } | Self::Plate { .. })
    }

    /// The depth of a point below the surface; `None` outside and on it.
    #[cfg(test)]
    fn contact(&self, point: DVec3) -> Option<Contact> {
        Some(self.surface(point)).filter(|contact| contact.depth > 0.0)
    }

    /// The depth of a point below the surface, negative above it. Outside a box it is exact only near the surface.
    pub(super) fn surface(&self, point: DVec3) -> Contact {
        let (depth, normal) = match *self {
            Self::Floor { normal, height } => (height - normal.dot(point), normal),
            Self::Plate { point: surface, normal } => (normal.dot(surface - point), normal),
            Self::Sphere { centre, radius } => round(point - centre, radius, DVec3::Y),
            Self::Capsule { from, to, radius } => {
                let along = to - from;
                let squared = along.length_squared();
                let share = if squared > 0.0 { ((point - from).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
                round(point - from - along * share, radius, across(along))
            }
            Self::Box { centre, half, rotation } => {
                let local = rotation.conjugate() * (point - centre);
                let depths = half - local.abs();
                // The nearest face; the first one if several are equally near.
                let axis = (0..3).fold(0, |best, axis| if depths[axis] < depths[best] { axis } else { best });
                let sign = if local[axis] < 0.0 { -1.0 } else { 1.0 };
                (depths[axis], rotation * (DVec3::AXES[axis] * sign))
            }
        };
        Contact { depth, normal }
    }

    /// Its surface, whose thickness is a radius, and its points at the start (m), which have numbers from `first` on; `None` for half-spaces.
    pub(super) fn surface_of(&self, dimension: Dimension, first: u32) -> Option<(Surface, Vec<DVec3>)> {
        let (points, facets, bars, radius): (Vec<DVec3>, Vec<_>, Vec<[u32; 2]>, f64) = match *self {
            Self::Floor { .. } | Self::Plate { .. } => return None,
            Self::Sphere { centre, radius } => (vec![centre], vec![([0; 3], 1)], vec![], radius),
            Self::Capsule { from, to, radius } => (vec![from, to], vec![([0, 1, 1], 2)], vec![[0, 1]], radius),
            Self::Box { centre, half, rotation } if dimension == Dimension::Plane => {
                let corner = |[x, y]: [f64; 2]| centre + rotation * DVec3::new(x * half.x, y * half.y, 0.0);
                let points = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).to_vec();
                (points, (0..4).map(|at| ([at, (at + 1) % 4, at], 2)).collect(), vec![], 0.0)
            }
            Self::Box { centre, half, rotation } => {
                let sign = |at: usize, axis: usize| if at >> axis & 1 == 0 { -1.0 } else { 1.0 };
                let corner =
                    |at: usize| centre + rotation * (DVec3::from_array([0, 1, 2].map(|axis| sign(at, axis))) * half);
                let sides = face_table(ElementKind::Hexahedron).iter();
                let corners = sides.map(|side| [0, 1, 2, 3].map(|at| u32::from(side[at])));
                let halves = corners.flat_map(|[a, b, c, d]| [([a, b, c], 3), ([a, c, d], 3)]);
                ((0..8).map(corner).collect(), halves.collect(), vec![], 0.0)
            }
        };
        let mut own = Weights::default();
        (first..).zip(&points).for_each(|(node, _)| own.push(&[node], &[1.0]));
        let mut surface = Surface::new(own, facets, if dimension == Dimension::Space { &bars } else { &[] });
        (surface.thickness, surface.is_round) = (radius, radius > 0.0);
        if matches!(self, Self::Box { .. }) {
            surface.bounding = (0..surface.facets.len() as u32).collect();
        }
        Some((surface, points))
    }

    /// The greatest distance (m) by which round-off may move a point off the surface, for a point with coordinates of
    /// at most `farthest` (m).
    pub(super) fn round_off(&self, farthest: f64) -> f64 {
        let size = match *self {
            Self::Floor { height, .. } => height.abs(),
            _ => {
                self.middle().abs().max_element() + Some(self.reach()).filter(|reach| reach.is_finite()).unwrap_or(0.0)
            }
        };
        ROUND_OFF * (size + farthest)
    }

    /// The centre of the obstacle (m); the point of a plate; for a floor, the point of its surface nearest to the
    /// origin.
    pub fn middle(&self) -> DVec3 {
        match *self {
            Self::Floor { normal, height } => normal * height,
            Self::Plate { point, .. } => point,
            Self::Sphere { centre, .. } | Self::Box { centre, .. } => centre,
            Self::Capsule { from, to, .. } => 0.5 * (from + to),
        }
    }

    /// The radius of a sphere about the centre that contains the obstacle (m); infinite for half-spaces.
    pub fn reach(&self) -> f64 {
        match *self {
            Self::Floor { .. } | Self::Plate { .. } => f64::INFINITY,
            Self::Sphere { radius, .. } => radius,
            Self::Capsule { from, to, radius } => 0.5 * from.distance(to) + radius,
            Self::Box { half, .. } => DVec3::select(half.is_finite_mask(), half, DVec3::ZERO).length(),
        }
    }
}

/// Depth and outward normal of a point from its offset from the centre; `elsewhere` is the normal at the centre itself.
fn round(from_middle: DVec3, radius: f64, elsewhere: DVec3) -> (f64, DVec3) {
    let distance = from_middle.length();
    (radius - distance, if distance > 0.0 { from_middle / distance } else { elsewhere })
}

/// A unit vector perpendicular to another one: as far upwards as possible, and in the plane z = 0 for a vector in that
/// plane.
fn across(along: DVec3) -> DVec3 {
    let squared = along.length_squared();
    let up = if squared > 0.0 { DVec3::Y - along * (along.y / squared) } else { DVec3::Y };
    up.try_normalize().unwrap_or(DVec3::X)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> [Shape; 5] {
        let slant = DVec3::new(1.0, 2.0, -0.5).normalize();
        [
            Shape::Floor { normal: slant, height: 0.3 },
            Shape::Plate { point: DVec3::new(0.1, 0.2, 0.3), normal: -slant },
            Shape::Sphere { centre: DVec3::splat(0.2), radius: 0.5 },
            Shape::Capsule { from: DVec3::X, to: DVec3::new(-0.4, 0.3, 0.0), radius: 0.4 },
            Shape::Box {
                centre: DVec3::new(0.1, 0.0, 0.0),
                half: DVec3::new(0.5, 0.4, 0.6),
                rotation: DQuat::from_xyzw(0.1, 0.3, -0.2, 0.9).normalize(),
            },
        ]
    }

    #[test]
    fn the_way_out_leads_to_the_surface() {
        for shape in shapes() {
            let mut inside = 0;
            for at in 0..1000u32 {
                let point = DVec3::from_array([at % 10, at / 10 % 10, at / 100].map(|n| f64::from(n) * 0.2 - 0.95));
                let Some(Contact { depth, normal }) = shape.contact(point) else { continue };
                inside += 1;
                assert!((normal.length() - 1.0).abs() < 1e-12);
                assert!(shape.contact(point + normal * (depth * (1.0 + 1e-9) + 1e-12)).is_none(), "{shape:?} {point}");
                assert!(shape.contact(point + normal * (depth * 0.999)).is_some(), "{shape:?} {point}");
                // No other direction is shorter.
                for other in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                    assert!(shape.contact(point + other * (depth * 0.999)).is_some(), "{shape:?} {point} {other}");
                }
            }
            assert!(inside > 50, "{shape:?}");
        }
    }

    #[test]
    fn from_the_very_middle_there_is_a_way_out() {
        for shape in shapes() {
            let out = match shape {
                Shape::Capsule { from, to, .. } => shape.contact(0.5 * (from + to)),
                _ => shape.contact(shape.middle() - 1e-9 * DVec3::Z),
            };
            assert!(out.is_none_or(|contact| contact.normal.is_finite() && contact.depth.is_finite()));
        }
        assert_eq!(across(DVec3::Y * 3.0), DVec3::X);
        assert_eq!(across(DVec3::X), DVec3::Y);
    }
}
