//! The lines in which bodies intersect solid obstacles: only nodes collide, so faces may be pierced.

use super::space::Staging;
use crate::picture::{Line, LineKind, Mesh};
use crate::sim::Shape;
use glam::DVec3;

/// The number of parts into which the sides of a triangle are cut in the search for pierced places.
const CUT: usize = 10;

impl Staging<'_> {
    /// The lines in which surfaces of the body intersect solid obstacles.
    pub(in crate::picture) fn pierced(&self, meshes: &[&Mesh], lines: &mut Vec<Line>) {
        for obstacle in self.site.obstacles {
            let (pose, pivot, reach) = (obstacle.pose(self.site.time), obstacle.pivot, obstacle.shape.reach());
            if !reach.is_finite() {
                continue;
            }
            let inside = |point: DVec3| -height(&obstacle.shape, pose.undo(pivot, point));
            let middle = pose.apply(pivot, pivot);
            for mesh in meshes {
                let points: Vec<_> = mesh
                    .vertices
                    .iter()
                    .map(|vertex| self.site.origin + self.site.side * DVec3::from(vertex.position.map(f64::from)))
                    .collect();
                for triangle in &mesh.triangles {
                    let [a, b, c] = triangle.map(|at| points[at as usize]);
                    let centroid = (a + b + c) / 3.0;
                    let size = [a, b, c].iter().map(|at| at.distance(centroid)).fold(0.0, f64::max);
                    if middle.distance(centroid) < reach + size && inside(centroid) > -size {
                        self.pierce([a, b, c], inside, lines);
                    }
                }
            }
        }
    }

    /// The lines in a triangle along which `inside` changes its sign.
    fn pierce(&self, [a, b, c]: [DVec3; 3], inside: impl Fn(DVec3) -> f64, lines: &mut Vec<Line>) {
        let part = |at: usize| at as f64 / CUT as f64;
        let point = |i: usize, j: usize| a + part(i) * (b - a) + part(j) * (c - a);
        let rows: Vec<Vec<_>> =
            (0..=CUT).map(|i| (0..=CUT - i).map(|j| (point(i, j), inside(point(i, j)))).collect()).collect();
        let mut cut = |corners: [(DVec3, f64); 3]| {
            let sides = [(0, 1), (1, 2), (2, 0)].map(|(one, other)| (corners[one], corners[other]));
            let crossed = sides.into_iter().filter(|((_, x), (_, y))| (*x < 0.0) != (*y < 0.0));
            let crossed: Vec<_> = crossed.map(|((a, x), (b, y))| a.lerp(b, x / (x - y))).collect();
            if let [from, to] = crossed[..] {
                self.line([from, to], LineKind::ObstacleEdge, lines);
            }
        };
        for i in 0..CUT {
            for j in 0..CUT - i {
                cut([rows[i][j], rows[i + 1][j], rows[i][j + 1]]);
                if i + j + 1 < CUT {
                    cut([rows[i + 1][j], rows[i + 1][j + 1], rows[i][j + 1]]);
                }
            }
        }
    }
}

/// The distance of a point from a solid shape before it moves (m); negative inside.
pub(super) fn height(shape: &Shape, point: DVec3) -> f64 {
    match *shape {
        Shape::Floor { normal, height } => normal.dot(point) - height,
        Shape::Plate { point: surface, normal } => normal.dot(point - surface),
        Shape::Sphere { centre, radius } => point.distance(centre) - radius,
        Shape::Capsule { from, to, radius } => {
            let along = to - from;
            let squared = along.length_squared();
            let share = if squared > 0.0 { ((point - from).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
            point.distance(from + share * along) - radius
        }
        Shape::Box { centre, half, rotation } => {
            let beyond = (rotation.conjugate() * (point - centre)).abs() - half;
            beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
        }
    }
}
